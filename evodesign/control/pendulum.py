"""A linear inverted pendulum over a pressure point that moves along straight lines, in closed form.

Centre of mass c, capture point (divergent component of motion) xi = c + c' / w, pressure point p:

    c'' = w^2 (c - p)        xi' = w (xi - p)        c' = w (xi - c)

Where p = p0 + r t, both are sums of p0 + r t and exponentials:

    xi = p + r / w + (xi0 - p0 - r / w) e^(w t)
    c  = p + A e^(w t) + B e^(-w t),        A = (xi0 - p0 - r / w) / 2,        B = c0 - p0 - A

The capture point moves away from the pressure point, so it is computed backwards from the end, where it rests
above the pressure point; the centre of mass follows it and is computed forwards. Both rest at the beginning
too: the pressure point first moves to where that is so.

Source: Englsberger, Ott and Albu-Schäffer 2015, Three-dimensional bipedal walking control based on
divergent component of motion; here the pressure point moves on between feet at a constant speed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class PendulumCourse:
    """Of a pendulum, with k moments between which the pressure point moves along a line.

    Args:
        rate: w [1/s].
        times: the moments [s], shape (k,).
        pressures: the pressure point then [m], shape (k, 2).
        captures: the capture point then, likewise.
        centers: the centre of mass then, likewise.
    """

    rate: float
    times: Array
    pressures: Array
    captures: Array
    centers: Array

    def at(self, time: float) -> tuple[Array, Array, Array, Array]:
        """Centre of mass [m], its velocity and acceleration, and the pressure point at a time [s]."""
        number = int(np.clip(np.searchsorted(self.times, time, side="right") - 1, 0, len(self.times) - 2))
        since = min(max(time - self.times[number], 0.0), self.times[number + 1] - self.times[number])
        speed = self._speeds()[number]
        start, grown = self.pressures[number], np.exp(self.rate * since)
        away = (self.captures[number] - start - speed / self.rate) / 2.0
        back = self.centers[number] - start - away
        pressure = start + speed * since
        center = pressure + away * grown + back / grown
        velocity = speed + self.rate * (away * grown - back / grown)
        return center, velocity, self.rate**2 * (center - pressure), pressure

    def _speeds(self) -> Array:
        return np.asarray(np.diff(self.pressures, axis=0) / np.diff(self.times)[:, None])


def pendulum_course(rate: float, times: Sequence[float], pressures: Array) -> PendulumCourse:
    """The course from rest to rest.

    Args:
        rate: w [1/s].
        times: k moments [s].
        pressures: the pressure point then [m], shape (k, 2); in place of the second one comes that with which
            the pendulum rests above the first one at the beginning.
    """
    moments, points = np.array(times, float), np.array(pressures, float)
    ends = [_captures(rate, moments, _with_second(points, second))[0] for second in (0.0, 1.0)]
    points[1] = (points[0] - ends[0]) / (ends[1] - ends[0])
    captures = _captures(rate, moments, points)
    centers = np.empty_like(points)
    centers[0] = points[0]
    course = PendulumCourse(rate, moments, points, captures, centers)
    for number in range(len(moments) - 1):
        centers[number + 1] = course.at(np.nextafter(moments[number + 1], 0.0))[0]
    return course


def _with_second(points: Array, second: float) -> Array:
    changed = points.copy()
    changed[1] = second
    return changed


def _captures(rate: float, times: Array, pressures: Array) -> Array:
    """The capture point at the moments if it rests above the last pressure point, shape (k, 2)."""
    captures = np.empty_like(pressures)
    captures[-1] = pressures[-1]
    for number in range(len(times) - 2, -1, -1):
        lasting = times[number + 1] - times[number]
        lead = (pressures[number + 1] - pressures[number]) / (lasting * rate)
        off = captures[number + 1] - pressures[number + 1] - lead
        captures[number] = pressures[number] + lead + off * np.exp(-rate * lasting)
    return captures
