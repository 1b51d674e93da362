"""Convex shapes of links: what a shape spans in a direction, and what fits the meshes of a link.

Every shape is the sum of a box, a disc in the plane z = 0 and a ball about one centre, so that one formula
says how far it reaches from there along a direction n given in its own axes (its support function):

    s(n) = h_x |n_x| + h_y |n_y| + h_z |n_z| + d sqrt(n_x^2 + n_y^2) + b |n|

    sphere      b = r
    cylinder    d = r,  h_z = l / 2
    box         h = sides / 2
    capsule     b = r,  h_z = half the distance of its ends' centres

A stretched shape, of the points S x, spans s(S^T n). Meshes are fitted by the box, cylinder or capsule of
least volume along the axes of their points; the independent check takes the meshes' convex hulls.

Source: support functions: Boyd and Vandenberghe, Convex Optimization, section 2.2.6 and exercise 3.35.
"""

from __future__ import annotations

import functools
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from evodesign.body.placement import Matrix, Placement, Scalar, Vector, add, rotate
from evodesign.body.shape import Cylinder, Shape, Sphere
from evodesign.collision.shapes import hull_corners
from evodesign.tree.model import Link, Mesh
from evodesign.tree.surface import Surface

Array = NDArray[np.float64]

UNSTRETCHED: Matrix = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


@dataclass(frozen=True, slots=True)
class ConvexShape:
    """A shape in a link; figures are numbers or expressions [m].

    Args:
        link_from_shape: its place; where it is stretched, before that, but for the centre.
        half_sides: of its box.
        disc: radius of its disc.
        ball: radius of its ball.
        stretch: what is done to its points about its centre, in the link's axes.
    """

    link_from_shape: Placement
    half_sides: Vector = (0.0, 0.0, 0.0)
    disc: Scalar = 0.0
    ball: Scalar = 0.0
    stretch: Matrix = UNSTRETCHED


def shapes_of(link: Link) -> tuple[ConvexShape, ...]:
    """The shapes of a link: its solids, or what is shown in their place; none for a bare frame."""
    if link.solids:
        return tuple(_of_shape(solid.shape, solid.link_from_solid) for solid in link.solids)
    if link.shown:
        return tuple(_of_mesh(mesh, mesh.surface) for mesh in link.shown if mesh.surface is not None)
    return tuple(_of_shape(look.shape, look.link_from_look) for look in link.looks)


def _of_shape(shape: Shape, place: Placement) -> ConvexShape:
    if isinstance(shape, Sphere):
        return ConvexShape(place, ball=shape.radius)
    if isinstance(shape, Cylinder):
        return ConvexShape(place, (0.0, 0.0, shape.length / 2.0), disc=shape.radius)
    return ConvexShape(place, (shape.x / 2.0, shape.y / 2.0, shape.z / 2.0))


def _of_mesh(mesh: Mesh, surface: Surface) -> ConvexShape:
    """What fits a mesh, at the mesh's place in its link."""
    place, fit = mesh.link_from_mesh, _fit(surface, mesh.scale)
    centre = rotate(mesh.stretch, rotate(place.rotation, fit.link_from_shape.translation))
    turned = Placement(place.rotation) @ Placement(fit.link_from_shape.rotation)
    middle = Placement(turned.rotation, add(place.translation, centre))
    return replace(fit, link_from_shape=middle, stretch=mesh.stretch)


@functools.lru_cache(maxsize=1024)
def _fit(surface: Surface, factors: Vector) -> ConvexShape:
    """What fits a surface, scaled along its file's axes."""
    return _least(hull_corners(surface) * np.array(factors))


def _least(points: Array) -> ConvexShape:
    """The box, cylinder or capsule of least volume about points, along their own or principal axes.

    Args:
        points: shape (n, 3).
    """
    return min(
        (
            (volume, place, shape)
            for place, axes in enumerate(_axes(points))
            for volume, shape in _along(points, axes)
        ),
        key=lambda each: each[:2],
    )[2]


def _axes(points: Array) -> Iterator[Array]:
    """Rotations whose columns are axes to try: those given, and the principal ones."""
    yield np.eye(3)
    _, _, rows = np.linalg.svd(points - points.mean(axis=0), full_matrices=False)
    columns = rows.T
    yield columns if np.linalg.det(columns) > 0.0 else columns * np.array([1.0, 1.0, -1.0])


def _along(points: Array, axes: Array) -> Iterator[tuple[float, ConvexShape]]:
    """Volume and shape of each kind along some axes."""
    local = points @ axes
    low, high = local.min(axis=0), local.max(axis=0)
    half, middle = (high - low) / 2.0, (high + low) / 2.0
    yield 8.0 * float(np.prod(half)), _placed(axes, middle, half)
    for turn in (np.eye(3), np.eye(3)[:, [1, 2, 0]], np.eye(3)[:, [2, 0, 1]]):  # each axis as z
        inside = (local - middle) @ turn
        radius = float(np.linalg.norm(inside[:, :2], axis=1).max())
        length = float(np.abs(inside[:, 2]).max())
        upright = np.array([0.0, 0.0, length])
        yield 2.0 * np.pi * radius**2 * length, _placed(axes @ turn, turn.T @ middle, upright, disc=radius)
        beyond = np.abs(inside[:, 2]) - np.sqrt(
            np.maximum(radius**2 - np.sum(inside[:, :2] ** 2, axis=1), 0.0)
        )
        straight = max(float(beyond.max()), 0.0)
        volume = np.pi * radius**2 * (2.0 * straight + 4.0 / 3.0 * radius)
        yield (
            float(volume),
            _placed(axes @ turn, turn.T @ middle, np.array([0.0, 0.0, straight]), ball=radius),
        )


def _placed(axes: Array, middle: Array, half: Array, disc: float = 0.0, ball: float = 0.0) -> ConvexShape:
    first, second, third = axes.tolist()
    rotation: Matrix = (tuple(first), tuple(second), tuple(third))
    x, y, z = (float(each) for each in axes @ middle)
    sides = (float(half[0]), float(half[1]), float(half[2]))
    return ConvexShape(Placement(rotation, (x, y, z)), sides, disc, ball)
