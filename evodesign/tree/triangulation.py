"""Triangles of shapes: closed surfaces of revolution and boxes, their vertices on the shape.

    ring k of a surface of revolution    r_k (cos a, sin a), z_k    for angles a of so many sides

Counter-clockwise seen from outside. A turned surface of 40 sides encloses 0.4 % less than the shape.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from evodesign.body.placement import Vector
from evodesign.body.shape import Box, Cylinder, Shape, Sphere
from evodesign.tree.model import Look, Mesh
from evodesign.tree.surface import Surface, surface_of

SIDES, ARCS = 40, 8
"""Around the axis, and between a pole and the equator."""

Triangles = tuple[NDArray[np.float64], NDArray[np.int64]]


def capsule(radius: float, length: float) -> Triangles:
    """Vertices [m], shape (n, 3), and triangles, shape (m, 3), of a cylinder along z with round ends."""
    quarter = np.linspace(0.0, math.pi / 2.0, ARCS, endpoint=False)
    angles = np.concatenate([-quarter[::-1], quarter])
    ends = np.repeat([-length / 2.0, length / 2.0], ARCS)
    return _turned(radius * np.cos(angles), radius * np.sin(angles) + ends, length / 2.0 + radius)


@functools.cache
def capsule_surface(radius: float, length: float) -> Surface:
    """The same as a surface [m], with the shape's own volume, pi r^2 (l + 4 r / 3)."""
    return surface_of(*capsule(radius, length), math.pi * radius**2 * (length + 4.0 / 3.0 * radius))


def ellipsoid(x: float, y: float, z: float) -> Triangles:
    """The same of an ellipsoid of three semi-axes [m]."""
    angles = np.linspace(-math.pi / 2.0, math.pi / 2.0, 2 * ARCS + 1)[1:-1]
    vertices, faces = _turned(np.cos(angles), np.sin(angles), 1.0)
    return vertices * (x, y, z), faces


def scaled_surface(shape: Shape) -> tuple[str, Surface, Vector]:
    """The name and surface of a shape's kind, and by how much it is scaled along x, y, z."""
    match shape:
        case Sphere(radius):
            return "sphere", _unit("sphere"), (radius, radius, radius)
        case Cylinder(radius, length):
            return "cylinder", _unit("cylinder"), (radius, radius, length)
        case Box():
            return "box", _unit("box"), shape.sides


def mesh_of_look(look: Look) -> Mesh:
    """A shape that is only seen as a mesh."""
    kind, surface, factors = scaled_surface(look.shape)
    return Mesh(kind, factors, look.link_from_look, surface=surface)


@functools.cache
def _unit(kind: str) -> Surface:
    """A ball or cylinder of radius 1, a cylinder or box of length 1; with the shape's own volume."""
    if kind == "sphere":
        return surface_of(*ellipsoid(1.0, 1.0, 1.0), 4.0 / 3.0 * math.pi)
    if kind == "cylinder":
        return surface_of(*_turned([1.0, 1.0], [-0.5, 0.5], 0.5), math.pi)
    corner = math.sqrt(0.5)
    return surface_of(*_turned([corner, corner], [-0.5, 0.5], 0.5, sides=4), 1.0)


def _turned(
    radii: Sequence[float] | NDArray[np.float64],
    heights: Sequence[float] | NDArray[np.float64],
    top: float,
    sides: int = SIDES,
) -> Triangles:
    """Rings from below to above, closed at the axis at heights -top and top."""
    angles = (np.arange(sides) + 0.5) * (2.0 * math.pi / sides)
    around = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    rings = [np.column_stack([r * around, np.full(sides, z)]) for r, z in zip(radii, heights, strict=True)]
    vertices = np.vstack([*rings, [[0.0, 0.0, -top], [0.0, 0.0, top]]])
    here = np.arange(sides)
    following = (here + 1) % sides
    last, below = sides * (len(rings) - 1), np.full(sides, sides * len(rings))
    faces = [
        np.stack([below, following, here], axis=1),
        np.stack([below + 1, here + last, following + last], 1),
    ]
    for start in range(0, last, sides):
        a, b, c, d = here + start, following + start, following + start + sides, here + start + sides
        faces += [np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)]
    return vertices, np.vstack(faces)
