"""Which bodies of a solution overlap, and along which directions they are parted: see `terms.collisions`.

Beyond 300 lines: rows, screening and directions of the same pairs share their order.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from evodesign.collision.rules import BodyPair
from evodesign.nlp.buffered import BufferedFunction
from evodesign.nlp.codegen import compiled_function
from evodesign.nlp.program import ConstraintBlock, Program, Start
from evodesign.nlp.solver import has_any
from evodesign.posture.placed_shape import SHAPE, PlacedShape
from evodesign.posture.separating_axes import Ways, ways_of
from evodesign.posture.terms.base import Body
from evodesign.posture.terms.collisions import (
    NUMBERS,
    OFF,
    directed,
    margin_of,
    meeting_of,
    placed_pairs,
)

Array = NDArray[np.float64]
Places = NDArray[np.intp]

Overlaps = Mapping[tuple[str, BodyPair], float]
"""How deep bodies are in each other [m], by agent and pair."""

ALMOST = 1e-6
"""How much less than the margin [m] is no overlap."""

TOUCHING, BETTER = 1e-4, 5e-4
"""Up to how far beyond the margin [m] bodies count as in touch, and by how much farther [m] another direction
must part them to take the place of theirs."""

TINY = 1e-18
"""Keeps a vector of no length [m^2] from being divided by."""


@dataclass(frozen=True, slots=True)
class PartedBody:
    """An agent's body at an instant of a program.

    Args:
        name: of the parameters that say what parts it.
        rows: name of the rows that keep its bodies apart along directions.
        body: its expressions.
    """

    name: str
    rows: str
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

    def names_of(self, agent: str) -> Collection[str]:
        """Those of one agent's bodies."""
        return [each.name for each in self._bodies if each.body.form.agent.name == agent]

    @cached_property
    def program(self) -> Program:
        """With all rows; to its own switches it is that, too."""
        program = self._program()
        if isinstance(program.switches, Parted):
            program.switches._program = lambda: program
        return program

    @property
    def off(self) -> float:
        """What a row is that is off [m]."""
        return OFF

    def rows_of(self, program: Program) -> list[tuple[int, int]]:
        """Rows along directions, with the places of what says whether they are on."""
        on = [
            program.columns[each.name].start + NUMBERS * number
            for each in self._bodies
            for number, meeting in enumerate(directed(each.body.form))
            for _ in placed_pairs(each.body, meeting)
        ]
        return [*zip(rows_of(self._bodies, program.constraints).tolist(), on, strict=True)]

    def begun(self, values: Start, given: Mapping[str, Any], alike: Start | None = None) -> Start:
        """What parts all bodies best at some values, or those that other values part."""
        numbers, held = self._at(values, given)
        places = None if alike is None else np.flatnonzero(self._held(alike)[:, 0])
        return self._named(held, self._meetings.begun(numbers, held, places))

    def violated(self, values: Start, given: Mapping[str, Any], short: float = 0.0) -> Start:
        """What parts bodies that overlap, beside those that are parted already; none where none overlap."""
        numbers, held = self._at(values, given)
        return self._named(held, self._meetings.violated(numbers, held, short))

    def wider(self, values: Start, given: Mapping[str, Any], overlaps: Sequence[Overlaps]) -> Start:
        """What parts bodies that the check finds in each other; none where they have no rows.

        Args:
            values: of a solution.
            given: the other parameters.
            overlaps: of the true bodies at each instant, by agent and pair how deep [m].
        """
        numbers, held = self._at(values, given)
        deep: dict[int, float] = {}
        of = Counter[str]()
        for each, first in zip(self._bodies, self._ends.tolist(), strict=False):
            form = each.body.form
            agent, places = form.agent.name, {meeting: at for at, meeting in enumerate(directed(form), first)}
            for (name, pair), depth in overlaps[of[agent]].items():
                place = places.get(meeting_of(form, pair)) if name == agent else None
                if place is not None:
                    deep[place] = max(depth, deep.get(place, 0.0))
            of[agent] += 1
        return self._named(held, self._meetings.wider(numbers, held, deep))

    def needed(self, values: Start, multipliers: Array, price: float) -> Start:
        """What parts bodies that a row holds in touch, at a price per metre; nothing for all others."""
        held = self._held(values)
        costly = self._meetings.prices(multipliers) > price
        return self._named(held, {place: np.zeros(NUMBERS) for place in np.flatnonzero(~costly).tolist()})

    def better(self, values: Start, given: Mapping[str, Any], multipliers: Array, gain: float) -> Start:
        """What parts bodies farther that a row holds in touch; none where that gains less than asked for."""
        if not has_any(self.names, values):
            return {}
        numbers, held = self._at(values, given)
        found, gained = self._meetings.better(numbers, held, self._meetings.prices(multipliers))
        return self._named(held, found) if gained > gain else {}

    def _at(self, values: Start, given: Mapping[str, Any]) -> tuple[tuple[Array, Array], Array]:
        """Symbols and parameters of the program with all rows, and the numbers of each meeting."""
        program = self.program
        return (program.packed(values), program.packed_parameters(given, values)), self._held(values)

    def _held(self, values: Start) -> Array:
        """The numbers of each meeting."""
        held = self.program.held(values)
        return np.concatenate([held[each.name].reshape(-1, NUMBERS) for each in self._bodies])

    def _named(self, held: Array, found: Mapping[int, Array]) -> Start:
        """The parameters with new numbers for some meetings, without those of bodies that have none."""
        named: dict[str, Array] = {}
        for place, new in found.items():
            body = int(np.searchsorted(self._ends, place, side="right")) - 1
            begin, end = self._ends[body : body + 2].tolist()
            own = named.setdefault(self._bodies[body].name, np.array(held[begin:end], float).ravel())
            own[NUMBERS * (place - begin) : NUMBERS * (place - begin + 1)] = new
        return named

    @cached_property
    def _ends(self) -> Places:
        """Where each body's meetings begin among all, and where the last one's end."""
        return np.cumsum([0, *(len(directed(each.body.form)) for each in self._bodies)])

    @cached_property
    def _meetings(self) -> Meetings:
        """Of the program with all rows, whose own switches have them."""
        program = self.program
        switches = program.switches
        if isinstance(switches, Parted) and switches is not self:
            return switches._meetings
        return meetings_of(self._bodies, program.constraints, [program.symbols, program.given])


@dataclass(frozen=True, slots=True, eq=False)
class Meetings:
    """Functions of all meetings of some bodies, and which directions part them.

    Args:
        shapes: numbers of each pair of shapes.
        screen: how far the two of each pair are apart at least, and along a meeting's direction [m]: from the
            numbers of all pairs, and those that part each.
        places: the meeting of each pair.
        starts: the first pair of each meeting.
        rows: the row of each pair in its program.
        margins: of each meeting [m].
    """

    shapes: BufferedFunction
    screen: BufferedFunction
    places: Places
    starts: Places
    rows: Places
    margins: Array

    def begun(self, at: Sequence[Array], held: Array, places: Places | None = None) -> dict[int, Array]:
        """What parts all bodies best, or those of some meetings.

        Args:
            at: the functions' arguments.
            held: numbers that say what parts each meeting, shape (meetings, NUMBERS).
            places: of the meetings.
        Returns:
            New numbers by the meeting's place.
        """
        wanted = np.zeros(len(held), bool)
        wanted[slice(None) if places is None else places] = True
        return self._changed(at, held, lambda _: wanted, lambda own, *_: own.best)

    def violated(self, at: Sequence[Array], held: Array, short: float = 0.0) -> dict[int, Array]:
        """What parts bodies that overlap, beside those that are parted already; likewise."""

        def looked_at(seen: _Screened) -> NDArray[np.bool_]:
            return np.asarray(~seen.on & (seen.least < seen.margins + short))

        def wanted(ways: Ways, place: int, along: float) -> Array | None:
            return ways.best if ways.distance < self.margins[place] + short - ALMOST else None

        return self._changed(at, held, looked_at, wanted)

    def wider(self, at: Sequence[Array], held: Array, deep: Mapping[int, float]) -> dict[int, Array]:
        """What parts bodies that are in each other although their shapes are apart.

        Args:
            at: the functions' arguments.
            held: numbers of each meeting.
            deep: how deep the bodies of some meetings are in each other [m], by place.
        """
        if not deep:
            return {}
        pairs = self._pairs(at)
        along, found = self._screened(pairs, held).along, dict[int, Array]()
        for place, depth in deep.items():
            numbers, apart = held[place].copy(), float(along[place])
            if not numbers[0]:
                (ways,) = ways_of([pairs[self.places == place]])
                numbers, apart = ways.best.copy(), ways.distance
            numbers[-1] = apart + depth - self.margins[place]
            found[place] = numbers
        return found

    def better(self, at: Sequence[Array], held: Array, prices: Array) -> tuple[dict[int, Array], float]:
        """What parts bodies farther that a row holds in touch, and what that gains to first order.

        Args:
            at: the functions' arguments.
            held: numbers of each meeting.
            prices: of each meeting, as `prices` has them.
        """
        gains: list[float] = []

        def looked_at(seen: _Screened) -> NDArray[np.bool_]:
            return np.asarray(seen.on & (prices > 0.0) & (seen.along <= seen.margins + TOUCHING))

        def wanted(ways: Ways, place: int, along: float) -> Array | None:
            farther = ways.distance - along
            if farther < BETTER:
                return None
            gains.append(farther * float(prices[place]))
            return ways.best

        return self._changed(at, held, looked_at, wanted), sum(gains)

    def _changed(
        self,
        at: Sequence[Array],
        held: Array,
        looked_at: Callable[[_Screened], NDArray[np.bool_]],
        wanted: Callable[[Ways, int, float], Array | None],
    ) -> dict[int, Array]:
        """New numbers for some meetings, by their places.

        Args:
            at: the functions' arguments.
            held: numbers of each meeting.
            looked_at: which meetings may get new numbers.
            wanted: new numbers for one of them, from the ways to part it, its place, and how far it is apart
                along its direction [m]; or None.
        """
        if not len(self.margins):
            return {}
        pairs = self._pairs(at)
        seen = self._screened(pairs, held)
        places = np.flatnonzero(looked_at(seen)).tolist()
        if not places:
            return {}
        ways = ways_of([pairs[self.places == place] for place in places])
        found = {
            place: wanted(own, place, seen.along[place]) for place, own in zip(places, ways, strict=True)
        }
        return {place: new for place, new in found.items() if new is not None}

    def _pairs(self, at: Sequence[Array]) -> Array:
        """The numbers of each pair of shapes, shape (pairs, 2, SHAPE)."""
        return self.shapes(*at)[0].reshape(-1, 2, SHAPE)

    def _screened(self, pairs: Array, held: Array) -> _Screened:
        """The meetings at a point: the nearest pair of each."""
        distances = self.screen(pairs.ravel(), held[self.places].ravel())
        least, along = (np.minimum.reduceat(each, self.starts) for each in distances)
        return _Screened(np.asarray(held[:, 0] != 0.0), least, along, self.margins)

    def prices(self, multipliers: Array) -> Array:
        """What each meeting's pairs cost together, per metre, from the multipliers of a program's rows."""
        return np.asarray(np.bincount(self.places, -multipliers[self.rows], len(self.margins)), float)


def meetings_of(
    bodies: Sequence[PartedBody], constraints: Sequence[ConstraintBlock], arguments: Sequence[Any]
) -> Meetings:
    """The meetings of bodies whose rows along directions are there.

    Args:
        bodies: with the numbers that part them among their values.
        constraints: of the program, one after the other.
        arguments: columns of symbols that everything follows from.
    """
    pairs: list[tuple[PlacedShape, PlacedShape]] = []
    places: list[int] = []
    margins: list[float] = []
    for each in bodies:
        for meeting in directed(each.body.form):
            own = placed_pairs(each.body, meeting)
            pairs += own
            places += [len(margins)] * len(own)
            margins.append(margin_of(each.body.form, meeting))
    numbers = [ca.vertcat(one.numbers, other.numbers) for one, other in pairs]
    column = ca.densify(ca.horzcat(ca.SX(2 * SHAPE, 0), *numbers))
    return Meetings(
        BufferedFunction(ca.Function("shapes", list(arguments), [column], {"cse": True})),
        BufferedFunction(_screen().map(max(len(pairs), 1))),
        np.array(places, np.intp),
        np.searchsorted(places, np.arange(len(margins))),
        rows_of(bodies, constraints),
        np.array(margins),
    )


def rows_of(bodies: Sequence[PartedBody], constraints: Sequence[ConstraintBlock]) -> Places:
    """Which rows of a program keep bodies apart along directions, body after body."""
    ends = np.cumsum([0, *(block.expression.numel() for block in constraints)]).tolist()
    places = {block.name: range(*ends[at : at + 2]) for at, block in enumerate(constraints)}
    return np.array([row for each in bodies for row in places[each.rows]], np.intp)


@dataclass(frozen=True, slots=True, eq=False)
class _Screened:
    """Meetings at a point: whether rows are on; how far apart at least, and along directions [m]."""

    on: NDArray[np.bool_]
    least: Array
    along: Array
    margins: Array


@cache
def _screen() -> Any:
    """Of two shapes' numbers, and those that part them: how far they are apart at least, and so parted [m].

    At least they are as far apart as along the line of centres, sides and axes.
    """
    pair, numbers = ca.SX.sym("pair", 2 * SHAPE), ca.SX.sym("parted", NUMBERS)
    one, other = (PlacedShape.of(pair[half * SHAPE : (half + 1) * SHAPE]) for half in range(2))
    between, least = other.centre - one.centre, -ca.inf
    for vector in (between, *one.sides, *other.sides):
        square = ca.sumsqr(vector)
        unit = vector / ca.sqrt(square + TINY)
        apart = ca.fabs(ca.dot(unit, between)) - one.support(unit) - other.support(unit)
        least = ca.fmax(least, ca.if_else(square > 4.0 * TINY, apart, -ca.inf))
    along = one.apart_along(other, numbers)
    return compiled_function(ca.Function("screen", [pair, numbers], [least, along], {"cse": True}))
