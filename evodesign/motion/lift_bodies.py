"""Motions in which bodies keep clear of each other: rows along directions, where a solve found overlaps.

Rows that part bodies (`posture.terms.collisions`, `posture.parting`) are left out at first, those of floor,
partner and middle plane too. If bodies overlap at a knot or half-way between two, the solve goes on in the
program that has the rows, with a direction of its own for each pair at each of these moments: that which
parts it best there. If the motion that comes of it is held by a row that another direction would loosen, that
one takes its place.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from evodesign.motion.lift_program import LiftProgram, LiftStart
from evodesign.nlp.method import Ending
from evodesign.nlp.solver import ROUNDS, UNSETTLED, status_of
from evodesign.posture.parting import Meetings
from evodesign.posture.terms.collisions import NUMBERS
from evodesign.records import Lift, Status

GAIN = 1e-4
"""Share of its cost by which a motion must get better to be solved again."""

Array = NDArray[np.float64]
Chosen = dict[int, Array]


@dataclass(frozen=True, slots=True, eq=False)
class LiftSolve:
    """A solve of a lift.

    Args:
        start: where it began.
        ending: of the solve; iterations are those of all solves that led to it.
        seconds: wall time of them [s].
    """

    start: LiftStart
    ending: Ending
    seconds: float

    @property
    def solved(self) -> bool:
        """Whether there is a motion."""
        return status_of(self.ending.word) is Status.SOLVED


class PartedLift:
    """Solves of one lift of one design that go on until no bodies overlap that rows can part.

    Args:
        program: with the lift's knots.
        lift: what is asked for.
        design: one number per parameter.
        mass: of the load [kg].
    """

    def __init__(self, program: LiftProgram, lift: Lift, design: Sequence[float], mass: float) -> None:
        self._program, self._lift, self._design, self._mass = program, lift, design, mass

    def settled(self, first: LiftSolve) -> LiftSolve:
        """A solve with the rows on that it violates; as it is where it violates none.

        Where going on from it leads nowhere, the solve begins anew with all rows on.
        """
        parted = self._program.parted
        if parted is None or not first.solved:
            return first
        found = self._without_overlaps(parted, first)
        if not found.solved and not first.start.parts_bodies:
            on = self._changed(parted, first.start, first.start.symbols, Meetings.begun)
            begun = self._solved_from(first, first.start.symbols, first.start if on is None else on)
            found = self._without_overlaps(parted, begun)
        return self._bettered(parted, found) if found.start.parts_bodies else found

    def _without_overlaps(self, parted: LiftProgram, solve: LiftSolve) -> LiftSolve:
        """Rows are switched on until no pair overlaps that has one."""
        for _ in range(ROUNDS):
            if not solve.solved:
                return solve
            on = self._changed(parted, solve.start, solve.ending.symbols, Meetings.violated)
            on = self._off_planes(parted, solve) if on is None else on
            if on is None:
                return solve
            solve = self._solved_from(solve, solve.ending.symbols, on)
        return replace(solve, ending=replace(solve.ending, word=UNSETTLED)) if solve.solved else solve

    def _off_planes(self, parted: LiftProgram, solve: LiftSolve) -> LiftStart | None:
        """A start with the rows of planes; None where it has them already, or no plane is crossed."""
        start = replace(solve.start, directions=parted.no_directions)
        moments = parted.meetings_at(self._lift, start, solve.ending.symbols, self._design, self._mass)
        return start if not solve.start.parts_bodies and parted.crosses_planes(moments) else None

    def _bettered(self, parted: LiftProgram, solve: LiftSolve) -> LiftSolve:
        """Pairs that rows hold in touch are parted along better directions, as long as the motion gains."""
        for _ in range(ROUNDS):
            if not solve.solved:
                break
            least = GAIN * abs(solve.ending.cost)
            on = self._better_directions(parted, solve, least)
            if on is None:
                break
            other = self._without_overlaps(parted, self._solved_from(solve, solve.ending.symbols, on))
            if not (other.solved and other.ending.cost < solve.ending.cost - least):
                break
            solve = other
        return solve

    def _better_directions(self, parted: LiftProgram, solve: LiftSolve, least: float) -> LiftStart | None:
        """A start with better directions; None where they gain less than the least that counts, if any."""
        multipliers, gains = iter(parted.rows_at(solve.ending.rows)), list[float]()

        def better(meetings: Meetings, at: Sequence[Array], held: Array) -> Chosen:
            found, gain = meetings.better(at, held, meetings.prices(next(multipliers)))
            gains.append(gain)
            return found

        on = self._changed(parted, solve.start, solve.ending.symbols, better)
        return on if sum(gains) > least else None

    def _solved_from(self, before: LiftSolve, symbols: Array, start: LiftStart) -> LiftSolve:
        """The solve that goes on from symbols with the directions of a start, with the work of both."""
        begun = replace(start, symbols=symbols)
        ending, seconds = self._program.solve(self._lift, begun, self._design, self._mass)
        whole = replace(ending, iterations=ending.iterations + before.ending.iterations)
        return LiftSolve(start, whole, seconds + before.seconds)

    def _changed(
        self,
        parted: LiftProgram,
        start: LiftStart,
        symbols: Array,
        chosen: Callable[[Meetings, Sequence[Array], Array], Chosen],
    ) -> LiftStart | None:
        """A start with directions that are chosen at knots and half-way between; None where none are new.

        Args:
            parted: the program with all rows.
            start: with the directions until now.
            symbols: of the motion.
            chosen: new numbers by meeting, from the meetings, their functions' arguments and numbers now.
        """
        if not start.parts_bodies:
            start = replace(start, directions=parted.no_directions)
        directions, new = start.directions.copy(), False
        moments = parted.meetings_at(self._lift, start, symbols, self._design, self._mass)
        for number, at in enumerate(moments):
            held = directions[number].reshape(-1, NUMBERS)
            for place, numbers in chosen(parted.meetings[number % 2], at, held).items():
                held[place], new = numbers, True
        return replace(start, directions=directions) if new else None
