"""When each case of a recording is shown.

Heights are time, ten seconds per metre, where a problem has one person and one load. Otherwise the cases come
one after the other, in the problem's order, two seconds each: all loads of a person in a row.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from evodesign.analysis.cases import named_people_or_loads
from evodesign.records import HeightDetail

__all__ = ["SECONDS_PER_CASE", "Timed", "nanoseconds_at", "time_scale", "timed"]

NANOSECONDS: Final = 1_000_000_000
NANOSECONDS_PER_METRE: Final = 10 * NANOSECONDS
SECONDS_PER_CASE: Final = 2

Timed = tuple[int, HeightDetail]
"""Time [ns] and what is shown from then on."""


def nanoseconds_at(height: float) -> int:
    """Time of a height's messages."""
    return round(height * NANOSECONDS_PER_METRE)


def timed(heights: Sequence[HeightDetail]) -> list[Timed]:
    """All cases with their times, in rising order."""
    if named_people_or_loads(heights):
        return [(count * SECONDS_PER_CASE * NANOSECONDS, detail) for count, detail in enumerate(heights)]
    ordered = sorted(heights, key=lambda detail: detail.height_m)
    return [(nanoseconds_at(detail.height_m), detail) for detail in ordered]


def time_scale(heights: Sequence[HeightDetail]) -> str:
    """What time means, in words."""
    if named_people_or_loads(heights):
        return f"{SECONDS_PER_CASE} s per case: person, load and height in the problem's order"
    return "10 s per metre of the load's height"
