"""Outlines of the parts of a robot in the views of a drawing.

Spheres, cylinders and boxes are convex, so the outline of each is the convex hull of points on its surface,
seen along the view's direction. Of a mesh it is the hull of its vertices; a flat mesh has none.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from evodesign.body.placement import Placement
from evodesign.body.shape import Box, Cylinder, Shape, Sphere
from evodesign.report.cad.parts import Parts
from evodesign.tree.frames import link_frames
from evodesign.tree.mesh_write import has_hull, in_frame, vertices_of

Array = NDArray[np.float64]

AROUND: Final = 72
"""Points on a circle."""


@dataclass(frozen=True, slots=True)
class View:
    """A direction of view, in the root link's frame.

    Args:
        title: under the view.
        right: unit vector to the right of the sheet.
        up: unit vector to its top.
    """

    title: str
    right: tuple[float, float, float]
    up: tuple[float, float, float] = (0.0, 0.0, 1.0)

    def seen(self, points: Array) -> Array:
        """Coordinates on the sheet [m], shape (n, 2), of points of shape (n, 3)."""
        found: Array = points @ np.array([self.right, self.up]).T
        return found

    def depth(self, point: Array) -> float:
        """How near a point is to who looks [m]."""
        return float(np.cross(self.right, self.up) @ point)


FRONT: Final = View("front", (0.0, 1.0, 0.0))
"""Seen from ahead: the robot's left is at the right."""

SIDE: Final = View("from the robot's right", (1.0, 0.0, 0.0))


@dataclass(frozen=True, slots=True)
class Outline:
    """A part in a view.

    Args:
        name: of the part.
        corners: of its outline in order, shape (n, 2) [m].
        middle: on the sheet [m].
        depth: how near it is to who looks [m].
    """

    name: str
    corners: Array
    middle: Array
    depth: float


def link_outlines(parts: Parts, view: View) -> list[Outline]:
    """Outlines of all links, the farthest first; of several solids each has its own."""
    found = []
    for part in parts.links:
        for solid in part.link.solids:
            points = points_on(solid.shape, part.root_from_link @ solid.link_from_solid)
            found.append(_outline(part.name, points, view))
    frames = link_frames(parts.tree, Placement(), {})
    for name in parts.meshes:
        meshes = [mesh for mesh in parts.tree.link_by_name[name].meshes if has_hull(mesh)]
        found += [_outline(name, in_frame(vertices_of(mesh), frames[name]), view) for mesh in meshes]
    return sorted(found, key=lambda outline: outline.depth)


def motor_outlines(parts: Parts, view: View) -> list[Outline]:
    """Outlines of all motors, by joint."""
    return [
        _outline(motor.joint.name, points_on(motor.solid.shape, motor.root_from_motor), view)
        for motor in parts.motors
    ]


def _outline(name: str, points: Array, view: View) -> Outline:
    seen, middle = view.seen(points), points.mean(axis=0)
    return Outline(name, seen[ConvexHull(seen).vertices], view.seen(middle[None])[0], view.depth(middle))


def points_on(shape: Shape, frame_from_shape: Placement) -> Array:
    """Points of a shape whose hull is the shape, or in the case of a ball nearly so, shape (n, 3) [m]."""
    angles = np.linspace(0.0, 2.0 * np.pi, AROUND, endpoint=False)
    circle = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    match shape:
        case Sphere(radius):
            rise = np.linspace(-np.pi / 2.0, np.pi / 2.0, AROUND // 2 + 1)
            rings = [np.column_stack([circle * np.cos(each), np.full(AROUND, np.sin(each))]) for each in rise]
            points = float(radius) * np.concatenate(rings)
        case Cylinder(radius, length):
            ends = (-float(length) / 2.0, float(length) / 2.0)
            rings = [np.column_stack([float(radius) * circle, np.full(AROUND, z)]) for z in ends]
            points = np.concatenate(rings)
        case Box():
            signs = np.array([(x, y, z) for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
            points = signs * np.array(shape.sides, float) / 2.0
    return in_frame(points, frame_from_shape)
