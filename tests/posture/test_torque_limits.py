"""Joint torque limits of the robot as constraints of posture and reach."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from evodesign.evaluation.evaluate import Evaluator
from evodesign.evaluation.sensitivities import Sensitivities
from evodesign.mechanics.agent import HUMAN, ROBOT
from evodesign.mechanics.disturbance import Disturbance, Disturbances
from evodesign.posture.check import AgentModel, Checker
from evodesign.problem.build import DesignProblem
from evodesign.quantities.design_result import DesignResult
from evodesign.records import Hold
from tests.posture.violations import violations

HEIGHT = 1.2


def limited(problem: DesignProblem, limits: Mapping[str, float], height: float = HEIGHT) -> DesignProblem:
    """The point-grasp problem at one height, with a robot whose joint torques are no more than this [N m]."""
    robot = replace(problem.scene.robot, torque_limits=limits, limits_torques=bool(limits))
    scenes = tuple(scene.with_agents(robot) for scene in problem.scenes)
    return replace(problem, scenes=scenes, tasks=(Hold(height_m=height),))


def unscaled(problem: DesignProblem) -> tuple[float, ...]:
    return problem.space.unscaled(problem.scene.robot.tree)


@pytest.fixture(scope="module")
def free(problem: DesignProblem) -> DesignResult:
    """Without limits: the shoulders need 4.4 N m."""
    return Evaluator(limited(problem, {})).solve(unscaled(problem))


SHOULDERS = {"l_shoulder_pitch": 1.5, "r_shoulder_pitch": 1.5}


@pytest.fixture(scope="module")
def held(problem: DesignProblem) -> DesignResult:
    return Evaluator(limited(problem, SHOULDERS)).solve(unscaled(problem))


def test_no_torque_is_beyond_its_limit_and_the_posture_costs_more(
    free: DesignResult, held: DesignResult
) -> None:
    before, after = (result.cases[0].postures[ROBOT] for result in (free, held))
    assert abs(before.torques["l_shoulder_pitch"]) > 2.0
    for name, limit in SHOULDERS.items():
        assert abs(after.torques[name]) == pytest.approx(limit, abs=1e-5)
    assert after.torque_norm > before.torque_norm + 0.1
    assert after.torque_norm < 1.2 * before.torque_norm


def test_the_check_measures_how_far_a_torque_is_beyond_its_limit(
    problem: DesignProblem, free: DesignResult, held: DesignResult
) -> None:
    assert held.cases[0].residuals["robot.torque_limits"] < 1e-6
    assert "robot.torque_limits" not in free.cases[0].residuals
    assert "human.torque_limits" not in held.cases[0].residuals
    scene = limited(problem, SHOULDERS).scene
    human = AgentModel.of(scene.human, scene.human.tree)
    found = violations(
        Checker(scene, AgentModel.of(scene.robot, free.tree), human), free.cases[0].postures, HEIGHT
    )
    torques = free.cases[0].postures[ROBOT].torques
    assert found["robot.torque_limits"] == pytest.approx(abs(torques["l_shoulder_pitch"]) - 1.5)


def test_a_pair_has_the_limit_of_its_weaker_joint(problem: DesignProblem, held: DesignResult) -> None:
    unequal = {"l_shoulder_pitch": 30.0, "r_shoulder_pitch": 1.5}
    found = Evaluator(limited(problem, unequal)).solve(unscaled(problem)).cases[0].postures
    assert found[ROBOT].torque_norm == pytest.approx(held.cases[0].postures[ROBOT].torque_norm, rel=1e-6)
    assert found[HUMAN].torque_norm == pytest.approx(held.cases[0].postures[HUMAN].torque_norm, rel=1e-4)


def test_limits_that_nothing_meets_change_nothing(problem: DesignProblem, free: DesignResult) -> None:
    wide = dict.fromkeys(problem.scene.robot.joints, 500.0)
    found = Evaluator(limited(problem, wide)).solve(unscaled(problem))
    assert found.reach.highest == pytest.approx(free.reach.highest, abs=1e-6)
    assert found.cases[0].postures[ROBOT].torque_norm == pytest.approx(
        free.cases[0].postures[ROBOT].torque_norm, rel=1e-6
    )


def test_reach_is_what_the_joints_can_hold(problem: DesignProblem, free: DesignResult) -> None:
    weak = limited(problem, dict.fromkeys(problem.scene.robot.joints, 5.0))
    found, strong = (
        Evaluator(replace(each, whole_reach=True)).solve(unscaled(problem)).reach
        for each in (weak, limited(problem, {}))
    )
    assert found.lowest is not None
    assert strong.lowest is not None
    assert found.lowest > strong.lowest + 0.1, "a robot that squats needs more than 5 N m in its legs"
    asked = Evaluator(weak).solve(unscaled(problem)).reach
    assert free.reach.highest is not None
    assert found.highest == pytest.approx(asked.highest, abs=1e-6)
    assert found.highest < free.reach.highest - 0.1


def test_gradients_know_a_limit_that_is_met(problem: DesignProblem) -> None:
    """Against differences of what a search would see; the shoulders are at their limit throughout."""
    chosen = limited(problem, SHOULDERS)
    evaluator, values = Evaluator(chosen), np.array(unscaled(problem))
    result = evaluator.solve(values)
    gradient = (
        Sensitivities(chosen, evaluator.known).at(tuple(values), result).sensitivities()["robot_torque"]
    )
    assert gradient.gradient is not None
    names = [parameter.name for parameter in problem.space.parameters]
    for name, step in (("length.forearm", 1e-4), ("density.upper_arm", 0.5)):
        change = step * np.eye(len(values))[names.index(name)]
        ahead, behind = (
            evaluator.solve(values + sign * change).cases[0].postures[ROBOT].torque_norm
            for sign in (1.0, -1.0)
        )
        assert gradient.gradient[name] == pytest.approx((ahead - behind) / (2.0 * step), rel=2e-3)


def test_limits_hold_under_a_heavier_load_too(problem: DesignProblem) -> None:
    heavier = Disturbances((Disturbance("heavier", mass_share=0.2),))
    chosen = limited(problem, SHOULDERS)
    scenes = tuple(replace(scene, disturbances=heavier) for scene in chosen.scenes)
    result = Evaluator(replace(chosen, scenes=scenes)).solve(unscaled(problem)).cases[0]
    assert result.solved
    loaded = [postures[ROBOT] for postures in (result.postures, *result.disturbed.values())]
    assert len(loaded) == 2
    for posture in loaded:
        assert abs(posture.torques["l_shoulder_pitch"]) <= 1.5 + 1e-5
    assert result.residuals["heavier: robot.torque_limits"] < 1e-6
