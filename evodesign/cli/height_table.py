"""One design's postures in short, as a table for people."""

from __future__ import annotations

from rich.markup import escape
from rich.table import Table

from evodesign.cli.output import figure
from evodesign.errors import on_one_line
from evodesign.records import Assessment
from evodesign.statics.scene import HUMAN, ROBOT

__all__ = ["heights_table"]


def heights_table(assessment: Assessment, title: str) -> Table:
    """A design's postures in short, height by height, under a title unless it is empty."""
    table = Table(title=title or None, title_justify="left")
    for column in ("height [m]", "robot |tau| [N m]", "human |tau| [N m]", "iterations", "residual"):
        table.add_column(escape(column), justify="right")
    table.add_column("status", overflow="fold")
    for outcome in assessment.heights:
        status = outcome.status if outcome.status == "solved" else f"{outcome.status}: {outcome.reason}"
        table.add_row(
            figure(outcome.height_m),
            figure(outcome.robot_torque_norm),
            figure(outcome.human_torque_norm),
            str(outcome.iterations),
            "-" if outcome.residual is None else f"{outcome.residual:.1e}",
            escape(on_one_line(status)),
        )
        for name, norms in outcome.disturbed.items():
            shown = [figure(norms[agent]) for agent in (ROBOT, HUMAN)]
            table.add_row("", *shown, "", "", escape(on_one_line(f"under '{name}'")))
    return table
