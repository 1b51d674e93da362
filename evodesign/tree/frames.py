"""Where a tree's links stand, in plain numbers: what drawing and exporting a posture need, without CasADi.

    world_from_child = world_from_parent @ parent_from_child @ motion(axis, position)

`tree.kinematics` says the same over expressions; tests hold the two against each other.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from evodesign.body.placement import Matrix, Placement, Vector, scale
from evodesign.tree.model import Joint, JointKind, Tree

Array = NDArray[np.float64]


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


def link_poses(tree: Tree, positions: Mapping[str, Array]) -> dict[str, tuple[Array, Array]]:
    """The place of every link in the root's frame, in n postures at once, by link name.

    Args:
        tree: of numbers.
        positions: joint positions [rad or m] by name, shape (n,) each; joints left out stand at zero.
    Returns:
        Rotations root_from_link, shape (n, 3, 3), and origins [m], shape (n, 3).
    """
    count = max((len(each) for each in positions.values()), default=1)
    poses = {tree.root: (np.tile(np.eye(3), (count, 1, 1)), np.zeros((count, 3)))}
    for joint in tree.joints:
        turns, origins = poses[joint.parent]
        place, axis = joint.parent_from_child, np.array(joint.axis, float)
        origins = origins + turns @ np.array(place.translation, float)
        turns = turns @ np.array(place.rotation, float)
        moved = positions.get(joint.name)
        if moved is not None and joint.kind is JointKind.PRISMATIC:
            origins = origins + moved[:, None] * (turns @ axis)
        elif moved is not None and joint.kind is not JointKind.FIXED:
            turns = turns @ _turns(joint.axis, moved)
        poses[joint.child] = turns, origins
    return poses


def parent_from_child(joint: Joint, position: float) -> Placement:
    """The place of a joint's child in its parent at a position [rad or m]."""
    if joint.kind is JointKind.FIXED:
        return joint.parent_from_child
    if joint.kind is JointKind.PRISMATIC:
        return joint.parent_from_child @ Placement(translation=scale(position, joint.axis))
    return joint.parent_from_child @ Placement(rotation=_turn(joint.axis, position))


def _turns(axis: Vector, angles: Array) -> Array:
    """Rotations by angles about a unit vector, shape (n, 3, 3)."""
    across = np.cross(np.eye(3), np.array(axis, float))
    turns = np.sin(angles)[:, None, None] * across + (1.0 - np.cos(angles))[:, None, None] * (across @ across)
    return np.asarray(np.eye(3) + turns)


def _turn(axis: Vector, angle: float) -> Matrix:
    """Rotation by an angle about a unit vector a: cos 1 + sin [a]x + (1 - cos) a a^T."""
    x, y, z = axis
    c, s, d = math.cos(angle), math.sin(angle), 1.0 - math.cos(angle)
    return (
        (c + d * x * x, d * x * y - s * z, d * x * z + s * y),
        (d * y * x + s * z, c + d * y * y, d * y * z - s * x),
        (d * z * x - s * y, d * z * y + s * x, c + d * z * z),
    )
