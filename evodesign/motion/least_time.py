"""The least time of a lift: its program with the time among the variables, begun at the lift that was found.

    minimise    T / T_asked  +  LITTLE x what the lift costs in T
    subject to  all that holds of a lift

Heights depend on the share of the time, so the profile is the asked-for one, faster. Joints are within their
speed everywhere and not at knots alone. The least cost, in seconds, is the value: the time of the motion and
what its torques add, some thousandths of it where torques are limited. Its derivative by the design is that
of an optimal cost, from the multipliers.

The result is checked as any lift is, with torques and wrenches that are linear between knots
(`motion.course`), and found with twice the knots where the check asks for it or a solve fails.

Source: Bobrow, Dubowsky and Gibson 1985, Time-optimal control of robotic manipulators along specified paths
(the problem, along a fixed path); Fiacco 1983, ch. 2 (derivative of an optimal cost).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import msgspec
import numpy as np
from numpy.typing import NDArray

from evodesign.motion.course import LiftCourse
from evodesign.motion.instant import KnotBlocks
from evodesign.motion.lift_bodies import LiftSolve, PartedLift
from evodesign.motion.lift_check import CheckedLift, LiftChecker
from evodesign.motion.lift_program import LiftProgram, LiftStart
from evodesign.nlp.method import Ending, SolverOptions
from evodesign.nlp.solver import status_of
from evodesign.posture.results import Attempt
from evodesign.records import Lift, Status

Array = NDArray[np.float64]

TOLERANCE = 1e-10
"""Of the scaled optimality error. With 1e-8, four iterations fewer, derivatives are off by some 1e-4."""

MOST_KNOTS = 96
"""With which the least time is looked for; a lift that was found with half of them or less has twice its own,
or four times."""

ITERATIONS, SECONDS = 500, 60.0
"""Of a solve, which goes far from where it begins: limits of iterations and of wall time [s]."""


@dataclass(frozen=True, slots=True, eq=False)
class LeastTime:
    """The least time of a lift, or why it is not known.

    Args:
        lift: whose least time it is, with the knots that it took.
        status: solved, or why not.
        reason: a sentence.
        attempts: every solve.
        seconds: the least cost [s], nearly all of which is the motion's time; not a number unless solved.
        slope: its derivative by each of the design's parameters; empty unless solved.
        course: the motion, with its time; None unless solved.
        checked: what the independent check found; None unless solved.
        start: the motion as symbols, its share of the asked-for time last; None unless solved.
    """

    lift: Lift
    status: Status
    reason: str
    attempts: tuple[Attempt, ...]
    seconds: float = float("nan")
    slope: Array = field(default_factory=lambda: np.empty(0))
    course: LiftCourse | None = None
    checked: CheckedLift | None = None
    start: LiftStart | None = None


class LeastTimes:
    """Least times of lifts of any design.

    Args:
        blocks: of lifts whose time is a variable.
        options: of the solver.
        mass: of the load [kg].
    """

    def __init__(self, blocks: KnotBlocks, options: SolverOptions, mass: float) -> None:
        self._blocks, self._mass = blocks, mass
        self._options = replace(
            options, tolerance=TOLERANCE, iterations=ITERATIONS, seconds=max(SECONDS, options.seconds)
        )
        self._programs: dict[int, LiftProgram] = {}

    def solve(self, design: Sequence[float], lift: Lift, start: LiftStart, checker: LiftChecker) -> LeastTime:
        """The least time of a lift that was found.

        Args:
            design: one number per design parameter.
            lift: with the knots that it took.
            start: its motion.
            checker: of the design's lifts.
        """
        program, attempts = self._program(lift.knots), list[Attempt]()
        start = program.timed(start)
        while True:
            begun = LiftSolve(start, *program.solve(lift, start, design, self._mass))
            solve = PartedLift(program, lift, design, self._mass).settled(begun)
            ending, start = solve.ending, solve.start
            attempts.append(_attempt(lift, ending, solve.seconds, program))
            solved = attempts[-1].status is Status.SOLVED
            reached = replace(start, symbols=ending.symbols) if solved else start
            course = program.course(lift, reached.symbols)
            checked = checker.check(course)
            if solved and not checked.wrong:
                break
            finer = msgspec.structs.replace(lift, knots=2 * lift.knots)
            if finer.knots > MOST_KNOTS:
                status = Status.NUMERICAL_FAILURE if solved else attempts[-1].status
                return _none(lift, status, checked.wrong if solved else ending.word, attempts)
            lift, program = finer, self._program(finer.knots)
            start = program.refined(finer, course, reached)
        return LeastTime(
            lift=lift,
            status=Status.SOLVED,
            reason="solved",
            attempts=tuple(attempts),
            seconds=lift.seconds * ending.cost,
            slope=lift.seconds * ending.cost_slope[: len(design)],
            course=course,
            checked=checked,
            start=reached,
        )

    def _program(self, knots: int) -> LiftProgram:
        if knots not in self._programs:
            self._programs[knots] = LiftProgram(self._blocks, knots, self._options)
        return self._programs[knots]


def _attempt(lift: Lift, ending: Ending, seconds: float, program: LiftProgram) -> Attempt:
    return Attempt(
        formulation="least time",
        start=f"motion of {lift.knots} knots",
        status=status_of(ending.word),
        reason=ending.word,
        iterations=ending.iterations,
        seconds=seconds,
        cost=ending.cost,
        method=program.method,
    )


def _none(lift: Lift, status: Status, why: str, attempts: Sequence[Attempt]) -> LeastTime:
    return LeastTime(lift, status, f"the least time of {lift} was not found: {why}", tuple(attempts))
