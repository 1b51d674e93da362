"""Which bodies are checked: what the build brings together is not, all else is."""

from __future__ import annotations

from itertools import pairwise

from evodesign.body.inertia import Inertia
from evodesign.body.placement import Placement
from evodesign.body.shape import Box, Sphere
from evodesign.collision.pairs import checked_pairs, collision_pairs, feet_pairs, holding_links
from evodesign.problem.build import DesignProblem
from evodesign.tree.model import Joint, JointKind, Link, Look, Tree


def test_joined_links_are_not_watched_and_others_are(problem: DesignProblem) -> None:
    agents = problem.scene.robot, problem.scene.human
    robot, person = (set(collision_pairs(agent.tree, agent.joints)) for agent in agents)
    for near in (("root_link", "torso_1"), ("root_link", "l_hip_3"), ("chest", "head")):
        assert near not in robot
    for far in (("l_foot_front", "r_foot_front"), ("l_hip_3", "r_hip_3"), ("chest", "l_hip_2")):
        assert far in robot
    assert ("Pelvis", "LeftUpperLeg") not in person
    assert {("T8", "LeftUpperLeg"), ("Head", "LeftForeArm"), ("L5", "LeftForeArm")} <= person


def test_a_pair_that_always_overlaps_is_not_collision_pairs() -> None:
    """A chain of small links that ends inside its first one, whatever the joints do."""
    names = ["shell", *(f"ball {number}" for number in range(5))]
    shell = Link("shell", own_inertia=Inertia(1.0), looks=(Look(Box(2.0, 2.0, 2.0), Placement()),))
    balls = [Link(n, own_inertia=Inertia(1.0), looks=(Look(Sphere(0.02), Placement()),)) for n in names[1:]]
    joints = [
        Joint(
            f"{b} joint",
            JointKind.REVOLUTE,
            a,
            b,
            Placement(translation=(0.1, 0.0, 0.0)),
            (0.0, 0.0, 1.0),
            -1.0,
            1.0,
        )
        for a, b in pairwise(names)
    ]
    tree = Tree("chain", (shell, *balls), tuple(joints))
    checked = collision_pairs(tree, tree.actuated)
    assert not [pair for pair in checked if "shell" in pair]
    assert ("ball 0", "ball 4") in checked


def test_each_part_of_a_foot_is_kept_from_that_of_the_other(problem: DesignProblem) -> None:
    feet = {
        agent.name: feet_pairs(
            agent.tree,
            agent.joints,
            agent.soles,
            checked_pairs(agent.tree, agent.joints, agent.hands, agent.soles),
        )
        for agent in (problem.scene.robot, problem.scene.human)
    }
    assert {("l_foot_front", "r_foot_front"), ("l_foot_rear", "r_foot_rear")} <= set(feet["robot"])
    assert set(feet["human"]) == {("LeftFoot", "RightFoot"), ("LeftToe", "RightToe")}
    assert all(one.lower().lstrip("lr") != other for pairs in feet.values() for one, other in pairs)
    agent = problem.scene.human
    assert feet_pairs(agent.tree, agent.joints, agent.soles, [("LeftToe", "RightToe")]) == (
        ("LeftToe", "RightToe"),
    )
    assert feet_pairs(agent.tree, agent.joints, agent.soles, ()) == ()


def test_hands_hold_and_forearms_do_not(problem: DesignProblem) -> None:
    robot, person = problem.scene.robot, problem.scene.human
    holding = holding_links(robot.tree, robot.joints, robot.hands)
    assert {"l_hand", "r_hand", "l_wrist_1"} <= holding
    assert not holding & {"l_forearm", "chest"}
    assert "LeftHand" in holding_links(person.tree, person.joints, person.hands)
    assert "LeftForeArm" not in holding_links(person.tree, person.joints, person.hands)


def test_fingers_that_stand_still_are_part_of_the_hand() -> None:
    """A gripper of two fingers that reach farther than a hand's length and lie in each other."""
    names = ["arm", "hand", *(f"{side} {part}" for side in ("left", "right") for part in "abc")]
    links = [Link(n, own_inertia=Inertia(1.0), looks=(Look(Sphere(0.05), Placement()),)) for n in names]
    parents = {"hand": "arm", "left a": "hand", "right a": "hand"}
    parents |= {f"{side} {b}": f"{side} {a}" for side in ("left", "right") for a, b in pairwise("abc")}
    joints = tuple(
        Joint(
            each,
            JointKind.REVOLUTE,
            parent,
            each,
            Placement(translation=(0.0, 0.0, -0.16)),
            (0.0, 1.0, 0.0),
            -1.0,
            1.0,
        )
        for each, parent in parents.items()
    )
    tree = Tree("gripper", tuple(links), joints)
    assert holding_links(tree, ["hand"], {"left": "hand"}) == {"hand", *names[2:]}
    assert not [pair for pair in collision_pairs(tree, ["hand"]) if "arm" not in pair]
    assert ("left c", "right c") in collision_pairs(tree, tree.actuated)
