"""What a design's postures ask of the people, as a table and as JSON."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from rich.table import Table

from evodesign.cli.output import shown
from evodesign.records import HeightDetail

if TYPE_CHECKING:
    from evodesign.problem.ergonomics import Ergonomics

__all__ = ["TITLE", "case_name", "person_table"]

TITLE = "what each posture asks of the person"

CAPTION = (
    "hardest joint: its torque as a share of a person's strength there, in that direction\n"
    "hands: ahead of the ankles and above the ground; holds: the person's part of the load\n"
    "limit and index: recommended weight limit and lifting index of the NIOSH equation (docs/people.md)"
)


def case_name(detail: HeightDetail) -> str:
    """Who holds what how high."""
    parts = (detail.human_name, detail.payload_name, f"{detail.height_m:g} m")
    return ", ".join(part for part in parts if part)


def person_table(cases: Sequence[tuple[str, Ergonomics]], title: str = TITLE) -> Table:
    """A row for each case."""
    table = Table(title=title or None, title_justify="left", caption=CAPTION, caption_justify="left")
    for column in ("case", "hardest joint"):
        table.add_column(column, overflow="fold")
    for column in ("of strength", "hands ahead", "hands up", "holds", "limit", "index"):
        table.add_column(column, justify="right")
    for case, asked in cases:
        strain, task = asked.strain, asked.task
        table.add_row(
            shown(case),
            "-" if strain is None else shown(f"{strain.joint}, {strain.movement}"),
            "-" if strain is None else f"{strain.share:.1%}",
            f"{task.horizontal:.2f} m",
            f"{task.vertical:.2f} m",
            f"{asked.load:.1f} kg",
            f"{asked.recommended_weight:.1f} kg",
            "-" if asked.lifting_index is None else f"{asked.lifting_index:.2f}",
        )
    return table
