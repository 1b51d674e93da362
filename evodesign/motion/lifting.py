"""Lifts of any design of a scene: found from its holds at both ends and checked, or told why there is none.

Solves begin at the hold at either end, followed along the lift with the feet in place, so that a result
depends on problem and design alone; the cheaper one counts. Holds of several heights joined together do not
do for a start: their elbows bend in different ways.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import msgspec
import numpy as np
from numpy.typing import NDArray

from evodesign.motion.check import CheckedLift, LiftChecker, fine_times
from evodesign.motion.course import LiftCourse
from evodesign.motion.derivative import LiftDerivative
from evodesign.motion.instant import KnotBlocks
from evodesign.motion.least_time import LeastTimes
from evodesign.motion.program import LiftProgram, LiftStart
from evodesign.motion.solution import AgentEffort, LiftSolution, MotionCase
from evodesign.nlp.method import Ending, MethodName, SolverOptions
from evodesign.nlp.optimality import NotDifferentiable
from evodesign.nlp.solver import status_of
from evodesign.posture.check import AgentModel, Checker
from evodesign.posture.formulations.base import Setting
from evodesign.posture.results import Attempt, CaseSolution
from evodesign.posture.symmetry import Form, symmetric_forms, whole
from evodesign.records import Lift, Status, worst_status

__all__ = ["LiftProblem"]

Array = NDArray[np.float64]

REFINEMENTS = 2
"""How often the knots are doubled until the check accepts a motion between them."""

OPEN = 1e-3
"""By how much [m] hands and feet of a start may be out of place."""


@dataclass(frozen=True, slots=True, eq=False)
class _Motion:
    """A motion that a solve found, for another one to begin at.

    Args:
        lift: with its knots.
        start: its symbols.
        ending: of the solve.
        attempts: every start tried until then.
    """

    lift: Lift
    start: LiftStart
    ending: Ending
    attempts: tuple[Attempt, ...]


class LiftProblem:
    """Lifts of any design of a scene.

    Args:
        setting: of the scene.
        symmetric: whether halves of robot and person are looked for.
        timed: whether the least time of every lift is looked for, too.
    Attributes:
        timed: likewise.
    """

    def __init__(self, setting: Setting, *, symmetric: bool, timed: bool = False) -> None:
        self._setting, self._symmetric, self.timed = setting, symmetric, timed
        self._scene = setting.scene.undisturbed
        self._programs: dict[int, LiftProgram] = {}

    @cached_property
    def _blocks(self) -> KnotBlocks:
        return KnotBlocks(self._forms, self._setting)

    @property
    def _forms(self) -> tuple[Form, Form]:
        scene = self._scene
        return symmetric_forms(scene) if self._symmetric else (whole(scene.robot), whole(scene.human))

    @cached_property
    def _least(self) -> LeastTimes:
        blocks = KnotBlocks(self._forms, self._setting, timed=True)
        return LeastTimes(blocks, self._options, self._scene.payload.mass)

    def solve(
        self,
        design: Sequence[float],
        lift: Lift,
        holds: Sequence[CaseSolution],
        robot: AgentModel,
        human: AgentModel,
        *,
        slowly: bool = True,
    ) -> LiftSolution:
        """The best checked motion of a design; where the check finds it too coarse, with more knots.

        Args:
            design: one number per design parameter.
            lift: what is asked for.
            holds: the design's posture at the beginning and at the end.
            robot: the design's, for the check.
            human: the person's.
            slowly: whether the same lift is found infinitely slowly, too.
        """
        ends = dict(zip(("beginning", "end"), holds, strict=True))
        for name, posture in ends.items():
            if not posture.solved:
                where = f"the load cannot be held at the {name} of the lift"
                return LiftSolution(lift, posture.status, f"{where}: {posture.reason}")
        checker = LiftChecker(self._scene, robot, human, Checker(self._scene, robot, human))
        program, mass = self._program(lift.knots), self._scene.payload.mass
        begins = {"beginning": 0, "end": lift.knots - 1}
        starts = {
            name: program.followed(lift, ends[name].postures, knot, design) for name, knot in begins.items()
        }
        solves = [(name, *program.solve(lift, start, design, mass)) for name, start in starts.items()]
        attempts = tuple(
            _attempt(f"hold at the {name}", ending, seconds, program.method)
            for name, ending, seconds in solves
        )
        solved = [end for end in solves if status_of(end[1].word) is Status.SOLVED]
        if not solved:
            return self._none(design, lift, list(starts.values()), attempts)
        name, best, _ = min(solved, key=lambda end: end[1].cost)
        start = replace(starts[name], symbols=best.symbols)
        return self._checked(design, _Motion(lift, start, best, attempts), checker, slowly=slowly)

    def derivative(self, design: Sequence[float], solution: MotionCase) -> LiftDerivative | NotDifferentiable:
        """How the motion of a case moves with the design, with as many knots as it has.

        Args:
            design: one number per design parameter.
            solution: of the same design.
        """
        found, task = solution.motion, solution.case.task
        if found is None or found.start is None or found.ending is None or not isinstance(task, Lift):
            return NotDifferentiable("there is no motion")
        lift, program, mass = found.lift, self._program(found.lift.knots), self._scene.payload.mass
        ending = program.exact(lift, found.start, found.ending, design, mass)
        if isinstance(ending, NotDifferentiable):
            return ending
        slopes = program.slopes(lift, found.start, ending, design, mass)
        if isinstance(slopes, NotDifferentiable):
            return slopes
        return LiftDerivative(
            instants_of=lambda symbols: program.course(lift, symbols).instants(task.result_times),
            symbols=ending.symbols,
            slopes=slopes,
            cost=ending.cost,
            cost_slope=ending.cost_slope[: len(design)],
            least_slope=None if found.least is None else found.least.slope,
        )

    def _checked(
        self, design: Sequence[float], motion: _Motion, checker: LiftChecker, *, slowly: bool
    ) -> LiftSolution:
        """A motion that the check accepts, with more knots where it has to; or what it found."""
        mass = self._scene.payload.mass
        for further in range(REFINEMENTS, -1, -1):
            lift, program = motion.lift, self._program(motion.lift.knots)
            course = program.course(lift, motion.ending.symbols)
            checked = checker.check(course)
            if not (checked.wrong and further):
                break
            finer = msgspec.structs.replace(lift, knots=2 * lift.knots)
            start = self._program(finer.knots).refined(finer, course, motion.start)
            ending, seconds = self._program(finer.knots).solve(finer, start, design, mass)
            attempt = _attempt(f"motion of {lift.knots} knots", ending, seconds, program.method)
            attempts = (*motion.attempts, attempt)
            if attempt.status is not Status.SOLVED:
                return self._none(design, finer, [start], attempts)
            motion = _Motion(finer, replace(start, symbols=ending.symbols), ending, attempts)
        if checked.wrong:
            return LiftSolution(lift, Status.NUMERICAL_FAILURE, checked.wrong, motion.attempts)
        least = self._least.solve(design, lift, motion.start, checker) if self.timed else None
        if least is not None and least.status is not Status.SOLVED:
            return LiftSolution(lift, least.status, least.reason, (*motion.attempts, *least.attempts))
        slow = program.solve(lift, motion.start, design, mass, 0.0)[0] if slowly else None
        return LiftSolution(
            lift=lift,
            status=Status.SOLVED,
            reason="solved",
            attempts=motion.attempts,
            course=course,
            checked=checked,
            efforts=_efforts(course, checked, slow, program),
            start=motion.start,
            ending=motion.ending,
            least=least,
        )

    def _none(
        self,
        design: Sequence[float],
        lift: Lift,
        starts: Sequence[LiftStart],
        attempts: tuple[Attempt, ...],
    ) -> LiftSolution:
        """Why no start led to a motion: the way, the time, or limits that no motion meets."""
        program, mass = self._program(lift.knots), self._scene.payload.mass
        status = worst_status([each.status for each in attempts if each.status is not Status.SOLVED])
        open_by = min(start.open_by for start in starts)
        slow = [program.solve(lift, start, design, mass, 0.0)[0] for start in starts]
        if any(status_of(ending.word) is Status.SOLVED for ending in slow):
            reason = (
                f"{lift} is too fast: the same motion is found where nothing has inertia or a limit of speed"
            )
        elif open_by > OPEN:
            reason = f"{lift} passes a height out of reach: hands or feet are {open_by:.3f} m off on the way"
        else:
            reason = f"no motion {lift} was found that meets all limits, however slow"
        return LiftSolution(lift, status, reason, attempts)

    def _program(self, knots: int) -> LiftProgram:
        if knots not in self._programs:
            self._programs[knots] = LiftProgram(self._blocks, knots, self._options)
        return self._programs[knots]

    @property
    def _options(self) -> SolverOptions:
        return replace(self._setting.options, tolerance=TOLERANCE_OF_LIFTS)


TOLERANCE_OF_LIFTS = 1e-7
"""Of the scaled optimality error: a lift's program is some ten times as large as a hold's."""


def _attempt(name: str, ending: Ending, seconds: float, method: MethodName) -> Attempt:
    return Attempt(
        formulation="lift",
        start=name,
        status=status_of(ending.word),
        reason=ending.word,
        iterations=ending.iterations,
        seconds=seconds,
        cost=ending.cost,
        method=method,
    )


def _efforts(
    course: LiftCourse, checked: CheckedLift, slow: Ending | None, program: LiftProgram
) -> dict[str, AgentEffort]:
    times = fine_times(course)
    instants = course.instants(times)
    slowly = None
    if slow is not None and status_of(slow.word) is Status.SOLVED:
        slowly = program.course(course.lift, slow.symbols).instants(times)
    return {
        name: AgentEffort(
            torques=np.array([instant.postures[name].torque_norm for instant in instants]),
            slow_torques=None
            if slowly is None
            else float(np.trapezoid([i.postures[name].torque_norm for i in slowly])) / (len(times) - 1),
            power=checked.powers[name],
            work=work,
        )
        for name, work in checked.work.items()
    }
