"""What a design's postures ask of the people, as a table and as JSON."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from evodesign.cli.tables.table import FittedTable, names, numbers, titled
from evodesign.records import Case

if TYPE_CHECKING:
    from evodesign.quantities.ergonomics import Ergonomics

Asked = tuple[Case, "Ergonomics"]
"""A case, and what its posture asks of the person."""

TITLE = "what each posture asks of the person"
TITLE_OF_SEVERAL = "what the hardest postures ask of each person, of all loads and heights"

CAPTION = (
    "effort: the hardest joint's torque as a share of a person's strength there\n"
    "hands: ahead of the ankles and up from the ground; holds: part of the load\n"
    "limit, index: recommended weight and lifting index (NIOSH; docs/people.md)"
)


def people_table(asked: Sequence[Asked], *, titled: bool) -> FittedTable:
    """A row for each case; of several people or loads, each person's hardest ones."""
    several = any(case.label for case, _ in asked)
    rows = [(case.name, ergonomics) for case, ergonomics in (hardest_cases(asked) if several else asked)]
    title = TITLE_OF_SEVERAL if several else TITLE
    return person_table(rows, title if titled else "")


def hardest_cases(
    asked: Sequence[Asked], sizes: Sequence[Callable[[Asked], float]] | None = None
) -> list[Asked]:
    """Of each person the case of each largest size, often the same; by default effort and lifting index."""
    chosen: list[Asked] = []
    for name in dict.fromkeys(case.person for case, _ in asked):
        own = [one for one in asked if one[0].person == name]
        for size in sizes or (_effort, _index):
            hardest = max(own, key=size)
            if hardest not in chosen:
                chosen.append(hardest)
    return chosen


def _effort(asked: Asked) -> float:
    strain = asked[1].strain
    return 0.0 if strain is None else strain.share


def _index(asked: Asked) -> float:
    """The lifting index; beyond any where nothing is recommended."""
    index = asked[1].lifting_index
    return math.inf if index is None else index


def person_table(cases: Sequence[tuple[str, Ergonomics]], title: str = TITLE) -> FittedTable:
    """A row for each case."""
    measured = numbers("effort", "ahead [m]", "up [m]", "holds [kg]", "limit [kg]", "index")
    table = titled(title, [*names("case", "hardest joint"), *measured], caption=CAPTION)
    for case, asked in cases:
        strain, task = asked.strain, asked.task
        table.add_row(
            case,
            "-" if strain is None else f"{strain.joint}, {strain.movement}",
            "-" if strain is None else f"{strain.share:.1%}",
            f"{task.horizontal:.2f}",
            f"{task.vertical:.2f}",
            f"{asked.load:.1f}",
            f"{asked.recommended_weight:.1f}",
            "-" if asked.lifting_index is None else f"{asked.lifting_index:.2f}",
        )
    return table
