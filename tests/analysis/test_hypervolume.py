import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from evodesign.analysis.hypervolume import best, hypervolume, reference_point
from evodesign.records import Assessment, Evaluation, Objective, Sense, Status

TORQUE = Objective(name="torque", sense=Sense.MINIMISE, unit="N m")
REACH = Objective(name="reach", sense=Sense.MAXIMISE, unit="m")
MASS = Objective(name="mass", sense=Sense.MINIMISE, unit="kg")
BOTH = (TORQUE, REACH)


def evaluation(number, violation=0.0, **objectives):
    assessment = Assessment(
        design={}, objectives=objectives, violation=violation, status=Status.SOLVED, reason=""
    )
    return Evaluation(
        number=number, generation=0, genome=(0.5,), assessment=assessment, seconds=0.0, worker="here"
    )


def run_of(objectives, points):
    names = [objective.name for objective in objectives]
    return [evaluation(i, **dict(zip(names, point, strict=True))) for i, point in enumerate(points)]


def test_one_design_dominates_a_rectangle():
    run = [evaluation(0, torque=30.0, reach=1.4)]
    assert hypervolume(BOTH, run, {"torque": 50.0, "reach": 1.0}) == pytest.approx(20.0 * 0.4)


def test_two_designs_dominate_two_rectangles_less_their_overlap():
    run = [evaluation(0, torque=30.0, reach=1.4), evaluation(1, torque=20.0, reach=1.2)]
    volume = hypervolume(BOTH, run, {"torque": 50.0, "reach": 1.0})
    assert volume == pytest.approx(20.0 * 0.4 + 30.0 * 0.2 - 20.0 * 0.2)


def test_one_objective_dominates_a_length():
    run = run_of([REACH], [(1.2,), (1.5,), (1.1,)])
    assert hypervolume([REACH], run, {"reach": 1.0}) == pytest.approx(0.5)


def test_a_plane_front_of_three_objectives_dominates_its_staircase():
    """Unit cubes below the diagonal plane i + j + k <= n - 1: n (n + 1) (n + 2) / 6 of them."""
    n = 6
    points = [(i, j, n - 1 - i - j) for i in range(n) for j in range(n - i)]
    objectives = (TORQUE, MASS, Objective(name="peak", sense=Sense.MINIMISE, unit="1"))
    run = run_of(objectives, [tuple(float(n - 1 - x) for x in point) for point in points])
    reference = {"torque": float(n), "mass": float(n), "peak": float(n)}
    assert hypervolume(objectives, run, reference) == pytest.approx(n * (n + 1) * (n + 2) / 6)


def test_infeasible_designs_and_those_beyond_the_reference_add_nothing():
    reference = {"torque": 50.0, "reach": 1.0}
    run = [evaluation(0, torque=30.0, reach=1.4)]
    alone = hypervolume(BOTH, run, reference)
    run += [
        evaluation(1, violation=0.1, torque=1.0, reach=9.0),
        evaluation(2, violation=None, torque=1.0, reach=9.0),
        evaluation(3, torque=1.0),
        evaluation(4, torque=60.0, reach=9.0),
        evaluation(5, torque=1.0, reach=0.9),
        evaluation(6, torque=50.0, reach=9.0),
    ]
    assert hypervolume(BOTH, run, reference) == alone
    assert hypervolume(BOTH, run[1:], reference) == 0.0
    assert hypervolume(BOTH, [], reference) == 0.0


def included_and_excluded(points, reference):
    """Measure of a union of boxes from each point to the reference, by inclusion and exclusion."""
    total = 0.0
    for size in range(1, len(points) + 1):
        for chosen in itertools.combinations(points, size):
            worst = np.max(chosen, axis=0)
            total -= (-1.0) ** size * float(np.prod(np.maximum(np.array(reference) - worst, 0.0)))
    return total


values = st.floats(-5.0, 5.0, allow_subnormal=False)


@given(st.data(), st.integers(1, 4))
def test_agrees_with_inclusion_and_exclusion(data, dimension):
    objectives = (
        TORQUE,
        REACH,
        MASS,
        Objective(name="com_height", sense=Sense.MAXIMISE, unit="m"),
    )[:dimension]
    points = data.draw(st.lists(st.tuples(*[values] * dimension), min_size=1, max_size=6))
    corner = data.draw(st.tuples(*[values] * dimension))
    signs = np.array([1.0, -1.0, 1.0, -1.0])[:dimension]
    expected = included_and_excluded(signs * np.array(points), signs * np.array(corner))
    names = [objective.name for objective in objectives]
    found = hypervolume(objectives, run_of(objectives, points), dict(zip(names, corner, strict=True)))
    largest = 10.0**dimension  # of a box; the terms of the sum cancel to a small part of it
    assert found == pytest.approx(expected, rel=1e-9, abs=1e-12 * largest)


@given(st.lists(st.tuples(values, values), min_size=1, max_size=10))
def test_never_shrinks_as_a_run_goes_on(points):
    run = run_of(BOTH, points)
    reference = {"torque": 6.0, "reach": -6.0}
    volumes = [hypervolume(BOTH, run[:count], reference) for count in range(len(run) + 1)]
    rounding = 1e-12 * volumes[-1]
    assert all(after >= before - rounding for before, after in itertools.pairwise(volumes))


def test_the_reference_is_a_tenth_of_the_range_worse_than_the_worst():
    run = [
        evaluation(0, torque=30.0, reach=1.4),
        evaluation(1, torque=50.0, reach=1.6),
        evaluation(2, violation=1.0, torque=900.0, reach=0.1),
        evaluation(3, reach=0.1),
    ]
    assert reference_point(BOTH, run) == pytest.approx({"torque": 52.0, "reach": 1.38})


def test_without_a_range_the_reference_is_worse_by_a_tenth_of_the_value():
    assert reference_point(BOTH, run_of(BOTH, [(30.0, 1.5)])) == pytest.approx(
        {"torque": 33.0, "reach": 1.35}
    )
    assert reference_point(BOTH, run_of(BOTH, [(-30.0, -1.5)])) == pytest.approx(
        {"torque": -27.0, "reach": -1.65}
    )


def test_zero_without_a_range_moves_the_reference_by_one():
    assert reference_point(BOTH, run_of(BOTH, [(0.0, 0.0)] * 2)) == {"torque": 1.0, "reach": -1.0}


def test_nothing_feasible_has_no_reference_and_no_best():
    run = [evaluation(0, violation=1.0, torque=1.0, reach=1.0)]
    assert reference_point(BOTH, run) is None
    assert best(BOTH, run) == {}


@given(st.lists(st.tuples(values, values), min_size=1, max_size=8))
def test_no_design_lies_beyond_its_own_reference(points):
    run = run_of(BOTH, points)
    reference = reference_point(BOTH, run)
    for one in run:
        assert one.assessment.objectives["torque"] <= reference["torque"]
        assert one.assessment.objectives["reach"] >= reference["reach"]
    assert math.isfinite(hypervolume(BOTH, run, reference))


def test_the_best_values_may_belong_to_different_designs():
    run = [
        evaluation(0, torque=30.0, reach=1.4),
        evaluation(1, torque=50.0, reach=1.6),
        evaluation(2, violation=0.1, torque=1.0, reach=9.0),
    ]
    assert best(BOTH, run) == {"torque": 30.0, "reach": 1.6}
