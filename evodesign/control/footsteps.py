"""Footsteps: how long and how often agents step, how far along the way each step takes a foot, how it swings.

Length and time of a step follow from leg length l, as those of bodies of like build do: `LENGTH` l and
`TIME` sqrt(l / g). Forwards and backwards feet pass each other, two lengths at a time but for the first and
the last step; sideways one foot goes one length, and the other one follows by as much.

Source: Alexander 1989, Optimization and gaits in the locomotion of vertebrates (dynamic similarity).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from evodesign.mechanics.balance import GRAVITY
from evodesign.tasks.lift import minimum_jerk

Array = NDArray[np.float64]

LENGTH = 0.25
"""Of a step, of the leg's length."""

TIME = 3.0
"""Of a step, of sqrt(l / g)."""

DOUBLE = 0.3
"""Share of a step's time in which both feet stand."""

LIFT = 0.05
"""Height of a swing foot at most, of the leg's length."""

UPRIGHT = 0.1
"""Share of a swing's time at either end in which the foot goes up or down only."""


@dataclass(frozen=True, slots=True)
class Gait:
    """Of all who walk together.

    Args:
        length: of a step at most [m].
        shifting: time of a step in which both feet stand [s].
        swinging: time of a step in which one foot swings [s].
        lift: height of a swing foot at most [m].
    """

    length: float
    shifting: float
    swinging: float
    lift: float

    @classmethod
    def of(cls, leg: float) -> Gait:
        """That of a leg length [m]: the shortest among those who walk together."""
        seconds = TIME * math.sqrt(leg / GRAVITY)
        return cls(LENGTH * leg, DOUBLE * seconds, (1.0 - DOUBLE) * seconds, LIFT * leg)

    @property
    def seconds(self) -> float:
        """Of a step [s]."""
        return self.shifting + self.swinging


def progress(distance: float, length: float, *, passing: bool) -> list[float]:
    """How far along the way each step takes its foot [m], the feet taking turns.

    Args:
        distance: of the way [m].
        length: of a step at most [m].
        passing: whether feet pass each other.
    """
    count = max(1, math.ceil(distance / length - 1e-9))
    places = [distance * (number + 1) / count for number in range(count)]
    return [*places, distance] if passing else [place for place in places for _ in range(2)]


def smooth(share: float) -> tuple[float, float, float]:
    """From 0 to 1 with least jerk: the number and its derivatives by the share of time."""
    s = min(max(share, 0.0), 1.0)
    return (
        minimum_jerk(s),
        30.0 * s**2 * (1.0 - s) ** 2,
        60.0 * s * (1.0 - s) * (1.0 - 2.0 * s),
    )


def swing(start: Array, end: Array, gait: Gait, time: float) -> tuple[Array, Array, Array]:
    """Place, velocity and acceleration of a swing foot, shape (3,) each.

    Along the way with least jerk in the middle of the swing's time, upwards by 16 lift s^2 (1 - s)^2.

    Args:
        start: where it stood [m], shape (3,).
        end: where it will stand, likewise.
        gait: of the step.
        time: since the swing's beginning [s].
    """
    lasting = (1.0 - 2.0 * UPRIGHT) * gait.swinging
    along, speed, change = smooth((time - UPRIGHT * gait.swinging) / lasting)
    place = start + along * (end - start)
    velocity, acceleration = speed / lasting * (end - start), change / lasting**2 * (end - start)
    s, lift, rate = time / gait.swinging, gait.lift, 1.0 / gait.swinging
    place[2] += 16.0 * lift * s**2 * (1.0 - s) ** 2
    velocity[2] += 32.0 * lift * s * (1.0 - s) * (1.0 - 2.0 * s) * rate
    acceleration[2] += 32.0 * lift * (1.0 - 6.0 * s + 6.0 * s**2) * rate**2
    return place, velocity, acceleration
