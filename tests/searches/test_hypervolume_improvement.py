"""On whole numbers the space falls into unit cells, so that volumes and distances can be counted out."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from evodesign.searches.hypervolume_improvement import HypervolumeImprovement, local_upper_bounds

SIDE = 4
"""The reference is (4, 4, 4); points have coordinates from 0 to 5, so that some lie beyond."""

coordinates = st.integers(0, SIDE + 1).map(float)
point = st.tuples(coordinates, coordinates, coordinates)
points = st.lists(point, max_size=5)


def gain(others, of):
    return HypervolumeImprovement(np.array(others).reshape(-1, 3), np.full(3, float(SIDE)))(np.array(of))


def free_cells(others):
    """Lower corners of the unit cells, from -1 on, below the reference and dominated by no point."""
    cells = itertools.product(range(-1, SIDE), repeat=3)
    return [c for c in cells if not any(all(s <= x for s, x in zip(p, c, strict=True)) for p in others)]


def counted(others, of):
    free = free_cells(others)
    added = sum(all(z <= x for z, x in zip(of, cell, strict=True)) for cell in free)
    if added:
        return float(added)
    return -min(
        math.hypot(*(max(z - (x + 1.0), 0.0) for z, x in zip(of, cell, strict=True))) for cell in free
    )


@given(points, point)
def test_gain_and_distance_are_those_counted_in_unit_cells(others, of):
    assert gain(others, of) == pytest.approx(counted(others, of), abs=1e-12)


@given(points, point, st.tuples(*[st.integers(0, 3)] * 3))
def test_a_dominating_point_never_has_less_value(others, of, losses):
    worse = tuple(value + loss for value, loss in zip(of, losses, strict=True))
    assert gain(others, worse) <= gain(others, of)


@given(st.lists(point, min_size=1, max_size=5))
def test_a_copy_of_a_point_adds_nothing(others):
    assert all(gain(others, of) <= 0.0 for of in others)


def test_an_example_worked_by_hand():
    """Between (1, 3) and (3, 1) a unit square is left at (2, 2); its far corner is (3, 3)."""
    held = HypervolumeImprovement(np.array([[1.0, 3.0], [3.0, 1.0]]), np.array([4.0, 4.0]))
    assert held(np.array([2.0, 2.0])) == pytest.approx(1.0, rel=1e-12)
    assert held(np.array([3.0, 3.0])) == 0.0
    assert held(np.array([3.5, 3.5])) == pytest.approx(-math.sqrt(0.5), rel=1e-12)
    assert held(np.array([0.5, 5.0])) == pytest.approx(-1.0, rel=1e-12)


def test_without_points_the_gain_is_the_box_below_the_reference():
    assert gain([], (1.0, 2.0, 3.0)) == pytest.approx(6.0, rel=1e-12)


def test_a_staircase_has_a_corner_between_each_two_steps():
    corners = local_upper_bounds(np.array([[2.0, 2.0], [1.0, 3.0], [3.0, 1.0]]), np.array([4.0, 5.0]))
    assert sorted(map(tuple, corners.tolist())) == [(1.0, 5.0), (2.0, 3.0), (3.0, 2.0), (4.0, 1.0)]


@pytest.mark.parametrize("count", [1, 2, 5, 20])
def test_in_three_dimensions_the_corners_are_twice_the_points_and_one(count):
    """Klamroth, Lacour and Vanderpooten 2015: exact for points that share no coordinate."""
    generator = np.random.default_rng(count)
    sphere = np.abs(generator.standard_normal((count, 3)))
    sphere /= np.linalg.norm(sphere, axis=1, keepdims=True)
    assert len(local_upper_bounds(-sphere, np.zeros(3))) == 2 * count + 1
