"""One design as a notebook sees it."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from evodesign.errors import InputError
from evodesign.files import make_folder
from evodesign.records import Assessment, CaseDetail, CaseOutcome, Constraint, ReachOutcome, Status
from evodesign.runlog.run import RunLog
from evodesign.violations import violations


@dataclass(frozen=True, slots=True)
class Design:
    """A robot: its parameters and its results. Units are SI: m, N m, kg/m^3.

    Args:
        number: of the evaluation in its run; None for a design that was evaluated outside of one.
        assessment: the whole record.
        postures: a `CaseDetail` of every case that was solved; empty if they were not kept. Its `agents`
            are an `AgentDetail` each of `robot` and `human`: base [m, rad], joints [rad], torques [N m] and
            wrenches [N, N m].
        bounds: the problem's constraints.
        notes: a sentence for each parameter that is beyond its bounds; none of a design of a run.
        log: gives the log that holds it, for `export`.
    Example:
        >>> design = run.design(4)
        >>> design
        <design 4: robot_torque 1.625, worst_human_torque 2.206, reach_height 1.343>
        >>> design.feasible, design.objectives["reach_height"]
        (True, 1.343...)
    """

    number: int | None
    assessment: Assessment
    postures: tuple[CaseDetail, ...] = ()
    bounds: tuple[Constraint, ...] = ()
    notes: tuple[str, ...] = ()
    log: Callable[[], RunLog] | None = field(default=None, repr=False, compare=False)

    def __repr__(self) -> str:
        return f"<{'design' if self.number is None else f'design {self.number}'}: {self.assessment.summary}>"

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
        """Missed height [m] plus relative excesses of bounds [1]; None when a failure left it unknown."""
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
        """Interval of load heights [m] that the robot can hold."""
        return self.assessment.reach

    @property
    def cases(self) -> tuple[CaseOutcome, ...]:
        """Each case in short: status, reason, torque norms [N m], residual [1]."""
        return self.assessment.cases

    def export(self, folder: str | os.PathLike[str], *, cad: bool = False) -> tuple[Path, ...]:
        """Write the design's files, as `evodesign export` does: URDF, MJCF, postures, a replay, a README.

        Args:
            folder: a new or empty one.
            cad: whether STEP, STL and a drawing of the robot are written, too, into `cad/`.
        Returns:
            The files.
        Raises:
            InputError: the folder holds files or cannot be written; or the design is of no problem or run; or
                `cad` without the extra that it needs (pip install 'evodesign[cad]').
        Example:
            >>> [file.name for file in run.design(4).export("design-4")][:3]
            ['README.md', 'robot.urdf', 'robot.xml']
        """
        from evodesign.report.export.folder import (  # CasADi takes its time to load
            export_logged,
            refuse_full,
            refuse_without_cad,
        )

        if self.log is None:
            raise InputError("design", "", "a design of a run or of a problem", "one of neither")
        refuse_full(Path(folder))
        if cad:
            refuse_without_cad()
        return export_logged(self.log(), self.number or 0, Path(folder), cad=cad).files

    def plot(self, folder: str | os.PathLike[str]) -> tuple[Path, ...]:
        """Write figures, as `evodesign evaluate --plot` and `show --plot` do, each as SVG and PNG.

        Args:
            folder: made where it is missing; figures of the same names are replaced.
        Returns:
            The files: `postures` obliquely, `postures_side` from the robot's right and `postures_front` with
            robot and person each from the front, both with a scale in metres; `torques` and
            `torques_by_joint` of the joints [N m].
        Raises:
            InputError: the folder cannot be written; or the design is of no problem or run.
        Example:
            >>> sorted(file.name for file in run.design(4).plot("figures-4") if file.suffix == ".png")[:3]
            ['postures.png', 'postures_front.png', 'postures_side.png']
        """
        from evodesign.evaluation.progress import SILENT
        from evodesign.report.figures.design import write_design_figures  # matplotlib takes its time to load
        from evodesign.report.opened_design import open_design

        if self.log is None:
            raise InputError("design", "", "a design of a run or of a problem", "one of neither")
        make_folder(Path(folder), "folder")
        log = self.log()
        opened = open_design(log, self.number or 0, 1, SILENT)
        name = log.header.problem_name + ("" if self.number is None else f", design {self.number}")
        return tuple(write_design_figures(name, opened.scene_set(), opened.cases, Path(folder)))
