"""Convex solids of links for coal: spheres, cylinders, boxes, and the convex hulls of meshes.

A link's solids are what its mass is of; a link whose inertia is the file's has its meshes, or else the shapes
that show it. A hull fills what is hollow; where hulls are in each other, triangles decide
(`collision.triangles`).

Source: coal (formerly hpp-fcl); convex hulls: Qhull, by scipy.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Any

import coal
import numpy as np
import scipy
from numpy.typing import NDArray

from evodesign.body.placement import Placement
from evodesign.body.shape import Box, Cylinder, Shape, Sphere
from evodesign.tree.model import Link, Mesh
from evodesign.tree.surface import Surface

Array = NDArray[np.float64]

THIN = 1e-4  # [m]


@dataclass(frozen=True, slots=True, eq=False)
class ConvexSolid:
    """A convex solid in a link.

    Args:
        geometry: coal's.
        rotation: link_from_geometry, shape (3, 3).
        position: of the geometry's origin in the link [m].
        centre: of a ball about the solid, in the link [m].
        radius: of the ball [m].
        middle, half_sides: of a box about the solid along the geometry's axes, about its origin [m].
        mesh: that it is the hull of, if any; the geometry then stands in the link's frame.
    """

    geometry: Any
    rotation: Array
    position: Array
    centre: Array
    radius: float
    middle: Array
    half_sides: Array
    mesh: Mesh | None = None


def solids_of(link: Link) -> tuple[ConvexSolid, ...]:
    """The solids of a link of numbers; none for a bare frame."""
    if link.solids:
        return tuple(solid_of(solid.shape, solid.link_from_solid) for solid in link.solids)
    if link.shown:
        return tuple(_of_mesh(mesh, mesh.surface) for mesh in link.shown if mesh.surface is not None)
    return tuple(solid_of(look.shape, look.link_from_look) for look in link.looks)


def box_solid(shape: Box) -> ConvexSolid:
    """A box about the origin."""
    return solid_of(shape, Placement())


def solid_of(shape: Shape, place: Placement) -> ConvexSolid:
    """A shape of numbers at its place in a link."""
    rotation, position = np.array(place.rotation, float), np.array(place.translation, float)
    if isinstance(shape, Sphere):
        geometry, radius = coal.Sphere(float(shape.radius)), float(shape.radius)
        half = np.full(3, radius)
    elif isinstance(shape, Cylinder):
        geometry = coal.Cylinder(float(shape.radius), float(shape.length))
        half = np.array([shape.radius, shape.radius, shape.length / 2.0], float)
        radius = float(np.linalg.norm(half[1:]))
    else:
        half = np.array(shape.sides, float) / 2.0
        geometry, radius = coal.Box(*map(float, shape.sides)), float(np.linalg.norm(half))
    return ConvexSolid(geometry, rotation, position, position, radius, np.zeros(3), half)


@functools.lru_cache(maxsize=256)
def _of_mesh(mesh: Mesh, surface: Surface) -> ConvexSolid:
    """The hull of a mesh at its place in its link: a design stretches a few, and all others are met again."""
    turn = np.array(mesh.stretch, float) @ np.array(mesh.link_from_mesh.rotation, float)
    points = hull_corners(surface) * np.array(mesh.scale, float) @ turn.T
    points = points + np.array(mesh.link_from_mesh.translation, float)
    low, high = points.min(axis=0), points.max(axis=0)
    centre = (high + low) / 2.0
    radius = float(np.linalg.norm(points - centre, axis=1).max())
    half = (high - low) / 2.0
    hull = _hull(points, _hull_faces(surface))
    return ConvexSolid(hull, np.eye(3), np.zeros(3), centre, radius, centre, half, mesh)


@functools.lru_cache(maxsize=1024)
def hull_corners(surface: Surface) -> Array:
    """The corners of a surface's convex hull, which scaling and stretching keep."""
    hull = _convex_hull(vertices := np.array(surface.vertices, float))
    # without a hull it is in a plane, or on a line
    return np.unique(vertices, axis=0) if hull is None else np.asarray(vertices[np.sort(hull.vertices)])


@functools.lru_cache(maxsize=1024)
def _hull_faces(surface: Surface) -> Any:
    """Coal's triangles of these corners, which stretching keeps, too; None where they have no volume."""
    hull = _convex_hull(hull_corners(surface))
    return None if hull is None else _triangles(hull)


def _convex_hull(points: Array) -> Any:
    """SciPy's; None of points in a plane or on a line."""
    try:
        return scipy.spatial.ConvexHull(points)
    except scipy.spatial.QhullError:
        return None


def _hull(points: Array, faces: Any) -> Any:
    """A convex hull; points without faces are thickened by a tenth of a millimetre."""
    if faces is None:
        points = np.concatenate([points + sign * THIN * axis for sign in (-1.0, 1.0) for axis in np.eye(3)])
        faces = _triangles(_convex_hull(points))
    corners = coal.StdVec_Vec3s()
    corners.extend(list(points))
    return coal.Convex(corners, faces)


def _triangles(hull: Any) -> Any:
    faces = coal.StdVec_Triangle()
    faces.extend([coal.Triangle(*map(int, face)) for face in hull.simplices])
    return faces
