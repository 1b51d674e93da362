"""The person's value function, and robots solved against it."""

from __future__ import annotations

from dataclasses import replace

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.polynomial import chebyshev

from evodesign.mechanics.scene import HUMAN, Grasp, GraspDirection, Scene
from evodesign.nlp.solver import RawSolution
from evodesign.posture.check import AgentModel, near_bodies
from evodesign.posture.formulations.human_value import LARGEST_ERROR, HumanProblem, chebyshev_sum
from evodesign.posture.precompute.pieces import compute_piece, with_piece
from evodesign.posture.precompute.plan import Piece, Subject, stages
from evodesign.posture.precompute.precomputed import NOTHING_PRECOMPUTED, Precomputed
from evodesign.posture.starts import person_starts
from evodesign.posture.symmetry import symmetric_forms
from evodesign.posture.warm_start import instants_of, layout_of
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.evaluate import Evaluator
from evodesign.problem.precompute import precompute_setting
from evodesign.records import Case, Hold, Status


@given(st.lists(st.floats(-5.0, 5.0), min_size=2, max_size=9), st.floats(-1.0, 1.0))
def test_clenshaws_sum_is_numpys(coefficients: list[float], x: float) -> None:
    assert chebyshev_sum(coefficients, x) == pytest.approx(chebyshev.chebval(x, coefficients), abs=1e-9)


def test_value_is_what_solving_the_person_gives(problem: DesignProblem, known: Precomputed) -> None:
    """At pushes that are no nodes, against a solve from the nearest node."""
    person = HumanProblem(symmetric_forms(problem.scene)[1], problem.scene, 1.0, problem.options)
    assert [case.task for case in known.values] == list(problem.tasks)
    for case, value in known.values.items():
        assert value.error <= LARGEST_ERROR
        for push in (-4.3, -1.1, 0.7, 3.9):
            found = person.solve(case.task.height_m, push, value.nearest(push)[0])
            assert found.status is Status.SOLVED
            assert found.cost == pytest.approx(value.cost(push), abs=max(LARGEST_ERROR, 2.0 * value.error))


def test_one_after_the_other_is_about_as_good_as_both_at_once(
    problem: DesignProblem, known: Precomputed
) -> None:
    """Mean below 0.5 % above the joint program from the same number of starts, and often better."""
    split, joint = Evaluator(problem, known), Evaluator(problem)
    rng = np.random.default_rng(5)
    excess = []
    for _ in range(5):
        values = problem.space.values(tuple(rng.uniform(size=len(problem.space.parameters))))
        for one, both in zip(split.solve(values).cases, joint.solve(values).cases, strict=True):
            assert one.status == both.status
            if one.solved:
                costs = [min(a.cost for a in s.attempts if a.status is Status.SOLVED) for s in (one, both)]
                excess.append(costs[0] / costs[1] - 1.0)
    assert len(excess) >= 10
    assert float(np.mean(excess)) < 0.005


def test_value_that_was_kept_is_the_one_that_was_worked_out(
    problem: DesignProblem, known: Precomputed
) -> None:
    fresh = HumanProblem(symmetric_forms(problem.scene)[1], problem.scene, 1.0, problem.options).value(1.0)
    kept = known.values[Case(task=Hold(height_m=1.0))]
    assert fresh is not None
    assert (fresh.coefficients, fresh.push, fresh.error) == (kept.coefficients, kept.push, kept.error)
    for one, other in zip(fresh.starts, kept.starts, strict=True):
        assert one[0] == other[0]
        assert all(np.array_equal(one[1][name], other[1][name]) for name in one[1])


def test_the_person_starts_anew_where_the_nearest_node_misleads(
    problem: DesignProblem, known: Precomputed
) -> None:
    value = known.values[Case(task=Hold(height_m=1.0))]
    person = HumanProblem(symmetric_forms(problem.scene)[1], problem.scene, 1.0, problem.options)
    (nearest, start), *others = sorted(value.starts, key=lambda node: abs(node[0]))
    broken = {**start, "human.joints": np.full_like(start["human.joints"], np.nan)}
    misleading = msgspec.structs.replace(value, starts=((nearest, broken), *others))
    assert person.solve(1.0, 0.0, broken).status is not Status.SOLVED
    found = person.best(1.0, 0.0, misleading)
    assert found.status is Status.SOLVED
    assert found.cost == pytest.approx(value.cost(0.0), abs=LARGEST_ERROR)


def pieces(problem: DesignProblem, scene: Scene) -> list[Subject]:
    setting = replace(precompute_setting(problem), scenes=(scene,))
    return [
        piece.subject
        for stage in stages(setting, (Hold(height_m=1.0),), portfolios=False, person_reaches=False)
        for piece in stage
    ]


def test_rigid_grasps_and_no_push_have_no_value(problem: DesignProblem) -> None:
    scene = problem.scene
    rigid = replace(scene, payload=replace(scene.payload, grasp=Grasp.RIGID))
    still = replace(scene, stance=replace(scene.stance, push=0.0))
    assert [pieces(problem, other) for other in (scene, rigid, still)] == [[Subject.PERSON], [], []]


def test_height_out_of_the_persons_reach_has_no_value(problem: DesignProblem) -> None:
    setting, piece = precompute_setting(problem), Piece(Subject.PERSON, ("", ""), Hold(height_m=2.6))
    content = compute_piece(setting, piece, NOTHING_PRECOMPUTED)
    assert with_piece(NOTHING_PRECOMPUTED, piece, content) == NOTHING_PRECOMPUTED
    assert with_piece(NOTHING_PRECOMPUTED, piece, b'{"push_n":') is None, (
        "a content that cannot be read is missing"
    )


def test_postures_in_which_the_persons_bodies_overlap_do_not_count(problem: DesignProblem) -> None:
    """With rows for the feet alone people fold through themselves: at 0.5 m always, at 0.7 m at less cost."""
    source = msgspec.structs.replace(problem.source, text=f"{problem.source.text}\n[collisions]\n")
    scene = build_problem(source).scene
    form = symmetric_forms(scene)[1]
    person, model = (
        HumanProblem(form, scene, 1.0, problem.options),
        AgentModel.of(scene.human, scene.human.tree),
    )

    def overlap(raw: RawSolution) -> float:
        (instant,) = instants_of(layout_of(person.program, HUMAN), (form,), scene, raw.values)
        gaps = near_bodies((model,), instant.postures, scene.payload.size, 0.7)
        return -min((gap.distance for gap in gaps), default=0.0)

    ends = [person.solve(0.7, 0.0, start) for start in person_starts(person.program)]
    solved = sorted((end for end in ends if end.status is Status.SOLVED), key=lambda end: end.cost)
    assert overlap(solved[0]) > 0.01
    best = person.best_of_many(0.7, 0.0)
    assert best is not None
    assert overlap(best) == 0.0
    assert best.cost == min(end.cost for end in solved if overlap(end) == 0.0) > 1.1 * solved[0].cost
    assert person.value(0.5) is None


@pytest.mark.slow
def test_a_push_that_met_only_worse_optima_starts_at_those_of_others(
    problem: DesignProblem, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With the forearms' direction given, the twelve starts find the least cost under some pushes alone."""
    payload = replace(problem.scene.payload, grasp_direction=GraspDirection.SIDE)
    scene = replace(problem.scene, payload=payload)
    person = HumanProblem(symmetric_forms(scene)[1], scene, problem.weights.human, problem.options)
    value = person.value(0.8)
    assert value is not None
    ends = [person.solve(0.8, 0.0, start) for start in person_starts(person.program)]
    assert value.cost(0.0) < min(end.cost for end in ends if end.status is Status.SOLVED) + LARGEST_ERROR
    monkeypatch.setattr(HumanProblem, "_from_others", lambda self, height, best: best)
    assert person.value(0.8) is None
