"""What came of a lift: its motion, what it takes of robot and person, and the check's word on it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from evodesign.motion.course import LiftCourse
from evodesign.motion.least_time import LeastTime
from evodesign.motion.lift_check import CheckedLift, fine_times
from evodesign.motion.lift_program import LiftStart
from evodesign.nlp.method import Ending
from evodesign.posture.results import Attempt, CaseSolution
from evodesign.records import Case, Lift, Status

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class AgentEffort:
    """What a lift takes of one agent.

    Args:
        torques: norm over the joints [N m] at each of the solution's times.
        slow_torques: mean over time of the same lift infinitely slowly [N m]; None where it was not found.
        power: of the joint torques at each time [W].
        work: of the joint torques [J].
        disturbed: norms of the torques under each disturbance, by its name, likewise.
    """

    torques: Array
    slow_torques: float | None
    power: Array
    work: float
    disturbed: Mapping[str, Array] = field(default_factory=dict)

    @property
    def mean_torque(self) -> float:
        """Mean over time of the norm [N m], by the trapezoidal rule."""
        return float(np.trapezoid(self.torques)) / (len(self.torques) - 1)

    @property
    def peak_torque(self) -> float:
        """Largest norm [N m]."""
        return float(self.torques.max())

    @property
    def static_share(self) -> float | None:
        """Of the mean torque, how much is there when the same lift is infinitely slow."""
        return None if self.slow_torques is None else self.slow_torques / self.mean_torque


@dataclass(frozen=True, slots=True, eq=False)
class LiftSolution:
    """The best checked lift, or why there is none.

    Args:
        lift: what was asked for; with the knots that it took.
        status: solved, or why not.
        reason: a sentence.
        attempts: every start tried.
        course: the motion; None unless solved.
        checked: what the independent check found; None unless solved.
        efforts: by agent name; empty unless solved.
        start: where the solve of the motion began; None unless solved.
        ending: of that solve.
        least: the least time of the same lift; None where nothing asks for it.
    """

    lift: Lift
    status: Status
    reason: str
    attempts: tuple[Attempt, ...] = ()
    course: LiftCourse | None = None
    checked: CheckedLift | None = None
    efforts: Mapping[str, AgentEffort] = field(default_factory=dict)
    start: LiftStart | None = None
    ending: Ending | None = None
    least: LeastTime | None = None

    def __repr__(self) -> str:
        return f"<{self.lift}: {self.status}>"

    @property
    def solved(self) -> bool:
        """Whether there is a checked motion."""
        return self.status is Status.SOLVED

    def in_case(self, case: Case) -> MotionCase:
        """The same as the result of a case, whose instants are the knots asked for and half-way between them.

        Args:
            case: whose task is the lift, with the knots that were asked for.
        """
        solution = MotionCase(case, self.status, self.reason, attempts=self.attempts, motion=self)
        if self.course is None or self.checked is None or not isinstance(case.task, Lift):
            return solution
        solved = [each for each in self.attempts if each.status is Status.SOLVED]
        finer = self.lift.knots != case.task.knots
        return replace(
            solution,
            instants=self.course.instants(case.task.result_times),
            residuals=self.checked.knots,
            attempt=self.attempts[-1] if finer else min(solved, key=lambda each: each.cost),
        )

    @property
    def times(self) -> Array:
        """Of all that is told over time [s]; none unless solved."""
        return np.empty(0) if self.course is None else fine_times(self.course)


@dataclass(frozen=True, slots=True)
class MotionCase(CaseSolution):
    """A lift as the result of a case.

    Args:
        motion: that the instants are of.
    """

    motion: LiftSolution | None = None

    @property
    def least_seconds(self) -> float | None:
        """The least time of the lift [s]; None where it is not known."""
        return None if self.motion is None or self.motion.least is None else self.motion.least.seconds

    def with_least_time_moved(self, slope: Array | None, step: Array) -> MotionCase:
        """The same with the least time of a design that differs by a step, to first order.

        Args:
            slope: derivative of the least time, one per parameter; None where nothing asks for it.
            step: one number per parameter.
        """
        if slope is None or self.motion is None or self.motion.least is None:
            return self
        least = replace(self.motion.least, seconds=self.motion.least.seconds + float(slope @ step))
        return replace(self, motion=replace(self.motion, least=least))
