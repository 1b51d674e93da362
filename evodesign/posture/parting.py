"""Which bodies of a solution overlap, and along which directions they are parted: see `terms.collisions`.

The distance of two convex bodies is the largest of n . (c_2 - c_1) - s_1(n) - s_2(-n) over unit vectors n. It
is looked for among the directions that part boxes and cylinders: normals of faces, products of edges and
axes, and the shortest way between them (the separating axis theorem for boxes; for the others a little less
than the distance may be found, so that rows may be switched on that are not needed, never the reverse).

Source: separating axes: Gottschalk, Lin and Manocha, OBBTree (1996).
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from evodesign.nlp.program import Program, Start
from evodesign.posture.terms.base import Body
from evodesign.posture.terms.collisions import (
    NUMBERS,
    PARTING,
    ROUNDING,
    PlacedShape,
    directed,
    parted_by,
    placed_pairs,
)

__all__ = ["Parted", "PartedBody", "parted", "parted_along"]

Array = NDArray[np.float64]
Places = NDArray[np.intp]

ALMOST = 1e-6
"""How much less than the margin [m] is no overlap."""

TOUCHING, BETTER = 1e-4, 5e-4
"""Up to how far beyond the margin [m] bodies count as in touch, and by how much farther [m] another direction
must part them to take the place of theirs."""

DIFFERENT = 0.7
"""Cosine between two directions that are different ways to part bodies."""

TINY = 1e-18
"""Keeps a vector of no length [m^2] from being divided by."""

STEPS = 8
"""From body to body, on the shortest way between them."""

SHAPE = 36
"""Numbers of a placed shape: centre, box, disc, ball, axes."""


@dataclass(frozen=True, slots=True)
class PartedBody:
    """An agent's body at an instant of a program.

    Args:
        name: of the parameters that say what parts it.
        body: its expressions.
    """

    name: str
    body: Body


def parted(bodies: tuple[PartedBody, ...], program: Callable[[], Program]) -> Parted | None:
    """The switches of a program; None where no bodies are parted.

    Args:
        bodies: of every instant.
        program: builds the one with all rows.
    """
    return Parted(bodies, program) if bodies else None


class Parted:
    """The rows that part bodies, and are left out of a program until some overlap."""

    def __init__(self, bodies: tuple[PartedBody, ...], program: Callable[[], Program]) -> None:
        self._bodies, self._program = bodies, program

    @property
    def names(self) -> Collection[str]:
        """Of the parameters that say which rows are on."""
        return [each.name for each in self._bodies]

    @cached_property
    def program(self) -> Program:
        """With all rows."""
        return self._program()

    def begun(self, values: Start, given: Mapping[str, Any]) -> Start:
        """What parts all bodies best at some values."""

        def looked_at(seen: _Screened) -> NDArray[np.bool_]:
            return np.ones(len(seen.margins), bool)

        def wanted(pairs: Array, margin: float, along: float) -> Array:
            return parted_along(pairs, np.inf)[0].numbers

        return self._changed(values, given, looked_at, wanted)

    def violated(self, values: Start, given: Mapping[str, Any], short: float = 0.0, rank: int = 0) -> Start:
        """What parts bodies that overlap, beside those that are parted already; none where none overlap."""

        def looked_at(seen: _Screened) -> NDArray[np.bool_]:
            return np.asarray(~seen.on & (seen.least < seen.margins + short))

        def wanted(pairs: Array, margin: float, along: float) -> Array | None:
            ways = parted_along(pairs, margin + short)
            if not ways or ways[0].distance >= margin + short - ALMOST:
                return None
            return ways[min(rank, len(ways) - 1)].numbers

        return self._changed(values, given, looked_at, wanted)

    def better(self, values: Start, given: Mapping[str, Any]) -> Start:
        """What parts bodies farther that a row holds in touch; none where every row has the best way."""

        def looked_at(seen: _Screened) -> NDArray[np.bool_]:
            return np.asarray(seen.on & (seen.along <= seen.margins + TOUCHING))

        def wanted(pairs: Array, margin: float, along: float) -> Array | None:
            way = parted_along(pairs, np.inf)[0]
            return way.numbers if way.distance > along + BETTER else None

        return self._changed(values, given, looked_at, wanted)

    def _changed(
        self,
        values: Start,
        given: Mapping[str, Any],
        looked_at: Callable[[_Screened], NDArray[np.bool_]],
        wanted: Callable[[Array, float, float], Array | None],
    ) -> Start:
        """The parameters with new numbers for some meetings; without those of bodies for which none are new.

        Args:
            values: of a solution or a start.
            given: the other parameters.
            looked_at: which meetings may get new numbers.
            wanted: new numbers for one of them, from its pairs, its margin [m], and how far it is apart along
                its direction [m]; or None.
        """
        program, meetings = self.program, self._meetings
        held = program.held(values)
        numbers = program.packed(values), program.packed_parameters(given, values)
        columns = [held[each.name].reshape(-1, NUMBERS) for each in self._bodies]
        least, along = (np.asarray(column).ravel() for column in meetings.screen(*numbers))
        on = np.concatenate(columns)[:, 0] != 0.0
        seen = _Screened(np.asarray(on), meetings.least(least), meetings.least(along), meetings.margins)
        places = np.flatnonzero(looked_at(seen)).tolist()
        if not places:
            return {}
        pairs = np.asarray(meetings.shapes(*numbers)).T.reshape(-1, 2, SHAPE)
        ends = np.cumsum([0, *(len(column) for column in columns)])
        found: dict[str, Array] = {}
        for place in places:
            new = wanted(pairs[meetings.places == place], meetings.margins[place], seen.along[place])
            if new is not None:
                body = int(np.searchsorted(ends, place, side="right")) - 1
                name, first = self._bodies[body].name, NUMBERS * (place - int(ends[body]))
                found.setdefault(name, np.array(held[name], float))[first : first + NUMBERS] = new
        return found

    @cached_property
    def _meetings(self) -> _Meetings:
        """Of the program with all rows."""
        program = self.program
        switches = program.switches
        bodies = switches._bodies if isinstance(switches, Parted) else ()
        pairs: list[tuple[PlacedShape, PlacedShape]] = []
        directions: list[Any] = []
        places: list[int] = []
        margins: list[float] = []
        for each in bodies:
            rules = each.body.agent.collisions
            for number, meeting in enumerate(directed(each.body.form)):
                own = placed_pairs(each.body, meeting)
                held = each.body.values[PARTING][NUMBERS * number : NUMBERS * (number + 1)]
                pairs += own
                directions += [parted_by(held, *own[0])] * len(own)
                places += [len(margins)] * len(own)
                margins.append(rules.margin if rules else 0.0)
        least = [_least_apart(*pair) for pair in pairs]
        along = [_apart_along(direction, *pair) for direction, pair in zip(directions, pairs, strict=True)]
        given = [program.symbols, program.given]
        shapes = [ca.vertcat(one.numbers, other.numbers) for one, other in pairs]
        return _Meetings(
            ca.Function("screen", given, [ca.vertcat(*least), ca.vertcat(*along)], {"cse": True}),
            ca.Function("shapes", given, [ca.densify(ca.horzcat(*shapes))], {"cse": True}),
            np.array(places, np.intp),
            np.array(margins),
        )


@dataclass(frozen=True, slots=True, eq=False)
class _Meetings:
    """Functions of all meetings of a program.

    Args:
        screen: how far each pair of shapes is apart at least, and along its meeting's direction [m].
        shapes: numbers of each pair.
        places: the meeting of each pair.
        margins: of each meeting [m].
    """

    screen: Any
    shapes: Any
    places: Places
    margins: Array

    def least(self, distances: Array) -> Array:
        """The least of each meeting's pairs [m]."""
        found = np.full(len(self.margins), np.inf)
        np.minimum.at(found, self.places, distances)
        return found


@dataclass(frozen=True, slots=True, eq=False)
class _Screened:
    """Meetings at a point: whether rows are on; how far apart at least, and along directions [m]."""

    on: NDArray[np.bool_]
    least: Array
    along: Array
    margins: Array


def _least_apart(one: PlacedShape, other: PlacedShape) -> Any:
    """How far two shapes are apart at least [m]: along the line of centres, sides and axes."""
    between = other.centre - one.centre
    vectors = [between, *one.sides, *other.sides]
    found = None
    for vector in vectors:
        unit = vector / ca.sqrt(ca.sumsqr(vector) + TINY)
        apart = ca.fabs(ca.dot(unit, between)) - one.support(unit) - other.support(unit)
        found = apart if found is None else ca.fmax(found, apart)
    return found


def _apart_along(direction: Any, one: PlacedShape, other: PlacedShape) -> Any:
    """How far two shapes are apart along a unit vector [m]."""
    return ca.dot(direction, other.centre - one.centre) - one.support(direction) - other.support(direction)


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
