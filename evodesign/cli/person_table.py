"""What a design's postures ask of the people, as a table and as JSON."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from rich.markup import escape
from rich.table import Table

from evodesign.cli.output import shown

if TYPE_CHECKING:
    from evodesign.problem.ergonomics import Ergonomics

__all__ = ["TITLE", "person_table"]

TITLE = "what each posture asks of the person"

CAPTION = (
    "effort: the hardest joint's torque as a share of a person's strength there\n"
    "hands: ahead of the ankles and up from the ground; holds: part of the load\n"
    "limit, index: recommended weight and lifting index (NIOSH; docs/people.md)"
)


def person_table(cases: Sequence[tuple[str, Ergonomics]], title: str = TITLE) -> Table:
    """A row for each case."""
    table = Table(title=title or None, title_justify="left", caption=CAPTION, caption_justify="left")
    for column in ("case", "hardest joint"):
        table.add_column(column, overflow="fold")
    for column in ("effort", "ahead [m]", "up [m]", "holds [kg]", "limit [kg]", "index"):
        table.add_column(escape(column), justify="right")
    for case, asked in cases:
        strain, task = asked.strain, asked.task
        table.add_row(
            shown(case),
            "-" if strain is None else shown(f"{strain.joint}, {strain.movement}"),
            "-" if strain is None else f"{strain.share:.1%}",
            f"{task.horizontal:.2f}",
            f"{task.vertical:.2f}",
            f"{asked.load:.1f}",
            f"{asked.recommended_weight:.1f}",
            "-" if asked.lifting_index is None else f"{asked.lifting_index:.2f}",
        )
    return table
