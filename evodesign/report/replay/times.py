"""When each case of a recording is shown.

Heights are time, ten seconds per metre, where a problem has one person and one load. Otherwise the cases come
one after the other, in the problem's order, two seconds each: all loads of a person in a row.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from evodesign.records import CaseDetail

__all__ = ["SECONDS_PER_CASE", "Timed", "nanoseconds_at", "several", "time_scale", "timed"]

NANOSECONDS: Final = 1_000_000_000
NANOSECONDS_PER_METRE: Final = 10 * NANOSECONDS
SECONDS_PER_CASE: Final = 2

Timed = tuple[int, CaseDetail]
"""Time [ns] and what is shown from then on."""


def nanoseconds_at(height: float) -> int:
    """Time of a height's messages."""
    return round(height * NANOSECONDS_PER_METRE)


def several(cases: Sequence[CaseDetail]) -> bool:
    """Whether they are of several people or loads, so that a height does not tell them apart."""
    return any(detail.case.label for detail in cases)


def timed(cases: Sequence[CaseDetail]) -> list[Timed]:
    """All cases with their times, in rising order."""
    if several(cases):
        return [(count * SECONDS_PER_CASE * NANOSECONDS, detail) for count, detail in enumerate(cases)]
    ordered = sorted(cases, key=lambda detail: detail.case.task.height_m)
    return [(nanoseconds_at(detail.case.task.height_m), detail) for detail in ordered]


def time_scale(cases: Sequence[CaseDetail]) -> str:
    """What time means, in words."""
    if several(cases):
        return f"{SECONDS_PER_CASE} s per case: person, load and height in the problem's order"
    return "10 s per metre of the load's height"
