"""Going downhill from one point of the unit cube: quasi-Newton steps with bounds, margins and a trust region.

In each round a quadratic model of the value is minimised within the cube, within a distance of the point, and
with linear models of margins that must not become negative:

    minimise  g . d + d . B d / 2     subject to  m + M d >= reserve,  |d| <= radius,  0 <= x + d <= 1

B gathers curvature by Powell's damped BFGS update. The reserve, a share of what the margin can change within
the radius, leaves room for curvature; what of it cannot be had costs. The point that the model proposes is
looked at as it is, and taken only if it is better: where it is worse, or does not exist, the radius shrinks.
So points without a derivative and forbidden regions do no harm, and no point is ever worse than the start.

Source: Nocedal and Wright, Numerical Optimization, ch. 4 and 18 (Procedure 18.2: damped BFGS).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

Array = NDArray[np.float64]

FIRST_RADIUS, LARGEST_RADIUS, SMALLEST_RADIUS = 0.05, 0.4, 1e-4
RESERVE = 0.1
"""Share of a margin's possible change that a step leaves unused."""

PRICE = 10.0
"""Of missing reserve, relative to the slope of the value."""

PATIENCE, LITTLE = 12, 1e-4
"""Looks that must lower the value by this much together, or the descent has arrived."""

LEAST_GAIN = 1e-7
"""Expected gain below which the descent has arrived."""


@dataclass(frozen=True, slots=True)
class Iterate:
    """A place that exists: all its margins are zero or more.

    Args:
        position: in the unit cube, shape (dimension,).
        value: to be minimised, of order one.
        margins: what must not become negative, shape (margins,).
    """

    position: Array
    value: float
    margins: Array


@dataclass(frozen=True, slots=True)
class Slopes:
    """Derivatives at a point.

    Args:
        value: shape (dimension,).
        margins: shape (margins, dimension).
    """

    value: Array
    margins: Array


class DescentProblem(Protocol):
    """What is descended."""

    def look(self, position: Array) -> Iterate | None:
        """The point at a position, or None where there is none."""

    def slopes(self, point: Iterate) -> Slopes | None:
        """The derivatives at a point that was looked at, or None where they do not exist."""


@dataclass(frozen=True, slots=True)
class Descent:
    """Where a descent ended.

    Args:
        best: the best point.
        looks: how many positions were looked at.
        reason: why it ended, in a sentence.
    """

    best: Iterate
    looks: int
    reason: str


def descend(
    landscape: DescentProblem, start: Iterate, budget: int, watch: Callable[[int, Iterate | None, bool], None]
) -> Descent:
    """Go downhill from a point.

    Args:
        landscape: what is descended.
        start: where to begin.
        budget: how many positions may be looked at.
        watch: is told of each look: its number, the point, and whether it was taken.
    """
    best, radius, looks = start, FIRST_RADIUS, 0
    values = [start.value]
    slopes = landscape.slopes(start)
    curvature = np.eye(len(start.position))
    if slopes is not None:  # so that the first step is about as long as the radius
        curvature *= float(np.abs(slopes.value).max()) / FIRST_RADIUS
    while slopes is not None and looks < budget and radius >= SMALLEST_RADIUS and not _stalls(values):
        step = _step(best, slopes, curvature, radius)
        gain = -float(slopes.value @ step + step @ curvature @ step / 2.0)
        if gain < LEAST_GAIN:  # perhaps because of the reserve, which a smaller radius makes smaller
            radius *= 0.2
            continue
        found = landscape.look(best.position + step)
        looks += 1
        taken = found is not None and found.value < best.value
        watch(looks, found, taken)
        if found is None or not taken:
            radius = 0.4 * float(np.abs(step).max())
        else:
            share = (best.value - found.value) / gain
            radius = _radius(radius, float(np.abs(step).max()), share)
            after = landscape.slopes(found)
            if after is not None:
                curvature = _curvature(curvature, step, after.value - slopes.value)
            best, slopes = found, after
        values.append(best.value)
    if slopes is None:
        reason = "its derivative does not exist"
    elif radius < SMALLEST_RADIUS or _stalls(values):
        reason = "no step improves it much any more"
    else:
        reason = "the evaluations are used up"
    return Descent(best, looks, reason)


def _stalls(values: Sequence[float]) -> bool:
    """Whether the best values after each look have hardly become better of late."""
    return len(values) > PATIENCE and values[-1 - PATIENCE] - values[-1] < LITTLE


def _radius(radius: float, length: float, share: float) -> float:
    """The next radius after a step of a length that brought a share of the expected gain."""
    if share < 0.25:
        return 0.5 * length
    return min(2.0 * radius, LARGEST_RADIUS) if share > 0.75 and length > 0.8 * radius else radius


def _step(point: Iterate, slopes: Slopes, curvature: Array, radius: float) -> Array:
    """The minimiser of the model; missing reserve is a variable beside the step."""
    count = len(point.position)
    sizes = np.abs(slopes.margins).sum(axis=1)
    kept = sizes > 0.0
    rows, sizes = slopes.margins[kept] / sizes[kept, None], sizes[kept]
    margins = point.margins[kept] / sizes
    missing = np.maximum(RESERVE * radius - margins, 0.0)
    price = PRICE * float(np.abs(slopes.value).sum()) * np.ones(len(missing))

    def model(x: Array) -> tuple[float, Array]:
        step, lack = x[:count], x[count:]
        pull = curvature @ step
        return (
            float(slopes.value @ step + step @ pull / 2.0 + price @ lack),
            np.concatenate([slopes.value + pull, price]),
        )

    held = {
        "type": "ineq",
        "fun": lambda x: (
            margins + rows @ x[:count] + x[count:] - np.minimum(RESERVE * radius, margins + missing)
        ),
        "jac": lambda x: np.hstack([rows, np.eye(len(missing))]),
    }
    lowest = np.maximum(-point.position, -radius)
    highest = np.minimum(1.0 - point.position, radius)
    bounds = [*zip(lowest, highest, strict=True), *((0.0, lack) for lack in missing)]
    began = np.concatenate([np.zeros(count), missing])
    solved = minimize(
        model, began, jac=True, bounds=bounds, constraints=[held] if len(rows) else [], method="SLSQP"
    )
    step = np.clip(solved.x[:count], lowest, highest)
    return np.asarray(step, float)


def _curvature(before: Array, step: Array, change: Array) -> Array:
    """Powell's damped BFGS update: positive definite whatever the change of slope."""
    along = before @ step
    bend = float(step @ along)
    seen = float(step @ change)
    share = 1.0 if seen >= 0.2 * bend else 0.8 * bend / (bend - seen)
    damped = share * change + (1.0 - share) * along
    return before - np.outer(along, along) / bend + np.outer(damped, damped) / float(step @ damped)
