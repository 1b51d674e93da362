"""Joints that designs move, tilt or give other limits, beside pinocchio and mirror images by hand."""

from __future__ import annotations

import math

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest

from evodesign.errors import ModelError
from evodesign.mechanics.floating_base import FloatingBody
from evodesign.problem.build import DesignProblem
from evodesign.tree.joint_changes import JointQuantity, pair_of_changes, unchanged_value, with_changes
from evodesign.tree.kinematics import Pose, forward
from evodesign.tree.model import Tree
from evodesign.tree.urdf_write import urdf_text

HIPS = ("l_hip_pitch", "r_hip_pitch")
MIRROR = np.diag([1.0, -1.0, 1.0])


@pytest.fixture(scope="module")
def tree(problem: DesignProblem) -> Tree:
    return problem.scene.robot.tree


def placed(tree: Tree, positions: dict[str, float] | None = None) -> dict[str, pin.SE3]:
    """Links in the root's frame, by pinocchio from the written file."""
    model = pin.buildModelFromXML(urdf_text(tree))
    q = pin.neutral(model)
    for name, at in (positions or {}).items():
        q[model.joints[model.getJointId(name)].idx_q] = at
    data = model.createData()
    pin.framesForwardKinematics(model, data, q)
    return {link.name: data.oMf[model.getFrameId(link.name)] for link in tree.links}


def beyond(tree: Tree, joint: str) -> set[str]:
    """Links that hang on a joint."""
    found = {tree.joint_by_name[joint].child}
    for each in tree.joints:
        if each.parent in found:
            found.add(each.child)
    return found


def test_nothing_changed_is_the_same_tree(tree: Tree) -> None:
    for quantity, axis in ((JointQuantity.OFFSET, (0.0, 1.0, 0.0)), (JointQuantity.TILT, (0.0, 0.0, 1.0))):
        changes = pair_of_changes(tree, HIPS, quantity, axis)
        assert [unchanged_value(tree, change) for change in changes] == [0.0, 0.0]
        same = with_changes(tree, [(change, 0.0) for change in changes])
        assert all(new is old for new, old in zip(same.links, tree.links, strict=True))
        assert all(new is old for new, old in zip(same.joints, tree.joints, strict=True))
    for quantity in (JointQuantity.LOWER, JointQuantity.UPPER):
        changes = pair_of_changes(tree, HIPS, quantity)
        value = unchanged_value(tree, changes[0])
        assert with_changes(tree, [(change, value) for change in changes]).joints == tree.joints


def test_an_offset_moves_both_hips_and_legs_apart_and_nothing_else(tree: Tree) -> None:
    """Along y of the root, whose mirror image is along -y."""
    changes = pair_of_changes(tree, HIPS, JointQuantity.OFFSET, (0.0, 2.0, 0.0))
    moved = with_changes(tree, [(change, 0.03) for change in changes])
    before, after = placed(tree), placed(moved)
    left, right = (beyond(tree, name) for name in HIPS)
    parent = placed(tree)[tree.joint_by_name[HIPS[0]].parent].rotation
    along = parent @ [0.0, 1.0, 0.0]
    for link in tree.link_by_name:
        shift = after[link].translation - before[link].translation
        expected = 0.03 * along if link in left else 0.03 * MIRROR @ along if link in right else np.zeros(3)
        assert shift == pytest.approx(expected, abs=1e-12), link
        assert after[link].rotation == pytest.approx(before[link].rotation, abs=1e-12)


def test_a_box_that_ends_at_the_joint_gets_as_much_longer_and_heavier(tree: Tree) -> None:
    joint = tree.joint_by_name["l_elbow"]
    parent = tree.link_by_name[joint.parent]
    frames = placed(tree)
    towards = frames[joint.child].translation - frames[joint.parent].translation
    own = frames[joint.parent].rotation.T @ towards
    changes = pair_of_changes(tree, ("l_elbow",), JointQuantity.OFFSET, tuple(own))
    assert [len(change.solids) for change in changes] == [len(changes[0].solids)]
    longer = with_changes(tree, [(changes[0], 0.02)]).link_by_name[parent.name]
    if changes[0].solids:
        (number, away) = changes[0].solids[0]
        before, after = parent.solids[number], longer.solids[number]
        assert away == 1.0
        grown = float(after.shape.volume / before.shape.volume) - 1.0
        axis = before.shape.principal_axis(tuple(own))
        assert grown == pytest.approx(0.02 / float(before.shape.principal_dimension(axis)), rel=0.1)
        assert float(longer.mass) > float(parent.mass)
    else:
        assert longer == parent


def test_a_box_that_ends_at_both_joints_of_a_pair_gets_longer_once(tree: Tree) -> None:
    """Shoulders that move up raise the chest's top as much; its mass grows by that share of its height."""
    shoulders = ("l_shoulder_pitch", "r_shoulder_pitch")
    changes = pair_of_changes(tree, shoulders, JointQuantity.OFFSET, (0.0, 0.0, 1.0))
    parent = tree.joint_by_name[shoulders[0]].parent
    for rise in (0.03, -0.02):
        moved = with_changes(tree, [(change, rise) for change in changes])
        (before,), (after,) = (each.link_by_name[parent].solids for each in (tree, moved))
        height = before.shape.sides[2]
        assert after.shape.sides == pytest.approx((*before.shape.sides[:2], height + rise))
        assert after.link_from_solid.translation[2] - before.link_from_solid.translation[2] == pytest.approx(
            rise / 2
        )
        assert moved.link_by_name[parent].mass / tree.link_by_name[parent].mass == pytest.approx(
            1 + rise / height
        )
        for joint in shoulders:
            there = moved.joint_by_name[joint].parent_from_child.translation
            assert there[2] - tree.joint_by_name[joint].parent_from_child.translation[2] == pytest.approx(
                rise
            )


def test_a_tilt_turns_the_axis_and_leaves_the_zero_posture(tree: Tree) -> None:
    angle = math.radians(15.0)
    changes = pair_of_changes(tree, HIPS, JointQuantity.TILT, (0.0, 0.0, 1.0))
    tilted = with_changes(tree, [(change, angle) for change in changes])
    before, after = placed(tree), placed(tilted)
    for link in tree.link_by_name:
        assert after[link].homogeneous == pytest.approx(before[link].homogeneous, abs=1e-12)
    axes = []
    for name in HIPS:
        old, new = np.array(tree.joint_by_name[name].axis), np.array(tilted.joint_by_name[name].axis)
        assert np.linalg.norm(new) == pytest.approx(1.0)
        assert math.acos(float(np.clip(old @ new, -1.0, 1.0))) == pytest.approx(angle)
        axes.append(before[tree.joint_by_name[name].child].rotation @ new)
    image = -MIRROR @ axes[0]
    assert min(np.abs(image - axes[1]).max(), np.abs(image + axes[1]).max()) < 1e-12, "mirror images still"


@pytest.mark.parametrize("quantity", [JointQuantity.OFFSET, JointQuantity.TILT])
def test_pinocchio_our_kinematics_and_a_changed_body_agree(tree: Tree, quantity: JointQuantity) -> None:
    axis = (0.3, 1.0, 0.2) if quantity is JointQuantity.OFFSET else (0.2, 0.1, 1.0)
    changes = pair_of_changes(tree, HIPS, quantity, axis)
    symbol, value = ca.SX.sym("value"), 0.04 if quantity is JointQuantity.OFFSET else 0.3
    with_symbol = with_changes(tree, [(change, symbol) for change in changes])
    changed = with_changes(tree, [(change, value) for change in changes])
    positions = {"l_hip_pitch": 0.4, "r_hip_pitch": -0.3, "l_knee": -0.8, "torso_pitch": 0.2}
    frames = placed(changed, positions)
    poses = forward(with_symbol, Pose(ca.DM.eye(3), ca.DM.zeros(3)), positions)
    for name in ("l_sole", "r_sole", "l_hand_frame"):
        at = ca.Function("at", [symbol], [ca.SX(poses[name].position), ca.SX(poses[name].rotation)])(value)
        assert np.array(at[0]).ravel() == pytest.approx(frames[name].translation, abs=1e-12)
        assert np.array(at[1]) == pytest.approx(frames[name].rotation, abs=1e-12)
    made, anew = (
        body.model
        for body in (
            FloatingBody.of_tree(tree, tuple(positions), np.eye(3)).resized(changed),
            FloatingBody.of_tree(changed, tuple(positions), np.eye(3)),
        )
    )
    q, rng = pin.neutral(made), np.random.default_rng(2)
    q[7:] = rng.uniform(-0.5, 0.5, made.nq - 7)
    first, second = made.createData(), anew.createData()
    assert pin.crba(made, first, q) == pytest.approx(pin.crba(anew, second, q), abs=1e-12)
    assert pin.computeGeneralizedGravity(made, first, q) == pytest.approx(
        pin.computeGeneralizedGravity(anew, second, q), abs=1e-10
    )


def test_limits_of_a_pair_turn_with_its_axes(tree: Tree) -> None:
    """The mirror image turns as far the same way: whichever sign its own axis gives that."""
    for pair in (HIPS, ("l_hip_roll", "r_hip_roll"), ("l_elbow", "r_elbow"), ("l_hip_yaw", "r_hip_yaw")):
        left, right = (tree.joint_by_name[name] for name in pair)
        changes = pair_of_changes(tree, pair, JointQuantity.UPPER)
        given = left.upper - 0.1
        changed = with_changes(tree, [(change, given) for change in changes])
        assert changed.joint_by_name[pair[0]].upper == given
        other = changed.joint_by_name[pair[1]]
        if (right.lower, right.upper) == pytest.approx((left.lower, left.upper)):
            assert (other.lower, other.upper) == (right.lower, given)
        else:
            assert (other.lower, other.upper) == (-given, right.upper)


@pytest.mark.parametrize(
    ("quantity", "axis", "found"),
    [
        (JointQuantity.OFFSET, (0.0, 0.0, 0.0), "none"),
        (JointQuantity.TILT, None, "one along it"),
    ],
)
def test_axes_that_say_nothing_are_refused(
    tree: Tree, quantity: JointQuantity, axis: tuple[float, float, float] | None, found: str
) -> None:
    with pytest.raises(ModelError) as error:
        pair_of_changes(tree, HIPS, quantity, axis or tree.joint_by_name[HIPS[0]].axis)
    assert error.value.found == found
