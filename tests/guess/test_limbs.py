"""Which chains of bodies are taken for legs and arms, and which robots are refused."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from evodesign.body.inertia import Inertia
from evodesign.body.placement import Placement, Vector, matrix_from_rpy
from evodesign.errors import ModelError
from evodesign.guess.body_plan import body_plan
from evodesign.guess.limbs import limb_pairs
from evodesign.guess.parameters import groups, load_guess
from evodesign.problem.agent_tables import Facing
from evodesign.tree.model import Joint, JointKind, Link, Tree
from evodesign.tree.welded import WeldedTree
from tests.guess.humanoid import Build, humanoid, leg_length

AXIS = (0.0, 1.0, 0.0)


def turned(tree: Tree, rpy: Vector) -> Tree:
    """The robot with its root's frame turned."""
    turn = Placement(matrix_from_rpy(rpy))
    return replace(
        tree,
        joints=tuple(
            replace(each, parent_from_child=turn) if each.name == "turn" else each for each in tree.joints
        ),
    )


def moved(tree: Tree, name: str, by: Vector) -> Tree:
    """The robot with a joint elsewhere in its parent link."""
    shift = Placement(translation=by)
    return replace(
        tree,
        joints=tuple(
            replace(each, parent_from_child=shift @ each.parent_from_child) if each.name == name else each
            for each in tree.joints
        ),
    )


def carrying(tree: Tree, parent: str, name: str, mass: float) -> Tree:
    """The robot with another body on a joint of its own."""
    joint = Joint(f"{name}_joint", JointKind.REVOLUTE, parent, name, Placement(), AXIS, -1.0, 1.0)
    link = Link(name, own_inertia=Inertia(mass, (0.0, 0.0, -0.05)))
    return replace(tree, links=(*tree.links, link), joints=(*tree.joints, joint))


def chains(points: np.ndarray, other: np.ndarray) -> Tree:
    """Two chains on one root, their joints at points of its frame, each body with its mass at its joint."""
    links, joints = [Link("root", own_inertia=Inertia(5.0))], []
    for prefix, at in (("a", points), ("b", other)):
        parent, before = "root", np.zeros(3)
        for number, point in enumerate(at):
            name = f"{prefix}{number}"
            x, y, z = (point - before).tolist()
            links.append(Link(name, own_inertia=Inertia(1.0)))
            place = Placement(translation=(x, y, z))
            joints.append(Joint(f"{name}_joint", JointKind.REVOLUTE, parent, name, place, AXIS, -1.0, 1.0))
            parent, before = name, point
    return Tree("chains", tuple(links), tuple(joints))


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("count", [3, 6])
def test_any_chain_and_its_mirror_image_are_a_pair_also_where_both_begin_on_the_plane(
    axis: int, count: int
) -> None:
    rng = np.random.default_rng(count + axis)
    across = np.where(np.arange(3) == axis, -1.0, 1.0)
    for _ in range(20):
        points = np.cumsum(rng.uniform(-0.2, 0.2, (count, 3)), axis=0)
        points[:, axis] = np.cumsum(rng.uniform(0.1, 0.2, count)) - 0.1
        points[0, axis] = 0.0
        length = np.linalg.norm(np.diff(points, axis=0), axis=1).sum()
        (pair,) = limb_pairs(WeldedTree(chains(points, points * across)))
        assert (pair.names, pair.axis) == (("a0", "b0"), axis)
        assert pair.limbs[0].length == pytest.approx(length)
        unlike = points * across + [0.0, 0.0, 0.06 * length]
        assert [*limb_pairs(WeldedTree(chains(points, unlike)))] == []
        assert [*limb_pairs(WeldedTree(chains(points, points + 1e-4)))] == [], "two chains at one place"


@pytest.mark.parametrize("facing", Facing)
def test_arms_whose_shoulders_meet_on_the_midline_are_arms_with_their_sides(facing: Facing) -> None:
    x, y, _ = facing.ahead
    plan = body_plan(humanoid(Build(yaw=math.atan2(y, x), midline=True)))
    assert plan.facing is facing
    assert {side: arm.end.name for side, arm in plan.arms.items()} == {
        "left": "left_hand",
        "right": "right_hand",
    }
    assert [body.name for body in plan.trunk] == ["base", "chest"]
    assert load_guess(plan, -leg_length()).size[1] == pytest.approx(0.6), "1.4 times 0.46 m, at most 0.6 m"
    usual = {group.name: group.links for group in groups(body_plan(humanoid(Build())))}
    assert {group.name: group.links for group in groups(plan)} == usual


def test_arms_are_arms_though_a_joint_is_four_centimetres_off_the_mirror_image_of_the_other() -> None:
    tree = moved(humanoid(Build(midline=True)), "left_elbow", (0.04, 0.0, 0.0))
    assert body_plan(tree).arms["left"].end.name == "left_hand"
    tree = moved(humanoid(Build()), "left_elbow", (0.3, 0.0, 0.0))
    assert body_plan(tree).arms == {}


def test_an_arm_goes_on_beside_a_rod_and_a_camera_and_ends_where_fingers_divide_it() -> None:
    tree = humanoid(Build())
    for side in ("left", "right"):
        tree = carrying(tree, f"{side}_upper_arm", f"{side}_rod", 0.05)
    assert body_plan(tree).arms["left"].end.name == "left_hand"
    assert body_plan(tree).arms["left"].joints[-1] == "left_wrist"
    tree = carrying(tree, "left_forearm", "camera", 0.05)
    plan = body_plan(tree)
    assert {side: arm.end.name for side, arm in plan.arms.items()} == {
        "left": "left_hand",
        "right": "right_hand",
    }


def test_fixed_joints_in_limbs_waists_and_necks_of_two_joints_change_no_limb() -> None:
    tree = humanoid(Build())
    neck = carrying(carrying(tree, "chest", "neck", 0.5), "neck", "head", 2.0)
    fixed = Joint("mount", JointKind.FIXED, "head", "eyes", Placement())
    plan = body_plan(replace(neck, links=(*neck.links, Link("eyes")), joints=(*neck.joints, fixed)))
    assert plan.joints == body_plan(tree).joints
    welded = replace(
        tree,
        joints=tuple(
            replace(each, kind=JointKind.FIXED) if each.name.endswith("shoulder_roll") else each
            for each in tree.joints
        ),
    )
    assert body_plan(welded).arms["left"].joints == ("left_shoulder_pitch", "left_elbow", "left_wrist")


@pytest.mark.parametrize("yaw", [0.0, 1.5707963267948966])
@pytest.mark.parametrize("midline", [False, True])
def test_an_upper_body_is_refused_and_its_arms_are_not_taken_for_legs(yaw: float, midline: bool) -> None:
    with pytest.raises(
        ModelError,
        match=r"wanted two legs, .*, found none \('left_shoulder' and 'right_shoulder' are arms, "
        r"which begin above '(pelvis|base)'\)",
    ):
        body_plan(humanoid(Build(yaw, legs=False, midline=midline)))


def test_legs_without_an_upper_body_are_legs() -> None:
    plan = body_plan(humanoid(Build(arms=False)))
    assert {side: leg.end.name for side, leg in plan.legs.items()} == {
        "left": "left_foot",
        "right": "right_foot",
    }


@pytest.mark.parametrize(
    ("rpy", "words"),
    [
        ((math.pi / 2.0, 0.0, 0.0), "none .limbs are mirror images across z, which is to be up"),
        ((0.0, math.pi / 2.0, 0.0), "wanted legs that point down .* z up in the root link, found '"),
    ],
    ids=["on its side", "on its back"],
)
def test_a_robot_that_lies_is_told_where_up_is(rpy: Vector, words: str) -> None:
    with pytest.raises(ModelError, match=words):
        body_plan(turned(humanoid(Build()), rpy))


def test_a_trunk_whose_root_is_on_the_ground_begins_at_the_hips() -> None:
    tree = humanoid(Build())
    for name in ("waist", "left_hip_roll", "right_hip_roll"):
        tree = moved(tree, name, (0.0, 0.0, 0.82))
    pelvis = replace(
        tree.link_by_name["pelvis"],
        solids=(
            replace(
                tree.link_by_name["pelvis"].solids[0], link_from_solid=Placement(translation=(0, 0, 0.87))
            ),
        ),
    )
    tree = replace(tree, links=tuple(pelvis if link.name == "pelvis" else link for link in tree.links))
    (trunk,) = [group for group in groups(body_plan(tree)) if group.name == "trunk"]
    assert (trunk.links, trunk.length) == (("chest",), pytest.approx(0.36))
