"""The 1991 revised NIOSH lifting equation, for the part of a load that a person holds.

    RWL = LC HM VM DM AM FM CM            LI = L / RWL
    HM = 25 / H     VM = 1 - 0.003 |V - 75|     DM = 0.82 + 4.5 / D     AM = 1 - 0.0032 A     [cm, degrees]

with H the horizontal distance from the middle of the ankles to the middle of the hands, V the hands' height,
D the vertical travel, A the angle between the line from ankles to hands and straight ahead; FM by frequency,
duration and V, CM by the grip and V. Outside its limits a multiplier is zero: nothing is recommended there.

Metric constants are used throughout (LC = 23 kg); those in inches and pounds are not exact conversions.

Source: Waters, Putz-Anderson, Garg, Fine 1993, Ergonomics 36(7): 749-776; Waters, Putz-Anderson, Garg 1994,
Applications manual for the revised NIOSH lifting equation, DHHS (NIOSH) 94-110 (revised 2021), pages 7 to 18.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

LOAD_CONSTANT = 23.0
"""LC [kg]: what is recommended where every multiplier is one."""

NEAREST, FARTHEST = 0.25, 0.63
"""Range of H [m]: a smaller one counts as the nearest; beyond the farthest nothing is recommended."""

KNUCKLES = 0.75
"""Hand height [m] where VM is one, and where FM and CM change columns."""

HIGHEST, LEAST_TRAVEL = 1.75, 0.25
"""Highest V and largest D [m]; a smaller D counts as the least."""

LARGEST_ANGLE = 135.0
"""Largest A [degrees]."""


class Duration(StrEnum):
    """How long lifting goes on in a day, with the rests that the manual asks for."""

    SHORT = "up to 1 hour"
    MODERATE = "up to 2 hours"
    LONG = "up to 8 hours"


class Coupling(StrEnum):
    """How well the load can be gripped (Table 6)."""

    GOOD = "good"
    FAIR = "fair"
    POOR = "poor"


LIFTS = (0.2, 0.5, *(float(count) for count in range(1, 16)))
"""Rows of Table 5 [lifts per minute]."""

FREQUENCY: Mapping[Duration, tuple[float, ...]] = {
    Duration.SHORT: (
        *(1.00, 0.97, 0.94, 0.91, 0.88, 0.84, 0.80, 0.75, 0.70, 0.60, 0.52, 0.45),
        *(0.41, 0.37, 0.34, 0.31, 0.28),
    ),
    Duration.MODERATE: (
        *(0.95, 0.92, 0.88, 0.84, 0.79, 0.72, 0.60, 0.50, 0.42, 0.35, 0.30, 0.26),
        *(0.23, 0.21, 0.00, 0.00, 0.00),
    ),
    Duration.LONG: (
        *(0.85, 0.81, 0.75, 0.65, 0.55, 0.45, 0.35, 0.27, 0.22, 0.18, 0.15, 0.13),
        *(0.00, 0.00, 0.00, 0.00, 0.00),
    ),
}
"""Table 5 for V of 75 cm and more."""

LAST_LOW: Mapping[Duration, float] = {Duration.SHORT: 12.0, Duration.MODERATE: 10.0, Duration.LONG: 8.0}
"""Table 5 for lower hands: the same up to this frequency [lifts per minute], zero from the next row on."""

GRIP: Mapping[Coupling, tuple[float, float]] = {
    Coupling.GOOD: (1.00, 1.00),
    Coupling.FAIR: (0.95, 1.00),
    Coupling.POOR: (0.90, 0.90),
}
"""Table 7: for V below 75 cm, and from there on."""


@dataclass(frozen=True, slots=True)
class LiftingTask:
    """Where the hands are, and what is done there.

    The defaults are the choice for a load that is held still once: no travel (counted as 25 cm), at most one
    lift in five minutes, no more than an hour a day, and the poorest grip, because the load's handles are not
    described.

    Args:
        horizontal: H [m].
        vertical: V [m].
        asymmetry: A [degrees].
        travel: D [m].
        frequency: lifts per minute.
        duration: of lifting in a day.
        coupling: of hands and load.
    """

    horizontal: float
    vertical: float
    asymmetry: float = 0.0
    travel: float = 0.0
    frequency: float = 0.0
    duration: Duration = Duration.SHORT
    coupling: Coupling = Coupling.POOR


@dataclass(frozen=True, slots=True)
class NioshMultipliers:
    """The equation's six factors."""

    horizontal: float
    vertical: float
    distance: float
    asymmetry: float
    frequency: float
    coupling: float

    @property
    def recommended_weight(self) -> float:
        """The recommended weight limit RWL [kg]."""
        spatial = self.horizontal * self.vertical * self.distance * self.asymmetry
        return LOAD_CONSTANT * spatial * self.frequency * self.coupling


def multipliers(task: LiftingTask) -> NioshMultipliers:
    """The factors of a task, each zero beyond the equation's limits."""
    high = task.vertical >= KNUCKLES
    travel = max(task.travel, LEAST_TRAVEL)
    return NioshMultipliers(
        horizontal=0.0 if task.horizontal > FARTHEST else NEAREST / max(task.horizontal, NEAREST),
        vertical=1.0 - 0.3 * abs(task.vertical - KNUCKLES) if 0.0 <= task.vertical <= HIGHEST else 0.0,
        distance=0.0 if travel > HIGHEST else 0.82 + 0.045 / travel,
        asymmetry=0.0 if task.asymmetry > LARGEST_ANGLE else 1.0 - 0.0032 * task.asymmetry,
        frequency=_frequency(task.frequency, task.duration, high=high),
        coupling=GRIP[task.coupling][high],
    )


def _frequency(lifts: float, duration: Duration, *, high: bool) -> float:
    """FM of Table 5, on a straight line between its rows; zero beyond its last one and next to a zero."""
    column = [
        factor if high or row <= LAST_LOW[duration] else 0.0
        for row, factor in zip(LIFTS, FREQUENCY[duration], strict=True)
    ]
    if lifts <= LIFTS[0]:
        return column[0]
    if lifts > LIFTS[-1]:
        return 0.0
    after = bisect_left(LIFTS, lifts)
    low, end = column[after - 1], column[after]
    if end == 0.0:
        return 0.0
    share = (lifts - LIFTS[after - 1]) / (LIFTS[after] - LIFTS[after - 1])
    return low * (1.0 - share) + end * share
