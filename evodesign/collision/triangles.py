"""Meshes by their triangles: whether two bodies are in each other whose convex hulls are, and how deep.

A hull fills what is hollow: of shells, forks and cups that are built into each other it tells nothing. Bodies
are in each other where surfaces cross, or where one is within the other. How deep is found by moving one
along the direction that parts the hulls: never less than the true depth, and never more than the hulls'.

Source: coal (formerly hpp-fcl); a point is inside of a mesh if the solid angles of its triangles add up to
4 pi: van Oosterom and Strackee (1983).
"""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Any

import coal
import numpy as np
from numpy.typing import NDArray

from evodesign.tree.mesh_write import triangles_of, vertices_of
from evodesign.tree.model import Mesh

Array = NDArray[np.float64]

FINE = 2e-4
"""To what a depth is found [m]."""


@dataclass(frozen=True, slots=True, eq=False)
class Triangles:
    """A mesh in its link.

    Args:
        geometry: coal's.
        corners: of each triangle, shape (n, 3, 3) [m].
        low, high: the least and the largest coordinates of all.
        ends: the corners that have these, shape (6, 3) [m].
    """

    geometry: Any
    corners: Array
    low: Array
    high: Array
    ends: Array

    def is_around(self, point: Array) -> bool:
        """Whether a point in the link's frame [m] is inside."""
        a, b, c = np.moveaxis(self.corners - point, 1, 0)
        u, v, w = (np.linalg.norm(each, axis=1) for each in (a, b, c))
        above = np.einsum("ij,ij->i", a, np.cross(b, c))
        dots = (np.einsum("ij,ij->i", *each) for each in ((a, b), (b, c), (c, a)))
        below = u * v * w + sum(dot * length for dot, length in zip(dots, (w, u, v), strict=True))
        return bool(abs(np.arctan2(above, below).sum()) > np.pi)  # half of 4 pi, of half angles


@dataclass(frozen=True, slots=True, eq=False)
class PlacedBody:
    """A body in the world.

    Args:
        geometry: coal's, of the triangles where there are any.
        rotation, position: world_from_geometry, shapes (3, 3) and (3,) [m].
        triangles: those of a mesh.
    """

    geometry: Any
    rotation: Array
    position: Array
    triangles: Triangles | None

    def moved(self, by: Array) -> PlacedBody:
        """The same elsewhere in the world."""
        return PlacedBody(self.geometry, self.rotation, self.position + by, self.triangles)

    @property
    def place(self) -> Any:
        """Coal's."""
        return coal.Transform3s(self.rotation, self.position)

    def is_around(self, other: PlacedBody) -> bool:
        """Whether another body is inside, whose surface does not cross this one's: all of it, or nothing."""
        mesh = self.triangles
        if mesh is None:
            return False  # simple shapes are solid for coal
        local = other.triangles.ends if other.triangles else np.zeros((1, 3))
        points = (local @ other.rotation.T + other.position - self.position) @ self.rotation
        if np.any(points < mesh.low) or np.any(points > mesh.high):
            return False
        return mesh.is_around(points[0])


@functools.lru_cache(maxsize=512)
def triangles_in_link(mesh: Mesh) -> Triangles:
    """Those of a mesh with a surface."""
    vertices, faces = vertices_of(mesh), np.ascontiguousarray(triangles_of(mesh))
    geometry = coal.BVHModelOBBRSS()
    geometry.beginModel(len(faces), len(vertices))
    geometry.addVertices(vertices)
    geometry.addTriangles(faces)
    geometry.endModel()
    corners = vertices[faces]
    points = corners.reshape(-1, 3)
    ends = points[[*points.argmin(axis=0), *points.argmax(axis=0)]]
    return Triangles(geometry, corners, points.min(axis=0), points.max(axis=0), ends)


def are_in_each_other(one: PlacedBody, other: PlacedBody) -> bool:
    """Whether two bodies have a point in common."""
    request, result = coal.CollisionRequest(), coal.CollisionResult()
    crossed = coal.collide(one.geometry, one.place, other.geometry, other.place, request, result)
    return bool(crossed) or one.is_around(other) or other.is_around(one)


def distance_apart(one: PlacedBody, other: PlacedBody) -> float:
    """How far two bodies are apart that are not in each other [m]."""
    request, result = coal.DistanceRequest(), coal.DistanceResult()
    found = coal.distance(one.geometry, one.place, other.geometry, other.place, request, result)
    return max(float(found), 0.0)


def depth_along(one: PlacedBody, other: PlacedBody, way: Array, depth: float) -> float:
    """How far the other one has to be moved along a unit vector until it is outside of the one [m].

    Args:
        one: a body.
        other: another one, in it.
        way: the direction from the one to the other.
        depth: how far is enough [m].
    """
    low, high = 0.0, depth
    while high - low > FINE:
        half = 0.5 * (low + high)
        low, high = (half, high) if are_in_each_other(one, other.moved(half * way)) else (low, half)
    return high
