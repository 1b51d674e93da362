"""Symmetric postures are solutions of the whole problem, and scenes that are not symmetric are refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from evodesign.design.parameter import DesignParameter, ParameterKind
from evodesign.design.space import DesignSpace
from evodesign.errors import ModelError
from evodesign.mechanics.agent import HUMAN, ROBOT
from evodesign.mechanics.payload import Payload
from evodesign.posture.check import AgentModel, Checker
from evodesign.posture.formulations.base import Setting
from evodesign.posture.formulations.reach import ReachProblem
from evodesign.posture.postures import PostureProblem, Symmetry
from evodesign.posture.precompute.precomputed import NOTHING_PRECOMPUTED, Precomputed
from evodesign.posture.results import CaseSolution
from evodesign.posture.seeking.budget import BUDGET
from evodesign.posture.seeking.start_portfolio import Coverage, StartPortfolio
from evodesign.posture.seeking.starts import different_people
from evodesign.posture.symmetry import half, symmetric_forms
from evodesign.problem.build import DesignProblem
from evodesign.records import Case, Hold, Status


def solve(
    problem: DesignProblem,
    symmetry: Symmetry,
    height: float = 1.0,
    known: Precomputed = NOTHING_PRECOMPUTED,
) -> CaseSolution:
    scene, space = problem.scene, problem.space
    values = space.unscaled(scene.robot.tree)
    checker = Checker(
        scene,
        AgentModel.of(scene.robot, space.resized(scene.robot.tree, values)),
        AgentModel.of(scene.human, scene.human.tree),
    )
    return PostureProblem(Setting(scene, space, problem.weights, problem.options), symmetry, known).solve(
        values, Hold(height_m=height), checker
    )


def cost(solution: CaseSolution) -> float:
    return min(attempt.cost for attempt in solution.attempts if attempt.status is Status.SOLVED)


def test_half_and_whole_describe_the_same_problem(problem: DesignProblem) -> None:
    """Solved as a half, the whole posture passes the whole check; polished, it costs no more."""
    symmetric, polished = (solve(problem, symmetry) for symmetry in (Symmetry.ON, Symmetry.POLISH))
    assert symmetric.status is Status.SOLVED
    assert max(symmetric.residuals.values()) < 1e-6
    assert cost(polished) <= cost(symmetric) * (1.0 + 1e-6)


def test_cost_of_a_half_is_that_of_the_whole_at_the_same_posture(problem: DesignProblem) -> None:
    """The paired torques count twice: recomputed here from the expanded posture."""
    solution = solve(problem, Symmetry.ON)
    effort = sum(posture.torque_norm**2 for posture in solution.postures.values()) / 100.0
    assert effort <= cost(solution) <= effort * 1.1, "the regularisation is a small part of the cost"


def test_right_side_mirrors_the_left(problem: DesignProblem) -> None:
    robot = solve(problem, Symmetry.ON).postures[ROBOT]
    for name, position in robot.joints.items():
        if name.startswith("l_"):
            assert robot.joints["r_" + name[2:]] == position
            assert robot.torques["r_" + name[2:]] == robot.torques[name]
    assert robot.joints["torso_yaw"] == robot.joints["torso_roll"] == 0.0
    mirrored = robot.wrenches["left_foot"] * [1.0, -1.0, 1.0, -1.0, 1.0, -1.0]
    assert np.allclose(robot.wrenches["right_foot"], mirrored)


def test_symmetric_reach_is_the_whole_reach(problem: DesignProblem) -> None:
    """What can be reached at the top with two hands is reached symmetrically."""
    values = problem.space.unscaled(problem.scene.robot.tree)
    highest = [
        ReachProblem(
            Setting(problem.scene, problem.space, problem.weights, problem.options), symmetric=symmetric
        )
        .solve(values)
        .highest
        for symmetric in (True, False)
    ]
    assert highest[0] == pytest.approx(highest[1], abs=1e-3)


def test_a_whole_posture_that_no_known_start_leads_to_is_sought_from_the_fixed_starts(
    problem: DesignProblem,
) -> None:
    hurried = replace(problem, options=replace(problem.options, iterations=2))
    joints = {"robot.joints": np.zeros(len(problem.scene.robot.joints))}
    portfolio = StartPortfolio((joints,), Coverage(0, 0, 0.0))
    solution = solve(
        hurried,
        Symmetry.OFF,
        known=Precomputed(postures={Case(person="", payload="", task=Hold(height_m=1.0)): portfolio}),
    )
    starts = ["whole: start 1", "whole: fixed start 1", "whole: fixed start 2"]
    assert [attempt.name for attempt in solution.attempts] == starts


def test_the_people_of_all_starts_are_tried_beside_the_best_robot(problem: DesignProblem) -> None:
    space, task, other = problem.space, Hold(height_m=1.0), Hold(height_m=1.1)
    landscape = PostureProblem(
        Setting(problem.scene, space, problem.weights, problem.options), Symmetry.OFF
    ).landscape(task)
    ends = [landscape.solve(space.unscaled(problem.scene.robot.tree), start) for start in landscape.starts]
    first, second = (StartPortfolio((end.values,), Coverage(0, 0, 0.0)) for end in ends)
    solution = solve(
        problem,
        Symmetry.OFF,
        known=Precomputed(
            postures={
                Case(person="", payload="", task=each): portfolio
                for each, portfolio in ((task, first), (other, second))
            }
        ),
    )
    names = ["whole: start 1", "whole: start 1, person 1", "whole: start 1, person 2"]
    assert [attempt.name for attempt in solution.attempts] == names
    assert solution.attempt is not None
    assert solution.attempt.cost == cost(solution)


def test_people_who_stand_most_differently_stand_for_all(problem: DesignProblem) -> None:
    setting = Setting(problem.scene, problem.space, problem.weights, problem.options)
    half_program, program = (
        PostureProblem(setting, symmetry).landscape(Hold(height_m=1.0)).seeker.program
        for symmetry in (Symmetry.ON, Symmetry.OFF)
    )
    half_start, start = (
        {variable.name: variable.start for variable in each.variables} for each in (half_program, program)
    )
    turns = [0.05 * number for number in range(24)]
    starts = [{**start, "human.joints": start["human.joints"] + turn} for turn in turns]
    found = different_people(program, [half_start, *starts, {"robot.joints": start["robot.joints"]}], [HUMAN])
    assert len(found) == BUDGET.people == 16
    assert [person["human.joints"][0] for person in found[:2]] == [turns[0], turns[-1]]
    assert abs(found[2]["human.joints"][0] - 0.55) < 0.1
    assert not any(name.startswith("robot") for person in found for name in person)


def test_half_holds_the_left_and_the_middle(problem: DesignProblem) -> None:
    forms = symmetric_forms(problem.scene)
    assert len(forms[0].joints) == 12
    assert sum(forms[0].counts) + 2 == len(problem.scene.robot.joints), "all but torso roll and yaw"
    part, doubled = forms[0].part(problem.scene.robot.tree)
    assert "r_knee" not in part.joint_by_name
    assert doubled == {"l_hip_pitch", "l_shoulder_pitch"}
    assert not any("Right" in name for name in forms[1].joints)


def test_payload_off_the_middle_is_refused(problem: DesignProblem) -> None:
    scene = replace(problem.scene, payload=Payload((0.5, 0.5, 0.025), 5.0, (0.0, 0.1, 0.0)))
    with pytest.raises(ModelError, match=r"center_of_mass_m: wanted y = 0 .*, found y = 0.1 m"):
        PostureProblem(Setting(scene, problem.space, problem.weights, problem.options), Symmetry.ON)


def test_pair_of_links_that_differ_is_named(problem: DesignProblem) -> None:
    tree = problem.scene.robot.tree
    heavier = tuple(
        replace(link, solids=(replace(link.solids[0], density=3000.0),))
        if link.name == "l_lower_leg"
        else link
        for link in tree.links
    )
    agent = replace(problem.scene.robot, tree=replace(tree, links=heavier))
    with pytest.raises(
        ModelError, match=r"link [lr]_lower_leg.*'[lr]_lower_leg', whose mass or shape differs"
    ):
        half(agent)


def test_parameter_of_one_side_alone_is_refused(problem: DesignProblem) -> None:
    space = DesignSpace((DesignParameter(ParameterKind.LENGTH, "arm", ("l_upper_arm",), 0.6, 1.8),))
    with pytest.raises(ModelError, match="'l_upper_arm' without 'r_upper_arm'"):
        PostureProblem(Setting(problem.scene, space, problem.weights, problem.options), Symmetry.ON)


def test_joint_without_its_partner_is_refused(problem: DesignProblem) -> None:
    human = problem.scene.human
    lame = replace(human, joints=tuple(name for name in human.joints if name != "jRightKnee_roty"))
    with pytest.raises(ModelError, match="'jLeftKnee_roty' without 'jRightKnee_roty'"):
        half(lame)
    assert lame.name == HUMAN


def test_who_stands_and_holds_nothing_has_a_half(problem: DesignProblem) -> None:
    robot = problem.scene.robot
    left = half(replace(robot, contacts=robot.feet))
    assert left.hands == ()
    assert left.feet == half(robot).feet
    assert left.joints == half(robot).joints
