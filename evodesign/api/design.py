"""One design as a notebook sees it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from evodesign.records import Assessment, CaseDetail, CaseOutcome, ReachOutcome, Status

__all__ = ["Design"]


@dataclass(frozen=True, slots=True)
class Design:
    """A robot: its parameters and its results. Units are SI: m, N m, kg/m^3.

    Args:
        number: of the evaluation in its run; None for a design that was evaluated outside of one.
        assessment: the whole record.
        postures: of every case that was solved, of robot and person, with torques and wrenches; empty if
            they were not kept.
    Example:
        >>> design = run.design(4)
        >>> design.feasible, design.objectives["reach_height"]
        (True, 1.343...)
    """

    number: int | None
    assessment: Assessment
    postures: tuple[CaseDetail, ...] = ()

    @property
    def parameters(self) -> Mapping[str, float]:
        """Values by name: length multipliers [1], densities [kg/m^3], allocations [1]."""
        return self.assessment.design

    @property
    def objectives(self) -> Mapping[str, float]:
        """Natural values by name, each in its objective's unit; those that do not exist are missing."""
        return self.assessment.objectives

    @property
    def feasible(self) -> bool:
        """Whether every constraint holds."""
        return self.assessment.violation == 0.0

    @property
    def violation(self) -> float | None:
        """Sum of the constraint violations [m]; None when a failure left it unknown."""
        return self.assessment.violation

    @property
    def status(self) -> Status:
        """How the evaluation ended."""
        return self.assessment.status

    @property
    def reason(self) -> str:
        """Why it ended so, in a sentence."""
        return self.assessment.reason

    @property
    def reach(self) -> ReachOutcome | None:
        """Interval of load heights [m] that the robot can hold."""
        return self.assessment.reach

    @property
    def cases(self) -> tuple[CaseOutcome, ...]:
        """Each case in short: status, reason, torque norms [N m], residual [1]."""
        return self.assessment.cases
