"""Directions along which two placed convex bodies are parted, the best one first.

The distance of two convex bodies is the largest of n . (c_2 - c_1) - s_1(n) - s_2(-n) over unit vectors n. It
is looked for among the directions that part boxes and cylinders: normals of faces, products of edges and
axes, and the shortest way between them (the separating axis theorem for boxes; for the others a little less
than the distance may be found, so that rows may be switched on that are not needed, never the reverse).

Source: separating axes: Gottschalk, Lin and Manocha, OBBTree (1996).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from evodesign.posture.terms.collisions import NUMBERS, ROUNDING

__all__ = ["SHAPE", "Way", "parted_along"]

Array = NDArray[np.float64]

DIFFERENT = 0.7
"""Cosine between two directions that are different ways to part bodies."""

STEPS = 8
"""From body to body, on the shortest way between them."""

SHAPE = 36
"""Numbers of a placed shape: centre, box, disc, ball, axes."""


@dataclass(frozen=True, slots=True)
class Way:
    """A direction that parts two bodies.

    Args:
        numbers: that stand for it, as in `terms.collisions`.
        distance: how far they are apart along it [m].
    """

    numbers: Array
    distance: float


def parted_along(pairs: Array, enough: float) -> list[Way]:
    """Directions along which two bodies are parted, the best one first; others that differ from all before.

    Args:
        pairs: the numbers of each shape of the one with each of the other, shape (pairs, 2, SHAPE).
        enough: bodies whose balls are farther apart than this [m] are not looked at.
    """
    between = np.linalg.norm(pairs[:, 1, :3] - pairs[:, 0, :3], axis=1)
    if np.min(between - _radii(pairs[:, 0]) - _radii(pairs[:, 1])) > enough:
        return []
    found = [_candidates(one, other) for one, other in pairs]
    vectors, numbers = (np.concatenate([each[k] for each in found]) for k in (0, 1))
    apart = np.min([_apart(vectors, one, other) for one, other in pairs], axis=0)
    chosen: list[int] = []
    for place in np.argsort(-apart, kind="stable").tolist():
        if all(vectors[place] @ vectors[other] < DIFFERENT for other in chosen):
            chosen.append(place)
    return [Way(numbers[place], float(apart[place])) for place in chosen]


def _spans(numbers: Array) -> tuple[Array, Array, Array]:
    """Columns of box, disc and ball."""
    return (
        numbers[3:12].reshape(3, 3).T,
        numbers[12:18].reshape(2, 3).T,
        numbers[18:27].reshape(3, 3).T,
    )


def _radii(numbers: Array) -> Array:
    """Of balls about shapes, shape (n, SHAPE)."""
    box = np.linalg.norm(numbers[:, 3:12], axis=1)
    return np.asarray(
        box + np.linalg.norm(numbers[:, 12:15], axis=1) + np.linalg.norm(numbers[:, 18:27], axis=1)
    )


def _apart(directions: Array, one: Array, other: Array) -> Array:
    """How far two shapes are apart along unit vectors, shape (n, 3), as rows have it."""
    found = directions @ (other[:3] - one[:3])
    for numbers in (one, other):
        box, disc, ball = _spans(numbers)
        box_sizes, disc_size = ROUNDING**2 * (box**2).sum(axis=0), ROUNDING**2 * (disc[:, 0] ** 2).sum()
        found = found - np.sqrt((directions @ box) ** 2 + box_sizes).sum(axis=1)
        found = found - np.sqrt(((directions @ disc) ** 2).sum(axis=1) + disc_size)
        found = found - np.linalg.norm(directions @ ball, axis=1)
    return np.asarray(found)


def _candidates(one: Array, other: Array) -> tuple[Array, Array]:
    """Unit vectors that lead from the one to the other, and the numbers that stand for them."""
    between = other[:3] - one[:3]
    axes, other_axes = (each[27:].reshape(3, 3).T for each in (one, other))
    edges, other_edges = _edges(one), _edges(other)
    sides = np.array([*edges, *other_edges])
    away = [between, _shortest(one, other)]
    away += [
        between - (between @ edge) * edge for edge in (*edges, *other_edges)
    ]  # straight away from an axis
    away += [_cross(u, v) for u in edges for v in other_edges]
    vectors = np.concatenate([sides, np.array(away)]) if len(sides) else np.array(away)
    lengths = np.linalg.norm(vectors, axis=1)
    kept = lengths > 1e-9
    units = vectors[kept] / lengths[kept, None]
    units = np.where((units @ between < 0.0)[:, None], -units, units)
    places = np.flatnonzero(kept)
    numbers = np.zeros((len(units), NUMBERS))
    numbers[:, 0] = 1.0
    of_other = (places >= len(edges)) & (places < len(sides))
    numbers[~of_other, 1:4] = units[~of_other] @ axes
    numbers[of_other, 4:7] = units[of_other] @ other_axes
    return units, numbers


def _cross(a: Array, b: Array) -> Array:
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def _edges(numbers: Array) -> list[Array]:
    """Unit vectors along a box's sides, or along a cylinder's axis."""
    disc = numbers[12:18].reshape(2, 3)
    columns = [*numbers[3:12].reshape(3, 3), _cross(disc[0], disc[1])]
    lengths = [float(np.linalg.norm(column)) for column in columns]
    found: list[Array] = []
    for column, length in zip(columns, lengths, strict=True):
        if length > 1e-9 and all(abs(column @ each) < 0.999 * length for each in found):
            found.append(column / length)
    return found


def _shortest(one: Array, other: Array) -> Array:
    """From the one's box to the other's, by going to and fro."""
    from_one, from_other = one[:3], other[:3]
    for _ in range(STEPS):
        from_one = _nearest_in_box(one, from_other)
        from_other = _nearest_in_box(other, from_one)
    return np.asarray(from_other - from_one)


def _nearest_in_box(numbers: Array, point: Array) -> Array:
    box = _spans(numbers)[0]
    squares = (box**2).sum(axis=0)
    shares = np.divide((point - numbers[:3]) @ box, squares, out=np.zeros(3), where=squares > 0.0)
    return np.asarray(numbers[:3] + box @ np.clip(shares, -1.0, 1.0))
