"""Where a tree's links stand, in plain numbers: what drawing and exporting a posture need, without CasADi.

    world_from_child = world_from_parent @ parent_from_child @ motion(axis, position)

`tree.kinematics` says the same over expressions; tests hold the two against each other.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

from evodesign.body.placement import Matrix, Placement, Vector, scale
from evodesign.tree.model import Joint, JointKind, Tree

__all__ = ["link_frames", "parent_from_child"]


def link_frames(
    tree: Tree, world_from_root: Placement, positions: Mapping[str, float]
) -> dict[str, Placement]:
    """The place of every link, `world_from_link` by link name.

    Args:
        tree: of numbers.
        world_from_root: of the root link.
        positions: joint positions [rad or m] by name; joints left out stand at zero.
    """
    frames = {tree.root: world_from_root}
    for joint in tree.joints:
        moved = parent_from_child(joint, positions.get(joint.name, 0.0))
        frames[joint.child] = frames[joint.parent] @ moved
    return frames


def parent_from_child(joint: Joint, position: float) -> Placement:
    """The place of a joint's child in its parent at a position [rad or m]."""
    if joint.kind is JointKind.FIXED:
        return joint.parent_from_child
    if joint.kind is JointKind.PRISMATIC:
        return joint.parent_from_child @ Placement(translation=scale(position, joint.axis))
    return joint.parent_from_child @ Placement(rotation=_turn(joint.axis, position))


def _turn(axis: Vector, angle: float) -> Matrix:
    """Rotation by an angle about a unit vector a: cos 1 + sin [a]x + (1 - cos) a a^T."""
    x, y, z = axis
    c, s, d = math.cos(angle), math.sin(angle), 1.0 - math.cos(angle)
    return (
        (c + d * x * x, d * x * y - s * z, d * x * z + s * y),
        (d * y * x + s * z, c + d * y * y, d * y * z - s * x),
        (d * z * x - s * y, d * z * y + s * x, c + d * z * z),
    )
