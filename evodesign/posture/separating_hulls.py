"""Directions that part placed shapes of which some are hulls of corners (`collision.corners`), in numbers.

Two polytopes that are apart are parted by a normal of a face or a product of two edges (the separating axis
theorem); the direction between their centres is tried as well. Boxes and cylinders count by their sides and
axes. Distances along directions are those of the rows, with edges blended as there.

Source: separating axes: Gottschalk, Lin and Manocha, OBBTree (1996); hulls: Qhull, by scipy.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from evodesign.posture.placed_shape import ROUNDING, SHAPE, smooth_max

__all__ = ["hull_ways"]

Array = NDArray[np.float64]

SHORT = 1e-9
"""Length [m] below which a vector has no direction."""


@dataclass(frozen=True, slots=True, eq=False)
class _Placed:
    """A placed shape of numbers: as `PlacedShape`, with spans as rows.

    Args:
        centre: shape (3,) [m].
        axes: of its link, as columns.
        box, disc, ball: shapes (3, 3), (2, 3), (3, 3), in these axes [m].
        corners: shape (n, 3), likewise.
    """

    centre: Array
    axes: Array
    box: Array
    disc: Array
    ball: Array
    corners: Array

    @classmethod
    def of(cls, column: Array) -> _Placed:
        """That which a column of numbers stands for."""
        rows = column.reshape(-1, 3)
        return cls(rows[0], rows[1:4].T, rows[4:7], rows[7:9], rows[9:12], rows[SHAPE // 3 :])

    def support(self, units: Array) -> Array:
        """How far it reaches from its centre along unit vectors of the world, shape (n, 3) [m]."""
        local = units @ self.axes
        reach = np.zeros(len(units))
        for side in self.box:
            reach += np.sqrt((local @ side) ** 2 + ROUNDING**2 * (side @ side))
        for round_part in (self.disc, self.ball):
            inside = np.sum((local @ round_part.T) ** 2, axis=1)
            reach += np.sqrt(inside + ROUNDING**2 * (round_part[0] @ round_part[0]))
        return reach + smooth_max([*(self.corners @ local.T)]) if len(self.corners) else reach

    def faces_and_edges(self) -> tuple[Array, Array]:
        """Normals of its faces and directions of its edges in the world, of any length."""
        if len(self.corners):
            faces, edges = _hull(self.corners)
        else:
            faces = edges = np.concatenate([self.box, [np.cross(*self.disc)]])
        return faces @ self.axes.T, edges @ self.axes.T


def hull_ways(pairs: Sequence[tuple[Array, Array]]) -> tuple[Array, Array]:
    """Numbers that stand for directions as in `terms.collisions`, and how far all pairs are apart along each.

    Args:
        pairs: numbers of each shape of the one body with each of the other.
    Returns:
        Shapes (n, 7) and (n,) [m].
    """
    placed = [(_Placed.of(one), _Placed.of(other)) for one, other in pairs]
    held, units = [], []
    for one, other in placed:
        (faces, edges), (others, other_edges) = one.faces_and_edges(), other.faces_and_edges()
        across = np.cross(edges[:, None], other_edges[None]).reshape(-1, 3)
        in_one = _both_ways(np.concatenate([faces, (other.centre - one.centre)[None], across]))
        in_other = _both_ways(others)
        zeros = np.zeros
        held.append(np.concatenate([in_one @ one.axes, zeros(in_one.shape)], axis=1))
        held.append(np.concatenate([zeros(in_other.shape), in_other @ other.axes], axis=1))
        units += [in_one, in_other]
    every = np.concatenate(units)
    apart = [
        every @ (other.centre - one.centre) - one.support(every) - other.support(-every)
        for one, other in placed
    ]
    numbers = np.concatenate(held)
    return np.concatenate([np.ones((len(numbers), 1)), numbers], axis=1), np.min(apart, axis=0)


def _both_ways(vectors: Array) -> Array:
    """Unit vectors along and against some that are not too short."""
    lengths = np.linalg.norm(vectors, axis=1)
    units = vectors[lengths > SHORT] / lengths[lengths > SHORT, None]
    return np.concatenate([units, -units])


def _hull(corners: Array) -> tuple[Array, Array]:
    """Normals of the faces of a hull, and its edges; of a flat one both sides count as one face."""
    from scipy.spatial import ConvexHull, QhullError  # takes a fifth of a second to load

    try:
        hull = ConvexHull(corners)
    except (QhullError, ValueError):
        first, second = np.triu_indices(len(corners), 1)
        flat = np.linalg.svd(corners - corners.mean(axis=0), full_matrices=True)[2]
        return flat[2:], corners[second] - corners[first]
    first, second = np.unique(
        np.sort(
            np.concatenate([hull.simplices[:, [0, 1]], hull.simplices[:, [1, 2]], hull.simplices[:, [0, 2]]])
        ),
        axis=0,
    ).T
    return hull.equations[:, :3], corners[second] - corners[first]
