"""The nearest bodies of postures, and feet that do not stand on each other."""

from __future__ import annotations

from dataclasses import replace

import msgspec
import numpy as np
import pytest

from evodesign.collision.rules import LOAD
from evodesign.errors import RunError
from evodesign.evaluation.clearance import Clearances, overlaps, solved_distances
from evodesign.evaluation.evaluate import Evaluator, detail_of
from evodesign.evaluation.evaluation_json import evaluation_json
from evodesign.mechanics.agent import ROBOT
from evodesign.posture.check import AgentModel
from evodesign.problem.build import DesignProblem
from evodesign.quantities.design_result import DesignResult

GAP = 0.01


def solved(problem: DesignProblem, feet_gap: float | None) -> DesignResult:
    """The unscaled robot with feet that are so far apart."""
    scenes = tuple(
        replace(scene, stance=replace(scene.stance, feet_gap=feet_gap)) for scene in problem.scenes
    )
    other = replace(problem, scenes=scenes)
    return Evaluator(other).solve(problem.space.unscaled(problem.scene.robot.tree))


@pytest.fixture(scope="module")
def free(problem: DesignProblem) -> DesignResult:
    return solved(problem, None)


def soles_apart(problem: DesignProblem, result: DesignResult) -> list[float]:
    """By how much the robot's soles are apart sideways in each solved case, as rectangles [m]."""
    robot = problem.scene.robot
    model, (length, width) = (
        AgentModel.of(robot, result.tree),
        (robot.feet[0].sole.length, robot.feet[0].sole.width),
    )
    found = []
    for solution in result.cases:
        state = model.at(solution.postures[ROBOT])
        reached = {}
        for foot in robot.feet:
            rotation, origin = state.pose(foot.frame)
            corners = [[x * length / 2.0, y * width / 2.0, 0.0] for x in (-1, 1) for y in (-1, 1)]
            reached[foot.side] = (origin + np.array(corners) @ rotation.T)[:, 1]
        found.append(float(reached["left"].min() - reached["right"].max()))
    return found


def test_feet_may_stand_on_each_other_only_where_nothing_forbids_it(
    problem: DesignProblem, free: DesignResult
) -> None:
    apart = solved(problem, GAP)
    assert min(soles_apart(problem, free)) < GAP
    assert all(solution.solved for solution in apart.cases)
    assert min(soles_apart(problem, apart)) >= GAP - 1e-6
    feet = {"robot l_foot_front", "robot r_foot_front"}
    assert all(
        not {gap.first, gap.second} <= feet for gap in solved_distances(apart).values() if gap.distance < 0
    )


def test_overlapping_bodies_are_told_with_how_deep_they_are(
    problem: DesignProblem, free: DesignResult
) -> None:
    """A thick load at the chest of the robot overlaps it by what boxes say."""
    cases = [detail_of(solution) for solution in free.cases]
    scenes = [replace(problem.scene, payload=replace(problem.scene.payload, size=(2.0, 2.0, 2.0)))]
    gaps = Clearances(scenes).of(free.tree, cases)
    assert all(LOAD in (gap.first, gap.second) and gap.distance < -0.1 for gap in gaps)
    sentences = overlaps((case.case, gap) for case, gap in zip(cases, gaps, strict=True))
    assert len(sentences) == len(cases)
    assert sentences[0].startswith(f"at {cases[0].case.task}, ")
    assert sentences[0].endswith(f"overlap by {-1e3 * gaps[0].distance:.1f} mm")


def test_evaluate_tells_the_nearest_bodies_of_each_case(problem: DesignProblem, free: DesignResult) -> None:
    evaluator = Evaluator(problem)
    values = problem.space.unscaled(problem.scene.robot.tree)
    assessment, solved = evaluator.assessment(values, free), evaluator.details(free)
    told = evaluation_json(problem, values, free, assessment, {}, solved)
    distances = solved_distances(free)
    assert len(distances) == len(told["cases"])
    for case, found in zip(told["cases"], distances.values(), strict=True):
        assert case["clearance"] == {
            "bodies": [found.first, found.second],
            "distance_m": found.distance,
        }


def test_a_posture_of_a_stranger_is_refused_in_a_sentence(problem: DesignProblem, free: DesignResult) -> None:
    (case, *_) = [detail_of(solution) for solution in free.cases]
    stranger = msgspec.structs.replace(case, case=msgspec.structs.replace(case.case, person="nobody"))
    with pytest.raises(RunError, match="nobody"):
        Clearances(problem.scenes).of(free.tree, [stranger])
