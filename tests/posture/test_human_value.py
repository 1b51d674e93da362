"""The person's value function, and robots solved against it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.polynomial import chebyshev

from evodesign.posture.cache import open_cache
from evodesign.posture.form import symmetric_forms
from evodesign.posture.human_value import LARGEST_ERROR, HumanProblem, HumanValue, chebyshev_sum
from evodesign.posture.prepare import human_values
from evodesign.problem.build import Problem
from evodesign.problem.evaluate import Evaluator
from evodesign.records import Status
from evodesign.statics.scene import Grasp


@given(st.lists(st.floats(-5.0, 5.0), min_size=2, max_size=9), st.floats(-1.0, 1.0))
def test_clenshaws_sum_is_numpys(coefficients: list[float], x: float) -> None:
    assert chebyshev_sum(coefficients, x) == pytest.approx(chebyshev.chebval(x, coefficients), abs=1e-9)


def test_value_is_what_solving_the_person_gives(problem: Problem, people: tuple[HumanValue, ...]) -> None:
    """At pushes that are no nodes, against a solve from the nearest node."""
    person = HumanProblem(symmetric_forms(problem.scene)[1], problem.scene, 1.0, problem.options)
    assert [value.height for value in people] == list(problem.heights)
    for value in people:
        assert value.error <= LARGEST_ERROR
        for push in (-4.3, -1.1, 0.7, 3.9):
            found = person.solve(value.height, push, value.nearest(push))
            assert found.status is Status.SOLVED
            assert found.cost == pytest.approx(value.cost(push), abs=max(LARGEST_ERROR, 2.0 * value.error))


def test_one_after_the_other_is_about_as_good_as_both_at_once(
    problem: Problem, people: tuple[HumanValue, ...]
) -> None:
    """Mean below 0.5 % above the joint program from the same number of starts, and often better."""
    split, joint = Evaluator(problem, people), Evaluator(problem)
    rng = np.random.default_rng(5)
    excess = []
    for _ in range(5):
        values = problem.space.values(tuple(rng.uniform(size=len(problem.space.parameters))))
        for one, both in zip(split.solve(values).heights, joint.solve(values).heights, strict=True):
            assert one.status == both.status
            if one.solved:
                costs = [min(a.cost for a in s.attempts if a.status is Status.SOLVED) for s in (one, both)]
                excess.append(costs[0] / costs[1] - 1.0)
    assert len(excess) >= 10
    assert float(np.mean(excess)) < 0.005


def test_cache_does_not_change_a_score(problem: Problem, tmp_path_factory: pytest.TempPathFactory) -> None:
    said: list[str] = []
    cache = open_cache(tmp_path_factory.mktemp("people"))
    scene, options = problem.scene, problem.options
    first, second = (human_values(scene, 1.0, (1.0,), options, cache, said.append) for _ in range(2))
    assert len(said) == 1, "the second time it is read"
    assert first[0].coefficients == second[0].coefficients
    assert first[0].error == second[0].error
    for one, other in zip(first[0].starts, second[0].starts, strict=True):
        assert one[0] == other[0]
        assert all(np.array_equal(one[1][name], other[1][name]) for name in one[1])


def test_rigid_grasps_and_no_push_have_no_value(problem: Problem) -> None:
    scene = problem.scene
    rigid = replace(scene, payload=replace(scene.payload, grasp=Grasp.RIGID))
    still = replace(scene, stance=replace(scene.stance, push=0.0))
    for other in (rigid, still):
        assert human_values(other, 1.0, (1.0,), problem.options, None, lambda _: None) == ()


def test_height_out_of_the_persons_reach_has_no_value(problem: Problem) -> None:
    scene = problem.scene
    assert human_values(scene, 1.0, (2.6,), problem.options, None, lambda _: None) == ()
