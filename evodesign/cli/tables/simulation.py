"""Simulations as a table for people."""

from __future__ import annotations

import math
from collections.abc import Sequence

from evodesign.cli.tables.table import FittedTable, names, numbers, titled
from evodesign.control.gains import Feedback
from evodesign.evaluation.simulations import SimulatedCase
from evodesign.simulation.outcome import SETTLED


def simulation_table(title: str, simulations: Sequence[SimulatedCase], feedback: Feedback) -> FittedTable:
    """How far robot, person and load were from their plan in each case."""
    columns = numbers("load off [mm]", "joints off [mrad]", "torques off [%]", "slip [mm]")
    keys = names("case", "agent")
    caption = (
        f"torques after {SETTLED:g} s, relative to the largest planned torque of a joint; feedback of "
        f"{feedback.frequency:g} rad/s, damping ratio {feedback.damping:g}"
    )
    table = titled(title, [*keys, *columns, *names("fell")], keys=2, caption=caption)
    for each in simulations:
        for name, agent in each.outcome.agents.items():
            table.add_row(
                each.name,
                name,
                _hundredths(1e3 * each.outcome.drift),
                _hundredths(1e3 * agent.tracking),
                _hundredths(100.0 * agent.torque_share),
                _hundredths(1e3 * agent.slip),
                f"after {each.outcome.seconds:.2f} s" if agent.fell else "no",
            )
    return table


def _hundredths(value: float) -> str:
    return f"{value:.2f}" if math.isfinite(value) else "-"
