"""Walks with the load as a table for people."""

from __future__ import annotations

import math
from collections.abc import Sequence

from evodesign.cli.tables.table import FittedTable, names, numbers, titled
from evodesign.evaluation.carries import CarriedCase


def carries_table(title: str, cases: Sequence[CarriedCase]) -> FittedTable:
    """What each walk takes of whom, and how it ends."""
    columns = numbers(
        "distance [m]", "tilt [deg]", "torque [N m]", "saturation [%]", "energy [J]", "back [N]"
    )
    caption = (
        "tilt: of the load, at most; torque: the largest of any joint; saturation: time with a motor at its "
        "limit; back: compression of L5/S1, at most"
    )
    keys = names("hold", "agent")
    table = titled(title, [*keys, *columns, *names("ends")], keys=2, caption=caption)
    for case in cases:
        outcome = case.outcome
        if not outcome.agents:
            table.add_row(case.name, *["-"] * 7, outcome.reason)
        for name, agent in outcome.agents.items():
            back = case.compression.get(name)
            table.add_row(
                case.name,
                name,
                f"{outcome.distance:.2f}",
                f"{math.degrees(outcome.tilt):.1f}",
                f"{agent.torque:.0f} ({agent.joint})",
                f"{100.0 * agent.saturation:.0f}",
                f"{case.energy[name]:.0f}" if name in case.energy else "-",
                "-" if back is None else f"{back:.0f}",
                outcome.reason or f"stands after {outcome.seconds:.1f} s",
            )
    return table
