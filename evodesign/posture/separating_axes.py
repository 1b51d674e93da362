"""Directions along which two placed convex bodies are parted, the best one first.

The distance of two convex bodies is the largest of n . (c_2 - c_1) - s_1(n) - s_2(-n) over unit vectors n. It
is looked for among the directions that part boxes and cylinders: normals of faces, products of edges and
axes, and the shortest way between them (the separating axis theorem for boxes; for the others a little less
than the distance may be found, so that rows may be switched on that are not needed, never the reverse).

Source: separating axes: Gottschalk, Lin and Manocha, OBBTree (1996).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from evodesign.nlp.buffered import BufferedFunction
from evodesign.nlp.codegen import compiled_function
from evodesign.posture.placed_shape import SHAPE, PlacedShape
from evodesign.posture.terms.collisions import NUMBERS

Array = NDArray[np.float64]
Expression = Any

STEPS = 8
"""From body to body, on the shortest way between them."""

SHORT = 1e-18
"""Squared length [m^2] below which a vector has no direction."""


@dataclass(frozen=True, slots=True, eq=False)
class Ways:
    """Directions that may part two bodies.

    Args:
        numbers: that stand for them, as in `terms.collisions`, shape (n, NUMBERS).
        apart: how far the bodies are apart along each [m]; minus infinity for one that is none.
    """

    numbers: Array
    apart: Array

    @property
    def distance(self) -> float:
        """How far the bodies are apart along the best one [m]."""
        return float(self.apart.max())

    @property
    def best(self) -> Array:
        """The numbers of the best direction."""
        return np.asarray(self.numbers[int(self.apart.argmax())])


def ways_of(meetings: Sequence[Array]) -> list[Ways]:
    """The ways to part the bodies of each meeting.

    Args:
        meetings: of each, the numbers of every shape of the one with every shape of the other, shape
            (pairs, 2, SHAPE).
    """
    candidates, apart = _functions()
    ways = []
    for pairs in meetings:
        columns = [pair.ravel() for pair in pairs]
        units, numbers, distances = zip(*map(candidates, columns), strict=True)
        found = np.concatenate(distances)
        if len(columns) > 1:  # along the directions of every pair of shapes, all of them
            along = [np.min([apart(column, unit)[0] for column in columns], axis=0) for unit in units]
            found = np.where(np.isfinite(found), np.concatenate(along), -np.inf)
        ways.append(Ways(np.concatenate(numbers).reshape(-1, NUMBERS), found))
    return ways


@cache
def _functions() -> tuple[BufferedFunction, BufferedFunction]:
    """Of two shapes: directions, their numbers and distances along them; and distances along given ones."""
    pair = ca.SX.sym("pair", 2 * SHAPE)
    one, other = (PlacedShape.of(pair[half * SHAPE : (half + 1) * SHAPE]) for half in range(2))
    between = other.centre - one.centre
    edges, other_edges = one.sides, other.sides
    away = [between, _shortest(one, other)]
    away += [
        between - ca.dot(between, edge) / (ca.sumsqr(edge) + SHORT) * edge for edge in (*edges, *other_edges)
    ]
    away += [ca.cross(u, v) for u in edges for v in other_edges]
    units, numbers, distances = [], [], []
    for place, vector in enumerate((*edges, *other_edges, *away)):
        square = ca.sumsqr(vector)
        unit = ca.if_else(ca.dot(vector, between) < 0.0, -vector, vector) / ca.sqrt(square + SHORT)
        of_other = len(edges) <= place < len(edges) + len(other_edges)
        own, others = (
            (ca.SX.zeros(3), other.axes.T @ unit) if of_other else (one.axes.T @ unit, ca.SX.zeros(3))
        )
        units.append(unit)
        numbers.append(ca.vertcat(1.0, own, others, 0.0))
        distances.append(ca.if_else(square > 4.0 * SHORT, one.apart(other, unit), -np.inf))
    given = ca.SX.sym("directions", 3 * len(units))
    along = [one.apart(other, given[3 * place : 3 * place + 3]) for place in range(len(units))]
    columns = [ca.densify(ca.vertcat(*each)) for each in (units, numbers, distances)]
    functions = (
        ca.Function("ways", [pair], columns, {"cse": True}),
        ca.Function("apart", [pair, given], [ca.vertcat(*along)], {"cse": True}),
    )
    ways, apart = (BufferedFunction(compiled_function(each)) for each in functions)
    return ways, apart


def _shortest(one: PlacedShape, other: PlacedShape) -> Expression:
    """From the one's box to the other's, by going to and fro."""
    from_one, from_other = one.centre, other.centre
    for _ in range(STEPS):
        from_one = _nearest_in_box(one, from_other)
        from_other = _nearest_in_box(other, from_one)
    return from_other - from_one


def _nearest_in_box(shape: PlacedShape, point: Expression) -> Expression:
    nearest = shape.centre
    for side in ca.horzsplit(shape.axes @ shape.box):
        square = ca.sumsqr(side)
        share = ca.if_else(square > 0.0, ca.dot(point - shape.centre, side) / (square + SHORT), 0.0)
        nearest += ca.fmin(ca.fmax(share, -1.0), 1.0) * side
    return nearest
