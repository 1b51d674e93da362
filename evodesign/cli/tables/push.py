"""Pushes as tables for people."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from evodesign.cli.tables.table import FittedTable, names, numbers, titled
from evodesign.evaluation.pushes import FoundMargins
from evodesign.simulation.push import PushOutcome


def margins_table(title: str, found: FoundMargins) -> FittedTable:
    """The margin at each moment in each direction, and the least."""
    turns = sorted({round(float(np.degrees(each.direction)), 3) for each in found.margins})
    least = found.least
    caption = (
        "impulses [N s] by direction [deg], from forwards to the left; the least is "
        f"{least.impulse:.3g} N s: beyond it {least.reason or 'nothing larger was tried'}"
    )
    if found.spread:
        changes = ", ".join(f"{name} {change:+.2g}" for name, change in found.spread.items())
        caption += f"; it changes with {changes} N s"
    table = titled(
        title, [*names("moment"), *numbers(*(f"{turn:g}" for turn in turns))], keys=1, caption=caption
    )
    for moment in dict.fromkeys(each.moment for each in found.margins):
        own = {
            round(float(np.degrees(each.direction)), 3): each
            for each in found.margins
            if each.moment == moment
        }
        table.add_row(moment, *(f"{own[turn].impulse:.1f}" for turn in turns))
    return table


def pushes_table(title: str, outcomes: Mapping[str, PushOutcome]) -> FittedTable:
    """What came of one push at each moment."""
    columns = numbers("recovery [s]", "load off [mm]", "capture point off [mm]", "torque saturation [%]")
    table = titled(title, [*names("moment"), *columns, *names("lost")], keys=1)
    for moment, each in outcomes.items():
        table.add_row(
            moment,
            "-" if each.recovery is None else f"{each.recovery:.2f}",
            f"{1e3 * each.load_off:.1f}",
            f"{1e3 * each.capture:.1f}",
            f"{100.0 * each.saturation:.0f}",
            each.reason or "no",
        )
    return table
