"""A lift in time: what is asked for, and the motion that a solve gives.

Along a minimum-jerk profile the load's height is h(s) = a + (b - a) (10 s^3 - 15 s^4 + 6 s^5), with s the
share of the time that has passed: it is at rest, and its acceleration vanishes, at both ends.

Source: Flash and Hogan 1985 (minimum jerk).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from evodesign.errors import InputError, nearest_name
from evodesign.motion.spline import RestingSpline
from evodesign.posture.check import AgentMotion, SceneMotion
from evodesign.posture.results import Instant
from evodesign.posture.symmetry import Form

__all__ = ["Lift", "LiftCourse", "LoadProfile", "minimum_jerk", "profile_named"]

Array = NDArray[np.float64]
FEWEST_KNOTS = 4


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


@dataclass(frozen=True, slots=True)
class Lift:
    """A load that is moved straight up or down, from rest to rest.

    Args:
        from_m: height of the load's centre at the beginning [m].
        to_m: at the end [m].
        seconds: that it takes [s].
        profile: of the height in time.
        knots: of the motion's splines.
    Raises:
        InputError: a number that no lift has.
    """

    from_m: float
    to_m: float
    seconds: float = 1.5
    profile: LoadProfile = LoadProfile.MINIMUM_JERK
    knots: int = 12

    def __post_init__(self) -> None:
        """Refuse what cannot be lifted."""
        for name in ("from_m", "to_m", "seconds"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0.0):
                raise InputError("lift", name, "a positive number", f"{value}")
        if self.knots < FEWEST_KNOTS:
            raise InputError("lift", "knots", f"a whole number from {FEWEST_KNOTS}", f"{self.knots}")

    def __str__(self) -> str:
        return f"{self.from_m:g} to {self.to_m:g} m in {self.seconds:g} s"

    @property
    def step(self) -> float:
        """Time between knots [s]."""
        return self.seconds / (self.knots - 1)

    @property
    def times(self) -> Array:
        """Of the knots [s]."""
        return np.linspace(0.0, self.seconds, self.knots)

    @property
    def heights(self) -> Array:
        """Along a minimum-jerk profile, at the knots [m]."""
        return self.from_m + (self.to_m - self.from_m) * minimum_jerk(np.linspace(0.0, 1.0, self.knots))


def minimum_jerk(share: Array) -> Array:
    """Share of the way that has been made, of the share of the time that has passed."""
    return np.asarray(10.0 * share**3 - 15.0 * share**4 + 6.0 * share**5)


@dataclass(frozen=True, slots=True, eq=False)
class LiftCourse:
    """The motion that a solve gives, at any time.

    Args:
        lift: what was asked for.
        forms: of robot and person.
        coefficients: of the splines of postures, by agent and part, shape (knots, rows).
        carried: torques and wrenches at the knots, by agent and part, shape (knots, rows).
        load: coefficients of the load's height [m], shape (knots,).
    """

    lift: Lift
    forms: tuple[Form, Form]
    coefficients: Mapping[str, Mapping[str, Array]]
    carried: Mapping[str, Mapping[str, Array]]
    load: Array

    def instants(self, times: Sequence[float] | Array) -> tuple[Instant, ...]:
        """Whole postures and what is carried, between knots by cubic splines through those at the knots."""
        postures, carriage = self.postures(times), self.carriage(times)
        found: list[dict[str, object]] = [{} for _ in times]
        for form in self.forms:
            name = form.agent.name
            parts = {**postures[name], **carriage[name]}
            for number, each in enumerate(found):
                each[name] = form.expand({part: values[number] for part, values in parts.items()})
        pairs = zip(times, found, strict=True)
        return tuple(Instant(float(time), postures) for time, postures in pairs)  # type: ignore[arg-type]

    def postures(self, times: Sequence[float] | Array) -> dict[str, dict[str, Array]]:
        """Of the forms, by agent and part, shape (times, rows)."""
        image = self._image(times)
        return {
            name: {part: image @ c for part, c in parts.items()} for name, parts in self.coefficients.items()
        }

    def carriage(self, times: Sequence[float] | Array) -> dict[str, dict[str, Array]]:
        """Torques and wrenches of the forms, likewise."""
        knots = self.lift.times
        return {
            name: {part: CubicSpline(knots, at)(times) for part, at in parts.items()}
            for name, parts in self.carried.items()
        }

    def motions(self, times: Sequence[float] | Array) -> tuple[SceneMotion, ...]:
        """How everything moves."""
        step, agents = self.lift.step, {form.agent.name: self._moving(form, times) for form in self.forms}
        lifted = self._image(times, 2) @ self.load / step**2
        return tuple(
            SceneMotion({name: moving[number] for name, moving in agents.items()}, float(lifted[number]))
            for number in range(len(times))
        )

    def heights(self, times: Sequence[float] | Array) -> Array:
        """Of the load's centre [m]."""
        return np.asarray(self._image(times) @ self.load)

    def _moving(self, form: Form, times: Sequence[float] | Array) -> list[AgentMotion]:
        own, step = self.coefficients[form.agent.name], self.lift.step
        orders = []
        for order in (1, 2):
            image = self._image(times, order) / step**order
            base = np.hstack([image @ own["base_position"], image @ own["base_angles"]])
            joints = [list(form.whole_joints(row).values()) for row in image @ own["joints"]]
            orders.append(np.hstack([base, np.array(joints)]))
        return [AgentMotion(rates, changes) for rates, changes in zip(*orders, strict=True)]

    def _image(self, times: Sequence[float] | Array, order: int = 0) -> Array:
        return RestingSpline(self.lift.knots).image(np.asarray(times) / self.lift.step, order)
