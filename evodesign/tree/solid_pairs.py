"""Solids of two links, or of one, that are nearly mirror images: the means of both.

All solids are given in the root's frame. A box looks the same from six sides and a cylinder from two, all
round, so the axes of an image are first named like those of what it is compared with. The mean of two masses
is that of the mean shape; its density follows.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from evodesign.body.placement import Matrix, Placement, vector
from evodesign.body.shape import Box, Cylinder, Shape, Solid, Sphere
from evodesign.tree.mirror_images import ANGLE, PLACE

Array = NDArray[np.float64]


def mean_solids(
    mine: Sequence[Solid], its: Sequence[Solid], *, middle: bool
) -> tuple[list[Solid], list[Solid]] | None:
    """The solids of two links as exact mirror images of each other, each in its link's order.

    Args:
        mine: of numbers, in the root's frame.
        its: of the mirror partner; the same ones on the middle line.
        middle: whether both are one link.
    Returns:
        None where the solids do not correspond one to one within the tolerance.
    """
    if len(mine) != len(its):
        return None
    ours: list[Solid | None] = [None] * len(mine)
    theirs: list[Solid | None] = [None] * len(its)
    for number, solid in enumerate(mine):
        if ours[number] is not None:
            continue
        image = mirrored(solid)
        open_ones = [
            k for k, other in enumerate(theirs) if other is None and _fits(image, its[k], middle=middle)
        ]
        if not open_ones:
            return None
        partner = min(open_ones, key=lambda k: _apart(image, its[k]))
        mean = _mean(image, its[partner])
        theirs[partner] = mean
        ours[number] = _named_like(mirrored(mean), solid)
        if middle and partner != number:
            ours[partner], theirs[number] = mean, ours[number]
    return [each for each in ours if each is not None], [each for each in theirs if each is not None]


def mirrored(solid: Solid) -> Solid:
    """The mirror image of a solid in the root's frame."""
    return Solid(solid.shape, solid.link_from_solid.mirrored(), solid.density)


def mean_rotation(one: Array, other: Array) -> Array:
    """The rotation nearest to the mean of two near ones (orthogonal Procrustes)."""
    left, _, right = np.linalg.svd((one + other) / 2.0)
    found: Array = left @ right
    return found


def turned_by(one: Array, other: Array) -> float:
    """Angle [rad] between two rotations: 2 asin(|A - B| / (2 sqrt 2)) in the Frobenius norm."""
    return float(2.0 * np.arcsin(min(1.0, float(np.linalg.norm(one - other)) / np.sqrt(8.0))))


def _center(solid: Solid) -> Array:
    return np.array(solid.link_from_solid.translation, dtype=float)


def _rotation(solid: Solid) -> Array:
    return np.array(solid.link_from_solid.rotation, dtype=float)


def _apart(one: Solid, other: Solid) -> float:
    return float(np.linalg.norm(_center(one) - _center(other)))


def _fits(image: Solid, other: Solid, *, middle: bool) -> bool:
    """Whether the mirror image of a solid is another one, in kind, size and place within the tolerance."""
    if type(image.shape) is not type(other.shape):
        return False
    named, allowed = _named_like(image, other), 2.0 if middle else 1.0
    sizes = np.abs(np.array(_sizes(named.shape)) - np.array(_sizes(other.shape)))
    return bool(
        sizes.max() <= allowed * PLACE
        and _apart(named, other) <= allowed * PLACE
        and turned_by(_rotation(named), _rotation(other)) <= allowed * ANGLE
    )


def _sizes(shape: Shape) -> tuple[float, ...]:
    match shape:
        case Sphere(radius):
            return (radius,)
        case Cylinder(radius, length):
            return (radius, length)
        case Box(x, y, z):
            return (x, y, z)


def _named_like(solid: Solid, like: Solid) -> Solid:
    """The same solid with its axes named, and its turn about them chosen, as near as can be to another's."""
    rotation, wanted, shape = _rotation(solid), _rotation(like), solid.shape
    match shape:
        case Sphere():
            rotation = wanted
        case Cylinder():
            axis = rotation[:, 2] * np.copysign(1.0, rotation[:, 2] @ wanted[:, 2])
            rotation = _turn_between(wanted[:, 2], axis) @ wanted
        case Box():
            along = wanted.T @ rotation
            order = [int(np.argmax(np.abs(row))) for row in along]
            if len(set(order)) == len(order):
                signs = [np.copysign(1.0, row[k]) for row, k in zip(along, order, strict=True)]
                rotation = rotation[:, order] * signs
                shape = Box(*(shape.sides[k] for k in order))
    return Solid(shape, Placement(matrix(rotation), solid.link_from_solid.translation), solid.density)


def _turn_between(one: Array, other: Array) -> Array:
    """The least rotation from a unit vector to one that is not its opposite: 1 + [w]x + [w]x^2 / (1 + c)."""
    x, y, z = np.cross(one, other)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    found: Array = np.eye(3) + cross + cross @ cross / (1.0 + float(one @ other))
    return found


def _mean(image: Solid, other: Solid) -> Solid:
    """The mean of a mirror image and what it is nearly."""
    named = _named_like(image, other)
    sizes = [(a + b) / 2.0 for a, b in zip(_sizes(named.shape), _sizes(other.shape), strict=True)]
    shape = type(other.shape)(*sizes)
    rotation = mean_rotation(_rotation(named), _rotation(other))
    place = Placement(matrix(rotation), vector((_center(named) + _center(other)) / 2.0))
    mass = (float(image.mass) + float(other.mass)) / 2.0
    return Solid(shape, place, mass / float(shape.volume))


def matrix(rows: Array) -> Matrix:
    """Nine numbers as a tuple of rows."""
    return (vector(rows[0]), vector(rows[1]), vector(rows[2]))
