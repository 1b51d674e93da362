"""Lifting the load, or lowering it.

Along a minimum-jerk profile the load's height is h(s) = a + (b - a) (10 s^3 - 15 s^4 + 6 s^5), with s the
share of the time that has passed: it is at rest, and its acceleration vanishes, at both ends.

Source: Flash and Hogan 1985 (minimum jerk).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from enum import StrEnum
from typing import Any, ClassVar

import msgspec

from evodesign.errors import InputError, nearest_name
from evodesign.tasks.base import TaskRecord

KNOTS = 12
"""As many a lift has unless it says otherwise."""

FEWEST_KNOTS = 4
"""A spline at rest at both ends has as many."""


class LoadProfile(StrEnum):
    """How the load's height goes from one end to the other."""

    MINIMUM_JERK = "minimum_jerk"
    FREE = "free"


def profile_named(name: str) -> LoadProfile:
    """The profile of a name.

    Raises:
        InputError: there is none.
    """
    if name not in list(LoadProfile):
        wanted = f"one of {', '.join(LoadProfile)}"
        raise InputError("lift", "profile", wanted, f"'{name}'{nearest_name(name, list(LoadProfile))}")
    return LoadProfile(name)


class Lift(TaskRecord, frozen=True, tag="lift"):
    """A load that is moved straight up or down, from rest to rest, with the feet in place.

    Attributes:
        from_m: height of the load's centre at the beginning [m].
        to_m: at the end [m].
        seconds: that it takes [s].
        profile: of the height in time.
        knots: of the motion's splines.
    Raises:
        InputError: a number that no lift has.
    """

    PARAMETERS: ClassVar[tuple[str, ...]] = ("begin", "end")

    from_m: float
    to_m: float
    seconds: float = 1.5
    profile: LoadProfile = LoadProfile.MINIMUM_JERK
    knots: int = KNOTS

    def __post_init__(self) -> None:
        """Refuse what cannot be lifted."""
        for name in ("from_m", "to_m", "seconds"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0.0):
                raise InputError("lift", name, "a positive number", f"{value}")
        if self.from_m == self.to_m:
            raise InputError("lift", "to_m", "another height than from_m", f"{self.to_m:g}")
        if self.knots < FEWEST_KNOTS:
            raise InputError("lift", "knots", f"a whole number from {FEWEST_KNOTS}", f"{self.knots}")

    def __str__(self) -> str:
        return f"{self.from_m:g} to {self.to_m:g} m in {self.seconds:g} s"

    @property
    def name(self) -> str:
        """Such as `0.8-1.2 in 1.5 s`."""
        return f"{self.from_m:g}-{self.to_m:g} in {self.seconds:g} s"

    @property
    def given(self) -> dict[str, float]:
        """The heights at both ends [m]."""
        return {"begin": self.from_m, "end": self.to_m}

    @classmethod
    def load_heights(cls, given: Mapping[str, Any]) -> tuple[Any, ...]:
        """The heights at both ends [m]: those between are reached where these are."""
        return given["begin"], given["end"]

    @property
    def times(self) -> tuple[float, ...]:
        """Of both ends [s]."""
        return 0.0, self.seconds

    @property
    def coarse(self) -> Lift:
        """The same with the usual number of knots, for which starts are chosen."""
        return msgspec.structs.replace(self, knots=KNOTS)

    @property
    def step(self) -> float:
        """Time between knots [s]."""
        return self.seconds / (self.knots - 1)

    @property
    def knot_times(self) -> tuple[float, ...]:
        """Of the knots [s]."""
        return tuple(self.step * knot for knot in range(self.knots))

    @property
    def result_times(self) -> tuple[float, ...]:
        """Of the instants that results hold [s]: knots, and half-way between them."""
        last = 2 * (self.knots - 1)
        return tuple(self.seconds * place / last for place in range(last + 1))

    @property
    def knot_heights(self) -> tuple[float, ...]:
        """Along a minimum-jerk profile, at the knots [m]."""
        shares = (knot / (self.knots - 1) for knot in range(self.knots))
        return tuple(self.from_m + (self.to_m - self.from_m) * minimum_jerk(share) for share in shares)


def minimum_jerk(share: float) -> float:
    """Share of the way that has been made, of the share of the time that has passed."""
    return 10.0 * share**3 - 15.0 * share**4 + 6.0 * share**5
