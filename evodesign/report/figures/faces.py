"""The flat faces of shapes, round ones as polyhedra, and the triangles of meshes."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from evodesign.body.placement import Placement, Vector
from evodesign.body.shape import Box, Cylinder, Shape, Sphere
from evodesign.tree.mesh_write import in_frame, triangles_of, vertices_of
from evodesign.tree.model import Mesh

Array = NDArray[np.float64]

AROUND = 18
"""Faces around a cylinder or a ball."""


@dataclass(frozen=True, slots=True, eq=False)
class Face:
    """A convex flat face in the world.

    Args:
        corners: counter-clockwise as seen from outside [m], shape (n, 3).
        normal: outward unit normal, shape (3,).
    """

    corners: Array
    normal: Array


def faces_of(shape: Shape, world_from_shape: Placement) -> list[Face]:
    """The faces of a shape of numbers, round ones as polyhedra."""
    faces = []
    for corners in _outlines(shape):
        placed = in_frame(corners, world_from_shape)
        normal = _normal(placed)
        if normal is not None:
            faces.append(Face(placed, normal))
    return faces


def _outlines(shape: Shape) -> list[Array]:
    match shape:
        case Box():
            return _box(shape.sides)
        case Cylinder(radius, length):
            return _rings([(radius, -length / 2.0), (radius, length / 2.0)])
        case Sphere(radius):
            angles = np.linspace(-math.pi / 2.0, math.pi / 2.0, AROUND // 2 + 1)
            return _rings([(radius * math.cos(angle), radius * math.sin(angle)) for angle in angles])


def _box(sides: Vector) -> list[Array]:
    half = np.array(sides) / 2.0
    outlines = []
    for axis in range(3):
        first, second = (axis + 1) % 3, (axis + 2) % 3
        for sign in (1.0, -1.0):
            corners = np.zeros((4, 3))
            corners[:, axis] = sign
            corners[:, first] = [-1.0, 1.0, 1.0, -1.0]
            corners[:, second] = [-sign, -sign, sign, sign]
            outlines.append(corners * half)
    return outlines


def _rings(rings: list[tuple[float, float]]) -> list[Array]:
    """A body of revolution about z through rings of (radius, height), from the lowest up, with both ends."""
    around = np.arange(AROUND) * 2.0 * math.pi / AROUND
    circle = np.stack([np.cos(around), np.sin(around)], axis=1)
    levels = [np.column_stack([circle * radius, np.full(AROUND, height)]) for radius, height in rings]
    outlines = [levels[0][::-1], levels[-1]]
    for low, high in itertools.pairwise(levels):
        outlines += [
            np.array([low[i], low[(i + 1) % AROUND], high[(i + 1) % AROUND], high[i]]) for i in range(AROUND)
        ]
    return outlines


def _normal(corners: Array) -> Array | None:
    """Outward unit normal by Newell's sum; None for a face without area."""
    x, y, z = corners.T
    next_x, next_y, next_z = corners[[*range(1, len(corners)), 0]].T
    area = np.array([y @ next_z - z @ next_y, z @ next_x - x @ next_z, x @ next_y - y @ next_x])
    size = math.hypot(*area)
    return None if size < 1e-12 else area / size


def seen_triangles(mesh: Mesh, world_from_link: Placement, towards: Array) -> tuple[Array, Array]:
    """Corners [m], shape (m, 3, 3), and unit normals, shape (m, 3), of the triangles that face a camera.

    All at once: a robot has tens of thousands of them. Of a mesh that is not watertight both sides are seen:
    its triangles need not agree on what is outside.

    Args:
        mesh: with its triangles.
        world_from_link: of the link that it shows.
        towards: unit vector to the camera, in the world.
    """
    corners = in_frame(vertices_of(mesh), world_from_link)[triangles_of(mesh)]
    areas = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    facing = areas @ towards
    if not mesh.encloses:
        areas, facing = areas * np.sign(facing)[:, None], np.abs(facing)
    seen = facing > 0.0
    normals = areas[seen] / np.linalg.norm(areas[seen], axis=1, keepdims=True)
    return corners[seen], normals
