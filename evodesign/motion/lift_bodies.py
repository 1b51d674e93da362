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
from evodesign.nlp.solver import status_of
from evodesign.posture.parting import Meetings
from evodesign.posture.seeking.budget import BUDGET
from evodesign.posture.seeking.settling import UNSETTLED, Switched
from evodesign.posture.terms.collisions import NUMBERS
from evodesign.records import Lift, Status

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


class PartedLift(Switched[LiftSolve, LiftStart]):
    """Solves of one lift of one design that go on until no bodies overlap that rows can part.

    Args:
        program: with the lift's knots.
        lift: what is asked for.
        design: one number per parameter.
        mass: of the load [kg].
    """

    def __init__(self, program: LiftProgram, lift: Lift, design: Sequence[float], mass: float) -> None:
        self._program, self._lift, self._design, self._mass = program, lift, design, mass
        self._parted = program.parted or program

    def settled(self, first: LiftSolve) -> LiftSolve:
        """A solve with the rows on that it violates; as it is where it violates none."""
        if self._program.parted is None:
            return first
        return self.bettered(self.parted(first), BUDGET.part_lifts_better)

    def is_solved(self, solve: LiftSolve, /) -> bool:
        """Whether there is a motion."""
        return solve.solved

    def cost(self, solve: LiftSolve, /) -> float:
        """Of its last iterate."""
        return solve.ending.cost

    def has_rows(self, solve: LiftSolve, /) -> bool:
        """Whether rows are on."""
        return solve.start.parts_bodies

    def began_with_rows(self, solve: LiftSolve, /) -> bool:
        """Likewise: a start keeps the rows that are on."""
        return solve.start.parts_bodies

    def violated(self, solve: LiftSolve, /) -> LiftStart | None:
        """A start that parts bodies that overlap; None where none do that can be parted."""
        on = self._changed(solve.start, solve.ending.symbols, Meetings.violated)
        return self._off_planes(solve) if on is None else on

    def further(self, solve: LiftSolve, rows: LiftStart, /, *, near: bool = False) -> LiftSolve:
        """The solve that goes on with the rows of a start, wherever it ends."""
        return self._solved_from(solve, solve.ending.symbols, rows)

    def anew(self, first: LiftSolve, _: LiftSolve, /) -> LiftSolve:
        """The solve that begins where the first one began, with all bodies parted."""
        on = self._changed(first.start, first.start.symbols, Meetings.begun)
        return self._solved_from(first, first.start.symbols, first.start if on is None else on)

    def better(self, solve: LiftSolve, least: float, /) -> LiftStart | None:
        """A start that parts pairs along better directions; None where they gain little."""
        multipliers, gains = iter(self._parted.rows_at(solve.ending.rows)), list[float]()

        def better(meetings: Meetings, at: Sequence[Array], held: Array) -> Chosen:
            found, gain = meetings.better(at, held, meetings.prices(next(multipliers)))
            gains.append(gain)
            return found

        on = self._changed(solve.start, solve.ending.symbols, better)
        return None if sum(gains) <= least else on

    def unsettled(self, solve: LiftSolve, /) -> LiftSolve:
        """A solve as one that failed."""
        return replace(solve, ending=replace(solve.ending, word=UNSETTLED))

    def _off_planes(self, solve: LiftSolve) -> LiftStart | None:
        """A start with the rows of planes; None where it has them already, or no plane is crossed."""
        parted = self._parted
        start = replace(solve.start, directions=parted.no_directions)
        moments = parted.meetings_at(self._lift, start, solve.ending.symbols, self._design, self._mass)
        return start if not solve.start.parts_bodies and parted.crosses_planes(moments) else None

    def _solved_from(self, before: LiftSolve, symbols: Array, start: LiftStart) -> LiftSolve:
        """The solve that goes on from symbols with the directions of a start, with the work of both."""
        begun = replace(start, symbols=symbols)
        ending, seconds = self._program.solve(self._lift, begun, self._design, self._mass)
        whole = replace(ending, iterations=ending.iterations + before.ending.iterations)
        return LiftSolve(start, whole, seconds + before.seconds)

    def _changed(
        self,
        start: LiftStart,
        symbols: Array,
        chosen: Callable[[Meetings, Sequence[Array], Array], Chosen],
    ) -> LiftStart | None:
        """A start with directions that are chosen at knots and half-way between; None where none are new."""
        parted = self._parted
        if not start.parts_bodies:
            start = replace(start, directions=parted.no_directions)
        directions, new = start.directions.copy(), False
        moments = parted.meetings_at(self._lift, start, symbols, self._design, self._mass)
        for number, at in enumerate(moments):
            held = directions[number].reshape(-1, NUMBERS)
            for place, numbers in chosen(parted.meetings[number % 2], at, held).items():
                held[place], new = numbers, True
        return replace(start, directions=directions) if new else None
