"""The elbow is found by geometry on robots and people whose joints bear any name."""

from __future__ import annotations

import tomllib
from dataclasses import replace

import numpy as np
import pytest

from evodesign.body.placement import Placement
from evodesign.guess.problem_text import guessed_problem
from evodesign.mechanics.agent import SIDES, Agent, Contact
from evodesign.mechanics.elbow import elbow
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.source import source_of
from evodesign.tree.frames import link_frames
from evodesign.tree.urdf_read import InertiaRule, read_urdf
from tests.robots import HUMANOIDS

ELBOWS = {
    "talos": "arm_left_4_joint",
    "romeo": "LElbowYaw",
    "g1": "left_elbow_joint",
    "icub_reduced": "l_elbow",
    "icub": "l_elbow",
}


def hand_of(agent: Agent, side: str) -> Contact:
    return next(hand for hand in agent.hands if hand.side == side)


def point(agent: Agent, side: str) -> np.ndarray:
    """The elbow with all joints at zero, in the root's frame."""
    found = elbow(agent, hand_of(agent, side))
    assert found is not None
    return np.array(link_frames(agent.tree, Placement(), {})[found.link].apply(found.place))


def test_elbows_of_the_default_problem_are_mirror_images_at_both_ends_of_upper_arm_and_forearm(
    problem: DesignProblem,
) -> None:
    for agent, joints in (
        (problem.scene.robot, ("l_elbow", "r_elbow")),
        (problem.scene.human, ("jLeftElbow_rotz", "jRightElbow_rotz")),
    ):
        found = [elbow(agent, hand) for hand in agent.hands]
        assert tuple(each.joint for each in found if each) == joints
        left, right = (point(agent, side) for side in SIDES)
        assert left == pytest.approx(right * [1.0, -1.0, 1.0], abs=1e-12)
    human = problem.scene.human
    frames = link_frames(human.tree, Placement(), {})
    forearm = np.array(frames["LeftHand"].translation) - point(human, "left")
    assert np.linalg.norm(forearm) == pytest.approx(0.146 * 1.82)


def test_a_joints_origin_may_lie_anywhere_on_its_axis(problem: DesignProblem) -> None:
    robot = problem.scene.robot
    moved = []
    for joint in robot.tree.joints:
        along = Placement(translation=tuple(0.05 * part for part in joint.axis))
        place = joint.parent_from_child
        if joint.name == "l_elbow":
            place = place @ along
        elif joint.parent == robot.tree.joint_by_name["l_elbow"].child:
            back = robot.tree.joint_by_name["l_elbow"].axis
            place = Placement(translation=tuple(-0.05 * part for part in back)) @ place
        moved.append(replace(joint, parent_from_child=place))
    other = replace(robot, tree=replace(robot.tree, joints=tuple(moved)))
    assert point(other, "left") == pytest.approx(point(robot, "left"), abs=1e-12)


def test_an_arm_that_does_not_move_has_no_elbow(problem: DesignProblem) -> None:
    robot = problem.scene.robot
    legs = tuple(name for name in robot.joints if "elbow" not in name and "shoulder" not in name)
    assert elbow(replace(robot, joints=legs), robot.hands[0]) is not None, "the wrist bends it"
    stiff = tuple(name for name in legs if "wrist" not in name)
    assert elbow(replace(robot, joints=stiff), robot.hands[0]) is None


@pytest.mark.slow
@pytest.mark.needs_robots
@pytest.mark.parametrize("name", HUMANOIDS)
def test_public_humanoids_have_the_elbows_that_their_makers_name(name: str) -> None:
    tree = read_urdf(HUMANOIDS[name].read_text(encoding="utf-8"), name, InertiaRule.FILE)
    tables = tomllib.loads(guessed_problem(tree, str(HUMANOIDS[name])).text)
    tables["robot"]["meshes"] = False
    robot = build_problem(source_of(tables)).scene.robot
    found = [elbow(robot, hand) for hand in robot.hands]
    assert [each.joint for each in found if each] == [ELBOWS[name], right_of(ELBOWS[name])]
    left, right = (point(robot, side) for side in SIDES)
    assert left == pytest.approx(right * [1.0, -1.0, 1.0], abs=1e-3)


def right_of(joint: str) -> str:
    """The name of the joint on the other side."""
    pairs = (("left", "right"), ("l_", "r_"), ("LE", "RE"))
    return next(joint.replace(one, other) for one, other in pairs if one in joint)
