"""Forward kinematics of a tree, written once over CasADi (numbers as DM, expressions as SX).

    world_from_child = world_from_parent  parent_from_child  motion(axis, position)

with motion a rotation about the axis (revolute, continuous) or a translation along it (prismatic).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import casadi as ca

from evodesign.body.placement import Vector
from evodesign.tree.model import Joint, JointKind, Tree

Expression = Any
"""A casadi.SX or casadi.DM."""


@dataclass(frozen=True, slots=True)
class Pose:
    """Pose of a frame in the world.

    Args:
        rotation: 3 x 3, world_from_frame.
        position: 3, origin of the frame in the world [m].
    """

    rotation: Expression
    position: Expression

    def point(self, in_frame: Expression) -> Expression:
        """World coordinates [m] of a point given in the frame."""
        return self.rotation @ in_frame + self.position


def vector(triple: Vector) -> Expression:
    """Column of three numbers or expressions."""
    return ca.vertcat(*triple)


def axis_rotation(axis: Vector, angle: Expression) -> Expression:
    """Rotation by an angle [rad] about a unit vector (Rodrigues): 1 + sin K + (1 - cos) K^2."""
    cross = ca.skew(vector(axis))
    return ca.DM.eye(3) + ca.sin(angle) * cross + (1.0 - ca.cos(angle)) * (cross @ cross)


def euler_rotation(angles: Expression) -> Expression:
    """Rotation Rz(yaw) Ry(pitch) Rx(roll) of the column (roll, pitch, yaw) [rad]."""
    axes: tuple[Vector, ...] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    roll, pitch, yaw = (axis_rotation(axis, angles[i]) for i, axis in enumerate(axes))
    return yaw @ pitch @ roll


def forward(tree: Tree, base: Pose, positions: Mapping[str, Expression]) -> dict[str, Pose]:
    """Poses of all links.

    Args:
        tree: numbers or expressions.
        base: pose of the root link in the world.
        positions: joint positions [rad or m] by name; joints left out stand at zero.
    Returns:
        Pose by link name.
    """
    poses = {tree.root: base}
    for joint in tree.joints:
        poses[joint.child] = _child_pose(poses[joint.parent], joint, positions.get(joint.name, 0.0))
    return poses


def pose_from(tree: Tree, above: str, link: str, positions: Mapping[str, Expression]) -> Pose:
    """Pose of a link in the frame of one that carries it: it moves with the joints between them alone.

    Args:
        tree: numbers or expressions.
        above: the carrying link, or the link itself.
        link: its name.
        positions: joint positions [rad or m] by name; joints left out stand at zero.
    """
    pose = Pose(ca.DM.eye(3), ca.DM.zeros(3))
    chain = tree.to_root(link)
    for name in reversed(chain[: chain.index(above)]):
        joint = tree.parent_joint[name]
        pose = _child_pose(pose, joint, positions.get(joint.name, 0.0))
    return pose


def _child_pose(parent: Pose, joint: Joint, position: Expression) -> Pose:
    origin = joint.parent_from_child
    at_rest = parent.rotation @ ca.DM([*map(list, origin.rotation)])
    start = parent.point(vector(origin.translation))
    if joint.kind is JointKind.FIXED:
        return Pose(at_rest, start)
    if joint.kind is JointKind.PRISMATIC:
        return Pose(at_rest, start + at_rest @ (vector(joint.axis) * position))
    return Pose(at_rest @ axis_rotation(joint.axis, position), start)
