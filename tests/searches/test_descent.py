"""Going downhill: arrives where it should, stays where it may, and never gets worse."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import pytest
from numpy.typing import NDArray

from evodesign.searches.descent import Descent, DescentProblem, Iterate, Slopes, descend

Array = NDArray[np.float64]


@dataclass
class Bowl:
    """A quadratic bowl with its bottom somewhere, a margin, and a region that does not exist."""

    bottom: Array
    exists: Callable[[Array], bool] = lambda position: True
    margin: Array = field(default_factory=lambda: np.zeros(0))
    looked: list[Array] = field(default_factory=list)
    weights = np.array([1.0, 10.0, 0.1])

    def look(self, position: Array) -> Iterate | None:
        self.looked.append(position)
        margins = np.array([1.0 - self.margin @ position]) if len(self.margin) else np.zeros(0)
        if not self.exists(position) or (margins < 0.0).any():
            return None
        return Iterate(position, float(self.weights @ (position - self.bottom) ** 2), margins)

    def slopes(self, point: Iterate) -> Slopes | None:
        rows = -self.margin[None, :] if len(self.margin) else np.zeros((0, 3))
        return Slopes(2.0 * self.weights * (point.position - self.bottom), rows)


def go(landscape: DescentProblem, position: list[float], budget: int = 100) -> Descent:
    start = landscape.look(np.array(position))
    assert start is not None
    found = descend(landscape, start, budget, lambda number, point, taken: None)
    assert found.best.value <= start.value
    return found


def test_bottom_of_a_bowl_is_found() -> None:
    found = go(Bowl(np.array([0.3, 0.7, 0.5])), [0.9, 0.1, 0.2])
    assert found.best.position == pytest.approx([0.3, 0.7, 0.5], abs=2e-3)
    assert found.best.value < 1e-6
    assert found.looks < 40


def test_bounds_hold_and_are_reached() -> None:
    bowl = Bowl(np.array([1.5, 0.7, -0.5]))
    found = go(bowl, [0.5, 0.5, 0.5])
    assert found.best.position == pytest.approx([1.0, 0.7, 0.0], abs=1e-3)
    assert all(((position >= 0.0) & (position <= 1.0)).all() for position in bowl.looked)


def test_margin_holds_and_is_reached() -> None:
    """The bottom beyond the plane x + y = 1: the nearest point of the plane in the bowl's own measure."""
    found = go(Bowl(np.array([0.9, 0.7, 0.5]), margin=np.array([1.0, 1.0, 0.0])), [0.1, 0.1, 0.5])
    multiplier = (0.9 + 0.7 - 1.0) / (1.0 / 1.0 + 1.0 / 10.0)
    assert found.best.position[:2] == pytest.approx([0.9 - multiplier, 0.7 - multiplier / 10.0], abs=5e-3)


def test_region_that_does_not_exist_is_not_entered() -> None:
    bowl = Bowl(np.array([0.9, 0.5, 0.5]), exists=lambda position: bool(position[0] <= 0.6))
    found = go(bowl, [0.1, 0.2, 0.5])
    assert found.best.position[0] == pytest.approx(0.6, abs=0.02)
    assert found.best.position[0] <= 0.6


@dataclass
class Ridge:
    """|x - 0.5| + y^2: not differentiable along x = 0.5, where it has the slope of one side."""

    def look(self, position: Array) -> Iterate | None:
        return Iterate(position, float(abs(position[0] - 0.5) + position[1] ** 2), np.zeros(0))

    def slopes(self, point: Iterate) -> Slopes | None:
        sign = 1.0 if point.position[0] > 0.5 else -1.0
        return Slopes(np.array([sign, 2.0 * point.position[1]]), np.zeros((0, 2)))


def test_points_without_a_derivative_are_approached_without_getting_worse() -> None:
    assert go(Ridge(), [0.8, 0.8]).best.value < 0.1


@dataclass
class Fold:
    """A slope that has no derivative to the left of x = 0.4."""

    def look(self, position: Array) -> Iterate | None:
        return Iterate(position, float(position[0]), np.zeros(0))

    def slopes(self, point: Iterate) -> Slopes | None:
        return None if point.position[0] < 0.4 else Slopes(np.ones(1), np.zeros((0, 1)))


def test_descent_ends_where_there_is_no_derivative() -> None:
    found = go(Fold(), [0.7])
    assert found.reason == "its derivative does not exist"
    assert found.best.position[0] < 0.4


def test_budget_is_kept() -> None:
    bowl = Bowl(np.array([0.3, 0.7, 0.5]))
    found = go(bowl, [0.9, 0.1, 0.2], budget=3)
    assert found.looks == 3
    assert len(bowl.looked) == 4, "the start, and three more"
    assert found.reason == "the evaluations are used up"


def test_bottom_stays_where_it_is() -> None:
    found = go(Bowl(np.array([0.3, 0.7, 0.5])), [0.3, 0.7, 0.5])
    assert found.looks == 0
    assert found.reason == "no step improves it much any more"
