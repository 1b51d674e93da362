"""What a design's postures do to the people's backs and muscles, and how observers would score them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from evodesign.cli.tables.people import Asked, hardest_cases
from evodesign.cli.tables.table import FittedTable, names, numbers, titled
from evodesign.human.back import ACTION_LIMIT
from evodesign.tree.words import in_words

if TYPE_CHECKING:
    from evodesign.human.endurance import Endurance
    from evodesign.quantities.ergonomics import Ergonomics

TITLE = "the person's back, holding time and posture scores"
TITLE_OF_SEVERAL = "back, holding time and posture scores of each person's hardest postures"

CAPTION = (
    "back, shear: of the disc L5/S1; NIOSH's limit of compression is 3.4 kN (!: above)\n"
    "load: norm of the torques that the load adds to those with empty hands\n"
    "time: until the first joint tires; >: it works at less than 10 %, where none was measured\n"
    "RULA: 1 to 7, REBA: 1 to 15, more is worse (docs/people.md)"
)


def effort_table(asked: Sequence[Asked], *, titled_too: bool) -> FittedTable:
    """A row for each case; of several people or loads, each one's with the most compression or REBA."""
    several = any(case.label for case, _ in asked)
    rows = hardest_cases(asked, (_compression, _reba)) if several else asked
    measured = numbers("back [kN]", "shear [kN]", "load [N m]", "time", "RULA", "REBA")
    table = titled(
        (TITLE_OF_SEVERAL if several else TITLE) if titled_too else "",
        [*names("case"), *measured, *names("tires first")],
        caption=CAPTION,
    )
    for case, each in rows:
        table.add_row(case.name, *_figures(each))
    return table


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
