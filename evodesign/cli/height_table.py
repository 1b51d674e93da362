"""One design's postures in short, as a table for people."""

from __future__ import annotations

from rich.markup import escape
from rich.table import Table

from evodesign.cli.output import figure, shown
from evodesign.errors import on_one_line
from evodesign.records import Assessment, HeightOutcome
from evodesign.statics.scene import HUMAN, ROBOT

__all__ = ["heights_table"]


def heights_table(assessment: Assessment, title: str) -> Table:
    """A design's postures in short, case by case, under a title unless it is empty."""
    table = Table(title=title or None, title_justify="left")
    holders = [_holder(outcome) for outcome in assessment.heights]
    if any(holders):
        table.add_column("person, load", overflow="fold")
    for column in ("height [m]", "robot |tau| [N m]", "human |tau| [N m]", "iterations", "residual"):
        table.add_column(escape(column), justify="right")
    table.add_column("status", overflow="fold")
    for holder, outcome in zip(holders, assessment.heights, strict=True):
        status = outcome.status if outcome.status == "solved" else f"{outcome.status}: {outcome.reason}"
        table.add_row(
            *([shown(holder)] if any(holders) else []),
            figure(outcome.height_m),
            figure(outcome.robot_torque_norm),
            figure(outcome.human_torque_norm),
            str(outcome.iterations),
            "-" if outcome.residual is None else f"{outcome.residual:.1e}",
            escape(on_one_line(status)),
        )
        for name, norms in outcome.disturbed.items():
            table.add_row(
                *([""] if any(holders) else []),
                "",
                *(figure(norms[agent]) for agent in (ROBOT, HUMAN)),
                "",
                "",
                shown(f"under '{name}'"),
            )
    return table


def _holder(outcome: HeightOutcome) -> str:
    """Who holds what, where there are several people or loads."""
    return ", ".join(name for name in (outcome.human_name, outcome.payload_name) if name)
