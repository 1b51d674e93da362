"""Postures whose forearms come from where hands hold, spines that bend as a whole, and eyes on the load."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from evodesign.human.coupled_joints import coupled_joints
from evodesign.mechanics.agent import HUMAN, ROBOT, Gaze
from evodesign.mechanics.payload import GraspDirection
from evodesign.mechanics.scene import Scene
from evodesign.posture.check import TOLERANCE, AgentModel, Checker, sizes
from evodesign.posture.formulations.base import Setting
from evodesign.posture.formulations.reach import ReachProblem
from evodesign.posture.postures import PostureProblem, Symmetry
from evodesign.posture.results import CaseSolution
from evodesign.problem.build import DesignProblem
from evodesign.records import Hold

LOW = 0.4  # [m]


def solved(problem: DesignProblem, scene: Scene, height: float, symmetry: Symmetry) -> CaseSolution:
    """The unscaled robot's posture with the person of a scene."""
    setting = Setting(scene, problem.space, problem.weights, problem.options)
    design = problem.space.unscaled(scene.robot.tree)
    return PostureProblem(setting, symmetry).solve(design, Hold(height_m=height), checker_of(scene))


def checker_of(scene: Scene) -> Checker:
    return Checker(
        scene, AgentModel.of(scene.robot, scene.robot.tree), AgentModel.of(scene.human, scene.human.tree)
    )


def held(problem: DesignProblem, direction: GraspDirection, cone: float = math.radians(60.0)) -> Scene:
    payload = replace(problem.scene.payload, grasp_direction=direction, grasp_cone=cone)
    return replace(problem.scene, payload=payload)


def excesses(solution: CaseSolution) -> dict[str, float]:
    """By how much the person's joints exceed each shared range [degrees]."""
    joints, found = solution.postures[HUMAN].joints, {}
    for each in coupled_joints():
        together = math.fsum(joints[name] for name in each.joints)
        found[each.name] = math.degrees(max(0.0, each.lower - together, together - each.upper))
    return found


@pytest.fixture(scope="module")
def free(problem: DesignProblem) -> CaseSolution:
    return solved(problem, problem.scene, LOW, Symmetry.ON)


def test_a_spine_that_folds_bends_no_further_than_its_ranges(
    problem: DesignProblem, free: CaseSolution
) -> None:
    """At 0.4 m joints took all of their own ranges; the check refuses that of a person who may not."""
    scene = problem.scene.with_agents(replace(problem.scene.human, coupled_joints=coupled_joints()))
    assert max(excesses(free).values()) > 30.0
    found = sizes(checker_of(scene).residuals(free.instants[0], LOW))
    assert math.degrees(found["human.coupled_joints"]) == pytest.approx(max(excesses(free).values()))
    assert "robot.coupled_joints" not in found
    coupled = solved(problem, scene, LOW, Symmetry.ON)
    assert coupled.solved, coupled.reason
    assert max(excesses(coupled).values()) < math.degrees(TOLERANCE)


@pytest.mark.parametrize("symmetry", [Symmetry.ON, pytest.param(Symmetry.OFF, marks=pytest.mark.slow)])
def test_forearms_stay_within_their_cone(
    problem: DesignProblem, free: CaseSolution, symmetry: Symmetry
) -> None:
    scene = held(problem, GraspDirection.SIDE, math.radians(50.0))
    found = sizes(checker_of(scene).residuals(free.instants[0], LOW))
    assert max(found[f"{agent}.grasp_direction"] for agent in (ROBOT, HUMAN)) > 0.1
    solution = solved(problem, scene, LOW, symmetry)
    assert solution.solved, solution.reason
    assert solution.residuals["robot.grasp_direction"] < TOLERANCE
    assert solution.residuals["human.grasp_direction"] < TOLERANCE


def test_a_free_grasp_has_no_residual(problem: DesignProblem, free: CaseSolution) -> None:
    assert not [name for name in free.residuals if "grasp_direction" in name or "coupled" in name]


def test_a_narrow_cone_narrows_the_reach(problem: DesignProblem) -> None:
    design = problem.space.unscaled(problem.scene.robot.tree)
    ends = []
    for scene in (problem.scene, held(problem, GraspDirection.SIDE, math.radians(40.0))):
        setting = Setting(scene, problem.space, problem.weights, problem.options)
        reach = ReachProblem(setting, symmetric=True).solve(design)
        assert reach.lowest is not None
        assert reach.highest is not None
        ends.append((reach.lowest, reach.highest))
    (low, high), (lower, upper) = ends
    assert lower > low + 0.05
    assert upper < high - 0.01


def test_a_person_sees_the_load_within_the_cone(problem: DesignProblem, free: CaseSolution) -> None:
    head = problem.scene.human.tree.link_by_name["Head"]
    scenes = [
        problem.scene.with_agents(replace(problem.scene.human, gaze=Gaze("Head", head.inertia.center, cone)))
        for cone in (1e-9, math.radians(5.0))
    ]
    off = sizes(checker_of(scenes[0]).residuals(free.instants[0], LOW))["human.gaze"]
    assert "human.gaze" not in free.residuals
    assert off > math.radians(8.0)
    solution = solved(problem, scenes[1], LOW, Symmetry.ON)
    assert solution.solved, solution.reason
    assert solution.residuals["human.gaze"] < TOLERANCE
    found = sizes(checker_of(scenes[0]).residuals(solution.instants[0], LOW))["human.gaze"]
    assert found == pytest.approx(math.radians(5.0), abs=1e-3)
