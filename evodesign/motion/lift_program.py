"""The program of a lift: splines and wrenches over K knots, for any design and any heights and times.

Beyond 300 lines: the program, its starts and the motions read from it share the order of the variables.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import msgspec
import numpy as np
import scipy
from numpy.typing import NDArray

from evodesign.motion.course import LiftCourse
from evodesign.motion.instant import KnotBlocks
from evodesign.motion.spline import RestingSpline
from evodesign.nlp.blocks import Repeated
from evodesign.nlp.method import Ending, MethodName, SolverOptions
from evodesign.nlp.optimality import NotDifferentiable
from evodesign.nlp.program import Start
from evodesign.nlp.repeated import RepeatedProgram
from evodesign.posture.assemble import Slot
from evodesign.posture.parting import ALMOST, Meetings
from evodesign.posture.results import AgentPosture
from evodesign.posture.seeking.budget import BUDGET
from evodesign.records import Lift
from evodesign.tasks.lift import LoadProfile

Array = NDArray[np.float64]

FARTHEST, LOWEST, HIGHEST = 3.0, 0.05, 3.0
"""How far from the load a foot may stand, and between which heights a load may be [m]."""

SHARES = (0.01, 10.0)
"""Of the asked-for time, between which the least one is looked for."""

TURN = 0.8
"""Sine of the angle by which rigid hands may be turned otherwise than in the start."""

TRIES, CLOSED, LONGEST_STEP = 60, 1e-9, 0.3
"""Of closing hands and feet: iterations, what counts as closed [m], largest change [rad]."""


@dataclass(frozen=True, slots=True, eq=False)
class LiftStart:
    """Where a solve begins.

    Args:
        symbols: of the program.
        hands: how rigid hands are turned in it, entries of rotations; none for other grasps.
        open_by: by how much hands or feet are out of place at the worst knot [m].
        directions: that part bodies (`posture.terms.collisions`), at knots and half-way between in turn,
            shape (2 knots - 1, numbers); of no rows where none are parted.
    """

    symbols: Array
    hands: Array
    open_by: float
    directions: Array = field(default_factory=lambda: np.empty((0, 0)))

    @property
    def parts_bodies(self) -> bool:
        """Whether a solve from here needs the rows that part bodies."""
        return len(self.directions) > 0


class LiftProgram:
    """Lifts of so many knots in a setting.

    The variables are, one after the other: posture coefficients, knot after knot; coefficients of the load's
    height; torques and wrenches, knot after knot; the places of the soles; where the least time is looked for
    (`KnotBlocks.timed`), that as a share of the lift's.

    Args:
        blocks: what is said at a knot and between.
        knots: their number.
        options: of the solver.
    """

    def __init__(self, blocks: KnotBlocks, knots: int, options: SolverOptions) -> None:
        self._blocks, self._knots, self._options = blocks, knots, options
        self._postures = int(blocks.free.sum())
        self._others = sum(len(v.lower) for v in blocks.symbols.others)
        self._soles, self._grips = len(blocks.symbols.places), len(blocks.symbols.grips)
        self._places = 3 * (self._soles + self._grips)
        self._times = int(blocks.timed)
        sizes = [knots * self._postures, knots, knots * self._others, self._places, self._times]
        ends = np.cumsum([0, *sizes])
        self._first = dict(zip(("postures", "load", "others", "places", "time"), ends.tolist(), strict=False))
        self._size = int(ends[-1])

    @cached_property
    def _parts(self) -> list[Repeated]:
        spline, at = RestingSpline(self._knots), np.arange(float(self._knots))
        value, moved, bent = (spline.image(at, order) for order in range(3))
        knots = self._stacked(
            [(value, "postures"), (moved, "postures"), (bent, "postures"), (value, "load"), (bent, "load")],
            carried=True,
        )
        half_way = spline.image(at[:-1] + 0.5)
        quick = [(np.diff(np.eye(self._knots), axis=0), "postures")] * self._times
        between = self._stacked([(half_way, "postures"), *quick, (half_way, "load")], carried=False)
        return [
            Repeated(self._blocks.knot, knots, self._knots),
            Repeated(self._blocks.between, between, self._knots - 1),
        ]

    @cached_property
    def _program(self) -> RepeatedProgram:
        return RepeatedProgram("lift", self._parts, self._options)

    def _stacked(self, splines: Sequence[tuple[Array, str]], *, carried: bool) -> scipy.sparse.csc_matrix:
        """What blocks see: splines, torques and wrenches, places; one repetition after the other."""
        rows = []
        for number in range(len(splines[0][0])):
            for image, kind in splines:
                width = self._postures if kind == "postures" else 1
                rows.append(
                    self._at(kind, scipy.sparse.kron(image[number : number + 1], scipy.sparse.eye(width)))
                )
            if carried:
                rows.append(self._at("others", scipy.sparse.eye(self._others), number * self._others))
            rows.append(self._at("places", scipy.sparse.eye(self._places)))
            rows.append(self._at("time", scipy.sparse.eye(self._times)))
        return scipy.sparse.vstack(rows).tocsc()

    def _at(self, kind: str, image: scipy.sparse.spmatrix, further: int = 0) -> scipy.sparse.spmatrix:
        """An image of some variables as one of all."""
        found = scipy.sparse.coo_matrix(image)
        columns = found.col + self._first[kind] + further
        return scipy.sparse.coo_matrix((found.data, (found.row, columns)), (found.shape[0], self._size))

    @property
    def method(self) -> MethodName:
        """Who solves."""
        return self._program.method

    @cached_property
    def parted(self) -> LiftProgram | None:
        """The same with rows that part bodies along directions; None where no bodies are parted."""
        blocks = self._blocks.parted
        return None if blocks is None else LiftProgram(blocks, self._knots, self._options)

    def _with_rows_of(self, start: LiftStart) -> LiftProgram:
        """The program that has the rows which a start needs: most need none."""
        return self.parted if start.parts_bodies and self.parted is not None else self

    def solve(
        self,
        lift: Lift,
        start: LiftStart,
        design: Sequence[float],
        mass: float,
        inertia: float = 1.0,
        *,
        briefly: bool = False,
    ) -> tuple[Ending, float]:
        """Solve from a start; gives its end and the wall time [s].

        Args:
            lift: with as many knots.
            start: symbols.
            design: one number per parameter.
            mass: of the load [kg].
            inertia: share of it that counts; 0 for a motion that is infinitely slow.
            briefly: whether a solve that takes long is given up.
        """
        shared = self._shared(design, lift, mass, inertia, start.hands)
        (low, high), program = self._bounds(lift), self._with_rows_of(start)
        own = program._own(start)
        options, most = self._options, BUDGET.brief_lifts if briefly else self._options.iterations
        options = replace(options, iterations=min(most, options.iterations))
        return program._program.solve(np.clip(start.symbols, low, high), (low, high), shared, own, options)

    def exact(
        self, lift: Lift, start: LiftStart, ending: Ending, design: Sequence[float], mass: float
    ) -> Ending | NotDifferentiable:
        """A solve's end made so exact that it can be differentiated; arguments as in `slopes`."""
        shared = self._shared(design, lift, mass, 1.0, start.hands)
        program, bounds = self._with_rows_of(start), self._bounds(lift)
        return program._program.exact(ending, bounds, shared, program._own(start))

    def slopes(
        self, lift: Lift, start: LiftStart, ending: Ending, design: Sequence[float], mass: float
    ) -> Array | NotDifferentiable:
        """Derivatives of a solve's symbols by the design's parameters, shape (symbols, parameters).

        Args:
            lift: with as many knots.
            start: where the solve began.
            ending: of the solve, made exact.
            design: one number per parameter.
            mass: of the load [kg].
        """
        shared = self._shared(design, lift, mass, 1.0, start.hands)
        program, bounds = self._with_rows_of(start), self._bounds(lift)
        return program._program.slopes(ending, bounds, shared, program._own(start), len(design))

    def _shared(
        self, design: Sequence[float], lift: Lift, mass: float, inertia: float, hands: Array
    ) -> Array:
        """The numbers that all blocks share, in the order of `KnotBlocks.shared`."""
        return np.array([*design, lift.step, mass, inertia, *self._blocks.person, *hands])

    def _own(self, start: LiftStart) -> list[Array]:
        """What each knot has for itself: its weight in the cost, by the trapezoidal rule, and directions."""
        weights = np.full((self._knots, 1), 1.0 / (self._knots - 1))
        weights[[0, -1]] /= 2.0
        directions = np.empty((2 * self._knots - 1, 0))
        if self._blocks.directions and start.parts_bodies:
            directions = start.directions
        return [np.hstack([weights, directions[::2]]), directions[1::2]]

    @property
    def meetings(self) -> tuple[Meetings, Meetings]:
        """Of a program with rows that part bodies, at a knot and half-way between two."""
        return self._blocks.meetings

    @property
    def no_directions(self) -> Array:
        """Of such a program, with all rows along directions off."""
        return np.zeros((2 * self._knots - 1, self._blocks.directions))

    def crosses_planes(self, moments: Sequence[Sequence[Array]]) -> bool:
        """Whether bodies are too near to floor, partner or middle plane.

        Args:
            moments: as `meetings_at` has them, of a program with rows that part bodies.
        """
        found = [np.asarray(self._blocks.beyond_planes(*at)) for at in moments]
        return max((float(each.max(initial=-np.inf)) for each in found), default=-np.inf) > ALMOST

    def meetings_at(
        self, lift: Lift, start: LiftStart, symbols: Array, design: Sequence[float], mass: float
    ) -> list[list[Array]]:
        """What the meetings' functions take (`KnotBlocks.meetings`), at knots and half-way between in turn.

        Args:
            lift: with as many knots.
            start: with directions.
            symbols: of a solve.
            design: one number per parameter.
            mass: of the load [kg].
        """
        places = np.arange(2.0 * self._knots - 1.0) / 2.0
        image = RestingSpline(self._knots).image(places)
        postures, load = self._splines(symbols)
        shared = self._shared(design, lift, mass, 1.0, start.hands)
        along = zip(image @ postures, image @ load, start.directions, strict=True)
        return [[posture, np.array([height]), held, shared] for posture, height, held in along]

    def rows_at(self, rows: Array) -> list[Array]:
        """Numbers of all rows, such as multipliers, by knots and half-way between in turn."""
        ends = [part.block.rows.numel() for part in self._parts]
        at_knots, between = np.split(rows, [self._knots * ends[0]])
        found: list[Array] = [*at_knots.reshape(self._knots, -1)]
        for place, half_way in enumerate(between.reshape(self._knots - 1, -1)):
            found.insert(2 * place + 1, half_way)
        return found

    def _bounds(self, lift: Lift) -> tuple[Array, Array]:
        """Of the symbols: those of a hold, and the load's height."""
        seen, free = self._blocks.symbols, self._blocks.free
        sides = []
        for sign, moving, others in (
            (-1.0, [v.lower / v.scale for v in seen.moving], [v.lower / v.scale for v in seen.others]),
            (1.0, [v.upper / v.scale for v in seen.moving], [v.upper / v.scale for v in seen.others]),
        ):
            height = RestingSpline(self._knots).through(np.array(lift.knot_heights))
            if lift.profile is LoadProfile.FREE:
                height = self._free_heights(lift, sign)
            soles = [sign * FARTHEST, sign * FARTHEST, sign] * self._soles
            places = np.array(soles + [sign * TURN] * 3 * self._grips)
            postures = np.tile(np.concatenate(moving)[free], self._knots)
            carried = np.tile(np.concatenate(others), self._knots)
            time = [SHARES[int(sign > 0.0)]] * self._times
            sides.append(np.concatenate([postures, height, carried, places, time]))
        return sides[0], sides[1]

    def _free_heights(self, lift: Lift, sign: float) -> Array:
        """A load that goes as it likes between its ends: there its first two coefficients are the end's."""
        far = max if sign > 0.0 else min
        heights = np.full(self._knots, far(lift.from_m, lift.to_m))
        heights[:2], heights[-2:] = lift.from_m, lift.to_m
        return heights

    def followed(
        self,
        lift: Lift,
        postures: Mapping[str, AgentPosture],
        begin: int,
        design: Sequence[float],
        disturbed: Mapping[str, Mapping[str, AgentPosture]] | None = None,
    ) -> LiftStart:
        """A start: a hold's posture, followed along the lift with the feet in place, by least-norm steps.

        Args:
            lift: with as many knots.
            postures: of the hold, by agent name.
            begin: the knot at whose height it is, the first or the last.
            design: one number per parameter.
            disturbed: what is carried in the hold under each disturbance; where nothing is said, what is
                carried without.
        """
        seen, free = self._blocks.symbols, self._blocks.free
        parts = self._parts_of(postures)
        moving = np.concatenate([self._known(parts, v) for v in seen.moving])[free]
        others = self._carried_by(postures, disturbed or {}, design)
        closure, path = self._blocks.closure, np.empty((self._knots, self._postures))
        order = range(self._knots) if begin == 0 else range(self._knots - 1, -1, -1)
        hands = np.asarray(self._blocks.hands(moving, design)).ravel()
        shared = self._shared(design, lift, 0.0, 0.0, hands)  # of which a place does not ask the rest
        places, worst = self._places_of(moving, lift.knot_heights[begin], shared), 0.0
        for knot in order:
            moving, open_by = self._closed(closure, moving, lift.knot_heights[knot], places, shared)
            path[knot], worst = moving, max(worst, open_by)
        coefficients = RestingSpline(self._knots).through(path)
        load = RestingSpline(self._knots).through(np.array(lift.knot_heights))
        symbols = [coefficients.ravel(), load, np.tile(others, self._knots), places, np.ones(self._times)]
        return LiftStart(np.concatenate(symbols), hands, worst)

    def refined(self, lift: Lift, course: LiftCourse, start: LiftStart) -> LiftStart:
        """A start: a motion of other knots, at this program's.

        Args:
            lift: with as many knots.
            course: the motion.
            start: where its solve ended, with its knots, and with its time where that is looked for.
        """
        seen, free = self._blocks.symbols, self._blocks.free
        times = msgspec.structs.replace(course.lift, knots=self._knots).knot_times
        moving = self._sampled(course.postures(times), seen.moving)[:, free]
        begin, knots = course.lift.knots * (self._postures + 1), course.lift.knots
        carried = start.symbols[begin : begin + knots * self._others].reshape(knots, -1)
        others = scipy.interpolate.CubicSpline(course.lift.knot_times, carried)(times)
        spline = RestingSpline(self._knots)
        symbols = [
            spline.through(moving).ravel(),
            spline.through(course.heights(times)),
            others.ravel(),
            start.symbols[len(start.symbols) - self._places - self._times :],
        ]
        directions = start.directions
        if start.parts_bodies:
            shares = np.linspace(0.0, len(directions) - 1.0, 2 * self._knots - 1)
            directions = directions[np.rint(shares).astype(int)]
        return LiftStart(np.concatenate(symbols), start.hands, start.open_by, directions)

    def motion_of(self, party: str, start: LiftStart) -> Start:
        """An agent's own motion, for others to begin at: by name of variable, SI units, knot after knot."""
        found = {name: scale * start.symbols[places] for name, (places, scale) in self._own_of(party).items()}
        return {**found, **{name: start.hands[places] for name, places in self._hands_of(party).items()}}

    def beside(self, start: LiftStart, motion: Start) -> LiftStart:
        """A start in which an agent moves as in another one, of any number of knots; others as they did.

        Args:
            start: to be changed.
            motion: as `motion_of` gives it; of no variable: nothing changes.
        """
        symbols, hands = start.symbols.copy(), start.hands.copy()
        for party in (form.agent.name for form in self._blocks.forms):
            for name, (places, scale) in self._own_of(party).items():
                if name in motion:
                    symbols[places] = self._at_knots(name, motion[name], len(places)) / scale
            for name, places in self._hands_of(party).items():
                if name in motion:
                    hands[places] = motion[name]
        return LiftStart(symbols, hands, start.open_by)

    def _at_knots(self, name: str, values: Sequence[float], count: int) -> Array:
        """A motion's numbers at this program's knots; coefficients of splines by way of their values."""
        found = np.asarray(values, float)
        if len(found) == count:
            return found
        rows = count // self._knots
        own = found.reshape(-1, rows)
        given, wanted = np.linspace(0.0, 1.0, len(own)), np.linspace(0.0, 1.0, self._knots)
        if name in {v.name for v in self._blocks.symbols.moving}:
            at_knots = RestingSpline(len(own)).image(wanted * (len(own) - 1)) @ own
            return RestingSpline(self._knots).through(at_knots).ravel()
        return np.column_stack([np.interp(wanted, given, column) for column in own.T]).ravel()

    def _own_of(self, party: str) -> dict[str, tuple[NDArray[np.intp], float]]:
        """Which symbols are an agent's, and their unit, by name of variable, sole or grip."""
        seen, found = self._blocks.symbols, dict[str, tuple[NDArray[np.intp], float]]()
        free = np.cumsum(self._blocks.free) - 1
        knots, first = np.arange(self._knots)[:, None], 0
        for variable in seen.moving:
            rows = np.arange(first, first + len(variable.lower))
            first += len(variable.lower)
            own = free[rows[self._blocks.free[rows]]]
            if variable.key.party == party:  # type: ignore[attr-defined]
                found[variable.name] = (knots * self._postures + own).ravel(), variable.scale
        first = 0
        for variable in seen.others:
            rows = np.arange(first, first + len(variable.lower))
            first += len(variable.lower)
            if isinstance(variable.key, Slot) and variable.key.party == party:
                places = self._first["others"] + knots * self._others + rows
                found[variable.name] = places.ravel(), variable.scale
        names = [(who, f"{who}.{foot.name}_place") for who, foot in seen.places]
        names += [(who, f"{who}.{hand.name}_grip") for who, hand in seen.grips]
        for number, (who, name) in enumerate(names):
            if who == party:
                found[name] = self._first["places"] + 3 * number + np.arange(3), 1.0
        return found

    def _hands_of(self, party: str) -> dict[str, NDArray[np.intp]]:
        """Where the turns of an agent's rigid hands stand among those of a start, by name."""
        keys = [*self._blocks.symbols.grips]
        return {
            f"{who}.{hand.name}_turn": 9 * number + np.arange(9)
            for number, (who, hand) in enumerate(keys)
            if who == party
        }

    def timed(self, start: LiftStart) -> LiftStart:
        """A start: one of as many knots that knows its time."""
        return replace(start, symbols=np.append(start.symbols, np.ones(self._times)))

    @staticmethod
    def _sampled(values: Mapping[str, Mapping[str, Array]], variables: Sequence[Any]) -> Array:
        """Symbols of variables over time, shape (times, symbols)."""
        columns = [values[v.key.party][v.key.part][:, : len(v.lower)] / v.scale for v in variables]
        return np.hstack(columns)

    def _parts_of(self, postures: Mapping[str, AgentPosture]) -> dict[str, dict[str, Array]]:
        """What the forms' variables are, by agent and part."""
        return {form.agent.name: form.parts(postures[form.agent.name]) for form in self._blocks.forms}

    def _carried_by(
        self,
        postures: Mapping[str, AgentPosture],
        disturbed: Mapping[str, Mapping[str, AgentPosture]],
        design: Sequence[float],
    ) -> Array:
        """Symbols of torques and wrenches of a hold in every load case, and of the worst one's cost."""
        load_cases = [postures, *(disturbed.get(name, postures) for name in self._blocks.disturbances)]
        parts, worst = [self._parts_of(each) for each in load_cases], self._blocks.worst
        others = np.concatenate(
            [
                self._known(parts[v.key.load_case], v) if isinstance(v.key, Slot) else v.start / v.scale
                for v in self._blocks.symbols.others
            ]
        )
        if worst is not None:
            others[-1] = float(worst(others, design))
        return others

    @staticmethod
    def _known(parts: Mapping[str, Mapping[str, Array]], variable: object) -> Array:
        key, size, scale = variable.key, len(variable.lower), variable.scale  # type: ignore[attr-defined]
        return np.asarray(parts[key.party][key.part][:size] / scale)

    def _places_of(self, moving: Array, height: float, shared: Array) -> Array:
        """Where the soles of a posture are: what they are off from nowhere."""
        nowhere = np.zeros(self._places)
        found = np.asarray(self._blocks.closure(moving, height, nowhere, shared)[0]).ravel()
        return np.concatenate([found[self._sole_rows], np.zeros(3 * self._grips)])

    @cached_property
    def _sole_rows(self) -> Array:
        """Which rows of the closure are x, y and the turn of soles: after the hands of each agent."""
        rows: list[int] = []
        first = 0
        for form in self._blocks.forms:
            first += 3 * len(form.hands)
            for _ in form.feet:
                rows += [first, first + 1, first + 5]
                first += 6
            first += 3 * len(form.hands) if self._grips else 0
        return np.array(rows)

    def _closed(
        self, closure: object, moving: Array, height: float, places: Array, shared: Array
    ) -> tuple[Array, float]:
        """The posture near another one whose hands and feet are in place, within its bounds."""
        seen, free = self._blocks.symbols, self._blocks.free
        low = np.concatenate([v.lower / v.scale for v in seen.moving])[free]
        high = np.concatenate([v.upper / v.scale for v in seen.moving])[free]
        moving = np.clip(moving, low, high)
        for _ in range(TRIES):
            open_by, jacobian = (np.asarray(each) for each in closure(moving, height, places, shared))  # type: ignore[operator]
            open_by = open_by.ravel()
            if np.abs(open_by).max() < CLOSED:
                break
            change = _bounded_step(jacobian, open_by, moving <= low, moving >= high)
            change *= min(1.0, LONGEST_STEP / max(1e-12, float(np.abs(change).max())))
            moving = np.clip(moving + change, low, high)
        return moving, float(np.abs(open_by).max())

    def course(self, lift: Lift, symbols: Array) -> LiftCourse:
        """The motion that symbols stand for, SI units."""
        seen, knots = self._blocks.symbols, self._knots
        others = symbols[self._first["others"] : self._first["places"]]
        postures, load = self._splines(symbols)
        share = float(symbols[self._first["time"]]) if self._times else 1.0
        return LiftCourse(
            lift=msgspec.structs.replace(lift, seconds=share * lift.seconds),
            forms=self._blocks.forms,
            coefficients=self._by_agent(seen.moving, postures),
            carried=self._by_agent(seen.others, others.reshape(knots, -1)),
            load=load,
            disturbed={
                name: self._by_agent(seen.others, others.reshape(knots, -1), load_case)
                for load_case, name in enumerate(self._blocks.disturbances, 1)
            },
            abrupt=self._blocks.timed,
        )

    def _splines(self, symbols: Array) -> tuple[Array, Array]:
        """Coefficients of all posture symbols, shape (knots, symbols), and of the load's height [m]."""
        seen, free = self._blocks.symbols, self._blocks.free
        still = np.concatenate([v.lower / v.scale for v in seen.moving])
        postures = np.tile(still, (self._knots, 1))
        postures[:, free] = symbols[: self._first["load"]].reshape(self._knots, -1)
        return postures, symbols[self._first["load"] : self._first["others"]]

    def _by_agent(
        self, variables: Sequence[object], columns: Array, load_case: int = 0
    ) -> dict[str, dict[str, Array]]:
        """Columns of symbols of a load case as values by agent and part."""
        found: dict[str, dict[str, Array]] = {form.agent.name: {} for form in self._blocks.forms}
        first = 0
        for variable in variables:
            key, scale, size = variable.key, variable.scale, len(variable.lower)  # type: ignore[attr-defined]
            if isinstance(key, Slot) and key.load_case == load_case:
                found[key.party][key.part] = scale * columns[:, first : first + size]
            first += size
        return found


def _bounded_step(
    jacobian: Array, open_by: Array, at_low: NDArray[np.bool_], at_high: NDArray[np.bool_]
) -> Array:
    """The smallest change that closes, of those that do not leave bounds which are met."""
    free = np.ones(jacobian.shape[1], bool)
    for _ in range(4):
        own = jacobian[:, free]
        damped = own @ own.T + 1e-8 * np.eye(len(open_by))
        change = np.zeros(len(free))
        change[free] = -own.T @ np.linalg.solve(damped, open_by)
        leaving = free & ((at_low & (change < 0.0)) | (at_high & (change > 0.0)))
        if not leaving.any():
            break
        free &= ~leaving
    return change
