"""Which bodies are checked: what the build brings together is not, all else is."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from itertools import combinations, pairwise
from pathlib import Path
from tempfile import TemporaryDirectory

import coal
import numpy as np
import pinocchio as pin
import pytest

from evodesign.body.inertia import Inertia
from evodesign.body.placement import Placement
from evodesign.body.shape import Box, Sphere
from evodesign.collision.clearance import SolidBodies
from evodesign.collision.pairs import (
    JOINED,
    STILL,
    checked_pairs,
    collision_pairs,
    exempt_pairs,
    feet_pairs,
    holding_links,
    is_joined,
)
from evodesign.problem.build import DesignProblem
from evodesign.tree.model import Joint, JointKind, Link, Look, Tree
from evodesign.tree.urdf_write import urdf_text


def test_joined_links_are_not_watched_and_others_are(problem: DesignProblem) -> None:
    agents = problem.scene.robot, problem.scene.human
    robot, person = (set(collision_pairs(agent.tree, agent.joints)) for agent in agents)
    for near in (("root_link", "torso_1"), ("root_link", "l_hip_3"), ("neck_1", "head")):
        assert near not in robot
    for far in (
        ("l_foot_front", "r_foot_front"),
        ("l_hip_3", "r_hip_3"),
        ("chest", "l_hip_2"),
        ("root_link", "chest"),
        ("torso_2", "l_shoulder_3"),
    ):
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


@pytest.mark.slow
def test_every_exemption_has_the_reason_that_is_found_by_drawing_other_postures(
    problem: DesignProblem,
) -> None:
    """By pinocchio's places and coal, with no list of the product's and other random postures."""
    agent = problem.scene.robot
    exempt = exempt_pairs(agent.tree, agent.joints)
    shares, touching = drawn_shares(agent.tree, agent.joints)
    joined = {frozenset((joint.parent, joint.child)) for joint in agent.tree.joints}
    fixed = {link.name: {link.name} for link in agent.tree.links}
    for joint in agent.tree.joints:
        if joint.kind is JointKind.FIXED:
            together = fixed[joint.parent] | fixed[joint.child]
            fixed |= dict.fromkeys(together, together)
    still = {pair for pair, reason in exempt.items() if reason == STILL}
    for pair in combinations(dict.fromkeys(SolidBodies.of_tree(agent.tree).names), 2):
        if frozenset(pair) in joined:
            assert exempt[pair] == JOINED
        elif exempt.get(pair) == JOINED:
            assert any(
                frozenset((one, other)) in joined for one in fixed[pair[0]] for other in fixed[pair[1]]
            )
        elif pair in still:
            assert shares.get(pair, 0.0) in (0.0, 1.0)
        elif pair in exempt:
            assert shares[pair] > 0.5 or (pair in touching and shares[pair] > 0.05)
        else:
            assert shares.get(pair, 0.0) < 0.6
            assert pair not in touching or shares.get(pair, 0.0) < 0.15
    assert len(still) < len(exempt)


def drawn_shares(
    tree: Tree, joints: Sequence[str]
) -> tuple[dict[tuple[str, str], float], set[tuple[str, str]]]:
    """In what share of 300 postures links overlap, and which do while all joints are at zero."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "robot.urdf"
        path.write_text(urdf_text(tree))
        model = pin.buildModelFromUrdf(str(path))
        geometry = pin.buildGeomFromUrdf(model, str(path), pin.GeometryType.VISUAL)
    data, places = model.createData(), geometry.createData()
    links = [model.frames[each.parentFrame].name for each in geometry.geometryObjects]
    rng, counts, zero = np.random.default_rng(7), Counter[tuple[str, str]](), set[tuple[str, str]]()
    for sample in range(301):
        q = pin.neutral(model)
        for name in joints if sample else ():
            joint = model.joints[model.getJointId(name)]
            at = slice(joint.idx_q, joint.idx_q + 1)
            q[at] = rng.uniform(model.lowerPositionLimit[at], model.upperPositionLimit[at])
        pin.updateGeometryPlacements(model, data, geometry, places, q)
        found = set()
        for i, j in combinations(range(len(links)), 2):
            request, result = coal.DistanceRequest(), coal.DistanceResult()
            one, other = (
                (
                    geometry.geometryObjects[k].geometry,
                    coal.Transform3s(places.oMg[k].rotation, places.oMg[k].translation),
                )
                for k in (i, j)
            )
            if links[i] != links[j] and coal.distance(*one, *other, request, result) < (
                0.0 if sample else 1e-6
            ):
                found.add((links[i], links[j]))
        if sample:
            counts.update(found)
        else:
            zero = found
    order = {name: place for place, name in enumerate(dict.fromkeys(SolidBodies.of_tree(tree).names))}

    def named(pair: tuple[str, str]) -> tuple[str, str]:
        one, other = sorted(pair, key=order.__getitem__)
        return one, other

    return {named(pair): count / 300 for pair, count in counts.items()}, {named(pair) for pair in zero}


def test_each_part_of_a_foot_is_kept_from_that_of_the_other(problem: DesignProblem) -> None:
    feet = {
        agent.name: feet_pairs(
            agent.tree,
            agent.joints,
            agent.foot_frames,
            checked_pairs(agent.tree, agent.joints, agent.hand_frames, agent.foot_frames),
        )
        for agent in problem.scene.agents
    }
    assert {("l_foot_front", "r_foot_front"), ("l_foot_rear", "r_foot_rear")} <= set(feet["robot"])
    assert set(feet["human"]) == {("LeftFoot", "RightFoot"), ("LeftToe", "RightToe")}
    assert all(one.lower().lstrip("lr") != other for pairs in feet.values() for one, other in pairs)
    agent = problem.scene.human
    assert feet_pairs(agent.tree, agent.joints, agent.foot_frames, [("LeftToe", "RightToe")]) == (
        ("LeftToe", "RightToe"),
    )
    assert feet_pairs(agent.tree, agent.joints, agent.foot_frames, ()) == ()


def test_hands_hold_and_forearms_do_not(problem: DesignProblem) -> None:
    robot, person = problem.scene.robot, problem.scene.human
    holding = holding_links(robot.tree, robot.joints, robot.hand_frames)
    assert {"l_hand", "r_hand", "l_wrist_1"} <= holding
    assert not holding & {"l_forearm", "chest"}
    assert "LeftHand" in holding_links(person.tree, person.joints, person.hand_frames)
    assert "LeftForeArm" not in holding_links(person.tree, person.joints, person.hand_frames)


def test_a_forearm_without_a_wrist_holds_with_the_palm_at_its_far_end() -> None:
    links = [Link(n, own_inertia=Inertia(1.0)) for n in ("root", "upper", "forearm", "stump", "palm")]
    joints = tuple(
        Joint(each.name, kind, parent.name, each.name, Placement(translation=(0.0, 0.0, -0.25)))
        for kind, (parent, each) in zip(
            [JointKind.REVOLUTE] * 2 + [JointKind.FIXED] * 2, pairwise(links), strict=True
        )
    )
    tree = Tree("arm", tuple(links), joints)
    assert holding_links(tree, ["upper", "forearm"], ["palm"]) == {"palm", "stump", "forearm"}


def test_axes_with_nothing_between_them_are_one_joint_and_with_a_link_between_two() -> None:
    """A waist of two hinges, as of one body of an MJCF; both balls of 0.05 m are 1 mm apart."""
    ball = (Look(Sphere(0.05), Placement()),)
    trunk, hips = (Link(name, own_inertia=Inertia(1.0), looks=ball) for name in ("trunk", "hips"))
    for between, joined in ((Link("between"), True), (Link("between", own_inertia=Inertia(0.1)), False)):
        joints = (
            Joint("yaw", JointKind.REVOLUTE, "trunk", "between", Placement(), (0.0, 0.0, 1.0)),
            Joint("roll", JointKind.REVOLUTE, "between", "hips", Placement(translation=(0.0, 0.0, -0.101))),
        )
        tree = Tree("waist", (trunk, between, hips), joints)
        assert is_joined(tree, ("trunk", "hips")) is joined


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
    assert holding_links(tree, ["hand"], ["hand"]) == {"hand", *names[2:]}
    assert not [pair for pair in collision_pairs(tree, ["hand"]) if "arm" not in pair]
    exempt = exempt_pairs(tree, tree.actuated)
    assert "postures" in exempt["left c", "right c"]
    assert ("arm", "left c") not in exempt
