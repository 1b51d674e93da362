"""One design as a notebook sees it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from evodesign.records import Assessment, CaseDetail, CaseOutcome, Constraint, ReachOutcome, Status
from evodesign.violations import violations

__all__ = ["Design"]


@dataclass(frozen=True, slots=True)
class Design:
    """A robot: its parameters and its results. Units are SI: m, N m, kg/m^3.

    Args:
        number: of the evaluation in its run; None for a design that was evaluated outside of one.
        assessment: the whole record.
        postures: of every case that was solved, of robot and person, with torques and wrenches; empty if
            they were not kept.
        bounds: the problem's constraints.
    """

    number: int | None
    assessment: Assessment
    postures: tuple[CaseDetail, ...] = ()
    bounds: tuple[Constraint, ...] = ()

    @property
    def parameters(self) -> Mapping[str, float]:
        """Values by name: length multipliers, densities [kg/m^3], allocations."""
        return self.assessment.design

    @property
    def objectives(self) -> Mapping[str, float]:
        """Natural values by name; those that do not exist are missing."""
        return self.assessment.objectives

    @property
    def feasible(self) -> bool:
        """Whether every constraint holds."""
        return self.assessment.violation == 0.0

    @property
    def violation(self) -> float | None:
        """Missed metres of height plus relative excesses of bounds; None when a failure left it unknown."""
        return self.assessment.violation

    @property
    def constraints(self) -> Mapping[str, float]:
        """Values of constrained quantities by name; those that do not exist are missing."""
        return self.assessment.constrained

    @property
    def violations(self) -> Mapping[str, float | None]:
        """By how much each constraint is violated, by name and in its unit; `height` [m] is one of them.

        Zero where one holds, None where its value does not exist.
        """
        return violations(self.bounds, self.assessment)

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
        """Interval of load heights that the robot can hold."""
        return self.assessment.reach

    @property
    def cases(self) -> tuple[CaseOutcome, ...]:
        """Each case in short."""
        return self.assessment.cases
