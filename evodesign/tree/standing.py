"""How tall a tree stands: from a frame under it to the top of its highest shape, all joints at zero.

With R the rotation of a shape against the root, a shape of radius r, length l or sides a, b, c reaches above
its centre by

    sphere: r    box: (|R_zx| a + |R_zy| b + |R_zz| c) / 2    cylinder: |R_zz| l / 2 + r sqrt(1 - R_zz^2)
"""

from __future__ import annotations

import math

from evodesign.body.placement import Placement
from evodesign.body.shape import Box, Cylinder, Shape
from evodesign.tree.frames import link_frames
from evodesign.tree.model import Tree

__all__ = ["standing_height"]


def standing_height(tree: Tree, sole: str) -> float | None:
    """Height [m] of the top of a tree's shapes above a frame; None for a tree without shapes.

    Args:
        tree: of numbers, its root's z upwards.
        sole: name of the frame on the ground.
    """
    frames = link_frames(tree, Placement(), {})
    tops = [
        _top(shape, frames[link.name] @ place)
        for link in tree.links
        for shape, place in (
            *((look.shape, look.link_from_look) for look in link.looks),
            *((solid.shape, solid.link_from_solid) for solid in link.solids),
        )
    ]
    return max(tops) - frames[sole].translation[2] if tops else None


def _top(shape: Shape, root_from_shape: Placement) -> float:
    return float(root_from_shape.translation[2]) + _above_center(shape, root_from_shape)


def _above_center(shape: Shape, place: Placement) -> float:
    upward = place.rotation[2]
    if isinstance(shape, Box):
        return float(sum(abs(part) * side for part, side in zip(upward, shape.sides, strict=True))) / 2.0
    if isinstance(shape, Cylinder):
        across = math.sqrt(max(0.0, 1.0 - upward[2] ** 2))
        return float(abs(upward[2]) * shape.length / 2.0 + across * shape.radius)
    return float(shape.radius)
