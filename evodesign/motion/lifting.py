"""Lifts of any design of a scene: found from its holds at both ends and checked, or told why there is none.

Solves begin at the robot's holds, followed along the lift with the feet in place, beside persons whose
motions were found once for the problem, and at the hold of an end where none of these begins (`lift_starts`);
so a result depends on problem and design alone. The cheapest one counts. Holds of several heights joined
together do not do for a start: their elbows bend in different ways.

Beyond 300 lines: the steps from holds to a checked lift stand in the order in which they happen.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import msgspec
import numpy as np
from numpy.typing import NDArray

from evodesign.mechanics.agent import ROBOT
from evodesign.motion.course import LiftCourse
from evodesign.motion.derivative import LiftDerivative
from evodesign.motion.instant import KnotBlocks
from evodesign.motion.least_time import LeastTimes
from evodesign.motion.lift_bodies import LiftSolve, PartedLift
from evodesign.motion.lift_check import CheckedLift, LiftChecker, fine_times
from evodesign.motion.lift_program import LiftProgram, LiftStart
from evodesign.motion.solution import AgentEffort, LiftSolution, MotionCase
from evodesign.nlp.method import Ending, MethodName, SolverOptions
from evodesign.nlp.optimality import NotDifferentiable
from evodesign.nlp.program import Start
from evodesign.nlp.solver import status_of
from evodesign.posture.check import AgentModel, Checker
from evodesign.posture.formulations.base import Setting
from evodesign.posture.results import AgentPosture, Attempt, CaseSolution
from evodesign.posture.seeking.budget import BUDGET
from evodesign.posture.symmetry import forms_of
from evodesign.records import Lift, Status, worst_status

Array = NDArray[np.float64]

REFINEMENTS = 3
"""How often the knots are doubled until the check accepts a motion between them."""

MOVED = "robot.moved"
"""How a start moves the robot's hold: at the beginning (0) or the end (1), base [m], joints [rad]."""

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
        self._scene = setting.scene
        self._programs: dict[int, LiftProgram] = {}

    @cached_property
    def _blocks(self) -> KnotBlocks:
        return _blocks(self._setting, symmetric=self._symmetric)

    @cached_property
    def _least(self) -> LeastTimes:
        blocks = _blocks(self._setting, symmetric=self._symmetric, timed=True)
        return LeastTimes(blocks, _options(self._setting), self._scene.payload.mass)

    def solve(
        self,
        design: Sequence[float],
        lift: Lift,
        holds: Sequence[CaseSolution],
        robot: AgentModel,
        human: AgentModel,
        *,
        known: Sequence[Start] = (),
        slowly: bool = True,
    ) -> LiftSolution:
        """The best checked motion of a design; where the check finds it too coarse, with more knots.

        Args:
            design: one number per design parameter.
            lift: what is asked for.
            holds: the design's posture at the beginning and at the end.
            robot: the design's, for the check.
            human: the person's.
            known: starts of the lift beside its holds.
            slowly: whether the same lift is found infinitely slowly, too.
        """
        for name, posture in zip(("beginning", "end"), holds, strict=True):
            if not posture.solved:
                where = f"the load cannot be held at the {name} of the lift"
                return LiftSolution(lift, posture.status, f"{where}: {posture.reason}")
        checker = LiftChecker(self._scene, robot, human, Checker(self._scene, robot, human))
        program, mass = self._program(lift.knots), self._scene.payload.mass
        ends, disturbed = [hold.postures for hold in holds], [hold.disturbed for hold in holds]
        starts = lift_starts(program, lift, ends, design, (*known, {}), disturbed)
        solves = _ends(program, lift, starts, design, mass)
        parted = _without_overlaps(PartedLift(program, lift, design, mass), solves)
        attempts = tuple(
            _attempt(name, each.ending, each.seconds, program.method) for name, each in parted.items()
        )
        solved = [each for each in parted.values() if each.solved]
        if not solved:
            overlapping = [each for each in solves.values() if each.solved]
            if overlapping:
                course = program.course(lift, _cheapest(overlapping).ending.symbols)
                return _refused(lift, _in_the_way(checker.check(course)), attempts)
            return self._none(design, lift, list(starts.values()), attempts)
        best = _cheapest(solved)
        start = replace(best.start, symbols=best.ending.symbols)
        return self._checked(design, _Motion(lift, start, best.ending, attempts), checker, slowly=slowly)

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
            program = self._program(finer.knots)
            start = program.refined(finer, course, motion.start)
            solve = LiftSolve(start, *program.solve(finer, start, design, mass))
            found = PartedLift(program, finer, design, mass).settled(solve)
            ending = found.ending
            attempt = _attempt(f"motion of {lift.knots} knots", ending, found.seconds, program.method)
            attempts = (*motion.attempts, attempt)
            if attempt.status is not Status.SOLVED:
                if solve.solved:
                    course = program.course(finer, solve.ending.symbols)
                    return _refused(finer, _in_the_way(checker.check(course)), attempts)
                return self._none(design, finer, [start], attempts)
            motion = _Motion(finer, replace(found.start, symbols=ending.symbols), ending, attempts)
        if checked.wrong:
            return _refused(lift, checked.wrong, motion.attempts)
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
        if status is Status.TIME_LIMIT:
            within = f"`seconds` of [solver], {self._setting.options.seconds:g} s"
            return LiftSolution(lift, status, f"no motion {lift} was found within {within}", attempts)
        open_by = min(start.open_by for start in starts)
        slow = [program.solve(lift, start, design, mass, 0.0)[0] for start in starts]
        if any(status_of(ending.word) is Status.SOLVED for ending in slow):
            reason = (
                f"{lift} is too fast, wanted more `seconds`: a motion is found where nothing has inertia and "
                "joints have no limit of speed"
            )
        elif open_by > OPEN:
            off = f"hands or feet are {open_by:.3f} m off on the way"
            reason = f"{lift} passes a height out of reach from where the feet stand at its ends: {off}"
        else:
            reason = f"no motion {lift} was found that meets all limits, however slow"
        return LiftSolution(lift, status, reason, attempts)

    def _program(self, knots: int) -> LiftProgram:
        if knots not in self._programs:
            self._programs[knots] = LiftProgram(self._blocks, knots, _options(self._setting))
        return self._programs[knots]


def lift_starts(
    program: LiftProgram,
    lift: Lift,
    ends: Sequence[Mapping[str, AgentPosture]],
    design: Sequence[float],
    known: Sequence[Start],
    disturbed: Sequence[Mapping[str, Mapping[str, AgentPosture]]] = ({}, {}),
) -> dict[str, LiftStart]:
    """Where solves of a design's lift begin, by a name.

    A start has a motion of the person, or it is that of the hold. The robot follows the lift from its hold at
    either end; where the start moves it (`MOVED`), from that one, moved. The hold itself is a start at ends
    where no other one begins.

    Args:
        program: of the lift's knots.
        lift: it.
        ends: postures at the beginning and at the end, by agent name.
        design: one number per parameter.
        known: starts that serve any design.
        disturbed: what is carried at both ends under each disturbance, likewise.
    """
    knots, names = (0, lift.knots - 1), ("hold at the beginning", "hold at the end")
    followed = [
        program.followed(lift, each, knot, design, carried)
        for each, knot, carried in zip(ends, knots, disturbed, strict=True)
    ]
    begun_at = {
        int(start[MOVED][0]) if MOVED in start else place for start in known if start for place in (0, 1)
    }
    starts: dict[str, LiftStart] = {}
    for number, start in enumerate(known, 1):
        which = f", start {number}" if start else ""
        if MOVED in start:
            last, *change = start[MOVED]
            postures = {**ends[int(last)], ROBOT: moved_posture(ends[int(last)][ROBOT], np.array(change))}
            begun = program.followed(lift, postures, knots[int(last)], design, disturbed[int(last)])
            starts[f"{names[int(last)]}, moved{which}"] = program.beside(begun, start)
        else:
            for place, (name, begun) in enumerate(zip(names, followed, strict=True)):
                if start or place not in begun_at:
                    starts[name + which] = program.beside(begun, start)
    return starts


def moved_posture(posture: AgentPosture, change: Array) -> AgentPosture:
    """A posture whose base [m] and joints [rad] are moved, in this order."""
    joints = zip(posture.joints.items(), change[3:].tolist(), strict=True)
    return replace(
        posture,
        base_position=posture.base_position + change[:3],
        joints={name: angle + more for (name, angle), more in joints},
    )


def lift_program(setting: Setting, knots: int, *, symmetric: bool) -> LiftProgram:
    """Lifts of so many knots in a setting.

    Args:
        setting: of the scene.
        knots: their number.
        symmetric: whether halves of robot and person are looked for.
    """
    return LiftProgram(_blocks(setting, symmetric=symmetric), knots, _options(setting))


def _blocks(setting: Setting, *, symmetric: bool, timed: bool = False) -> KnotBlocks:
    scene = setting.scene
    return KnotBlocks(forms_of(scene, symmetric=symmetric), setting, timed=timed)


def _options(setting: Setting) -> SolverOptions:
    return replace(setting.options, tolerance=TOLERANCE_OF_LIFTS)


def _cheapest(solves: Sequence[LiftSolve]) -> LiftSolve:
    return min(solves, key=lambda each: each.ending.cost)


def _ends(
    program: LiftProgram, lift: Lift, starts: Mapping[str, LiftStart], design: Sequence[float], mass: float
) -> dict[str, LiftSolve]:
    """Where starts lead to; solves that take long are given up unless all of them do."""

    def solved(start: LiftStart, *, briefly: bool) -> LiftSolve:
        return LiftSolve(start, *program.solve(lift, start, design, mass, briefly=briefly))

    briefly = {name: solved(start, briefly=True) for name, start in starts.items()}
    if any(each.solved for each in briefly.values()):
        return briefly
    return {
        name: solved(each.start, briefly=False)
        if status_of(each.ending.word) is Status.ITERATION_LIMIT
        else each
        for name, each in briefly.items()
    }


def _without_overlaps(parting: PartedLift, solves: Mapping[str, LiftSolve]) -> dict[str, LiftSolve]:
    """Solves with bodies parted, but for those that even overlapping cost as much as another one parted.

    Of several solves that led to the same motion one is parted for all.
    """
    found, least, last = dict(solves), np.inf, ""
    for name, solve in sorted(solves.items(), key=lambda pair: pair[1].ending.cost):
        if not solve.solved or solve.ending.cost >= least:
            continue
        if last and solve.ending.cost <= solves[last].ending.cost * (1.0 + BUDGET.same):
            ending = replace(found[last].ending, iterations=solve.ending.iterations)
            found[name] = LiftSolve(found[last].start, ending, solve.seconds)
            continue
        found[name], last = parting.settled(solve), name
        least = min(least, found[name].ending.cost if found[name].solved else np.inf)
    return found


def _in_the_way(checked: CheckedLift) -> str:
    """Of a motion beside which there is none with bodies parted: what the check found."""
    found = checked.wrong or "bodies are nearer to each other than the margin"
    return f"no motion was found in which bodies keep clear of each other; where they need not, {found}"


def _refused(lift: Lift, wrong: str, attempts: tuple[Attempt, ...]) -> LiftSolution:
    """What the check refuses, with what it found."""
    return LiftSolution(lift, Status.NUMERICAL_FAILURE, wrong, attempts)


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
            disturbed={
                disturbance: np.array(
                    [instant.disturbed[disturbance][name].torque_norm for instant in instants]
                )
                for disturbance in course.disturbed
            },
            slow_torques=None
            if slowly is None
            else float(np.trapezoid([i.postures[name].torque_norm for i in slowly])) / (len(times) - 1),
            power=checked.powers[name],
            work=work,
        )
        for name, work in checked.work.items()
    }
