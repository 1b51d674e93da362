"""What a design's postures ask of the people, and what they do to backs and muscles, as tables."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from evodesign.cli.tables.table import FittedTable, names, numbers, titled
from evodesign.human.back import ACTION_LIMIT
from evodesign.records import Case
from evodesign.tree.words import in_words

if TYPE_CHECKING:
    from evodesign.human.endurance import Endurance
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

EFFORT_TITLE = "the person's back, holding time and posture scores"

EFFORT_TITLE_OF_SEVERAL = "back, holding time and posture scores of each person's hardest postures"

EFFORT_CAPTION = (
    "back, shear: of the disc L5/S1; NIOSH's limit of compression is 3.4 kN (!: above)\n"
    "load: norm of the torques that the load adds to those with empty hands\n"
    "time: until the first joint tires; >: it works at less than 10 %, where none was measured\n"
    "RULA: 1 to 7, REBA: 1 to 15, more is worse (docs/people.md)"
)


def people_table(asked: Sequence[Asked]) -> FittedTable:
    """A row for each case; of several people or loads, each one's with the most effort or lifting index."""
    several = any(case.label for case, _ in asked)
    rows = hardest_cases(asked) if several else asked
    measured = numbers("effort", "ahead [m]", "up [m]", "holds [kg]", "limit [kg]", "index")
    return titled(
        TITLE_OF_SEVERAL if several else TITLE,
        [*names("case", "hardest joint"), *measured],
        ((case.name, *_task(each)) for case, each in rows),
        caption=CAPTION,
    )


def effort_table(asked: Sequence[Asked]) -> FittedTable:
    """A row for each case; of several people or loads, each one's with the most compression or REBA."""
    several = any(case.label for case, _ in asked)
    rows = hardest_cases(asked, (_compression, _reba)) if several else asked
    measured = numbers("back [kN]", "shear [kN]", "load [N m]", "time", "RULA", "REBA")
    return titled(
        EFFORT_TITLE_OF_SEVERAL if several else EFFORT_TITLE,
        [*names("case"), *measured, *names("tires first")],
        ((case.name, *_figures(each)) for case, each in rows),
        caption=EFFORT_CAPTION,
    )


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


def _task(asked: Ergonomics) -> tuple[str, ...]:
    strain, task = asked.strain, asked.task
    return (
        "-" if strain is None else f"{strain.joint}, {strain.movement}",
        "-" if strain is None else f"{strain.share:.1%}",
        f"{task.horizontal:.2f}",
        f"{task.vertical:.2f}",
        f"{asked.load:.1f}",
        f"{asked.recommended_weight:.1f}",
        "-" if asked.lifting_index is None else f"{asked.lifting_index:.2f}",
    )


def _figures(asked: Ergonomics) -> tuple[str, ...]:
    back, scores = asked.back, (asked.rula, asked.reba)
    above = "!" if back is not None and back.compression > ACTION_LIMIT else ""
    return (
        "-" if back is None else f"{back.compression / 1000.0:.2f}{above}",
        "-" if back is None else f"{round(back.shear / 1000.0, 2) + 0.0:.2f}",
        f"{asked.load_torque:.1f}",
        _time(asked.endurance),
        *("-" if score is None else str(score.whole) for score in scores),
        "-" if asked.endurance is None else in_words(asked.endurance.joint.joint),
    )


def _time(tires: Endurance | None) -> str:
    """The holding time; where the share is below those that were measured, that of the lowest one."""
    if tires is None:
        return "-"
    seconds = tires.known_seconds
    words = f"{seconds:.0f} s" if seconds < 120.0 else f"{seconds / 60.0:.0f} min"
    return f"> {words}" if tires.seconds > seconds else words


def _compression(asked: Asked) -> float:
    back = asked[1].back
    return 0.0 if back is None else back.compression


def _reba(asked: Asked) -> float:
    score = asked[1].reba
    return -math.inf if score is None else float(score.whole)
