"""One design as a notebook sees it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from evodesign.records import Assessment, HeightDetail, HeightOutcome, ReachOutcome, Status

__all__ = ["Design"]


@dataclass(frozen=True, slots=True)
class Design:
    """A robot: its parameters and its results. Units are SI: m, N m, kg/m^3.

    Args:
        number: of the evaluation in its run; None for a design that was evaluated outside of one.
        assessment: the whole record.
        postures: at every height that was solved, of robot and person, with torques and wrenches; empty if
            they were not kept.
    """

    number: int | None
    assessment: Assessment
    postures: tuple[HeightDetail, ...] = ()

    @property
    def parameters(self) -> Mapping[str, float]:
        """Values by name: length multipliers, densities [kg/m^3]."""
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
        """Interval of load heights that the robot can hold."""
        return self.assessment.reach

    @property
    def heights(self) -> tuple[HeightOutcome, ...]:
        """Each required height in short."""
        return self.assessment.heights
