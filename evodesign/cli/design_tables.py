"""One design as tables for people."""

from __future__ import annotations

from rich.markup import escape
from rich.table import Table

from evodesign.cli.output import figure
from evodesign.cli.tables import heading
from evodesign.problem.build import Problem
from evodesign.problem.objectives import DesignResult
from evodesign.records import Assessment

__all__ = ["assessment_tables"]


def assessment_tables(
    problem: Problem, name: str, result: DesignResult, assessment: Assessment
) -> tuple[Table, Table]:
    """One design: its objectives, and its postures height by height."""
    summary = Table(title=escape(f"{problem.name}: {name}"), title_justify="left")
    summary.add_column("objective")
    summary.add_column("value", justify="right")
    for objective in problem.objectives:
        value = assessment.objectives.get(objective.name)
        summary.add_row(escape(heading(objective)), figure(value))
    summary.add_row(escape("violation [m]"), figure(assessment.violation))
    summary.add_row(escape("reach [m]"), f"{figure(result.reach.lowest)} to {figure(result.reach.highest)}")
    heights = Table(title="the load at each height", title_justify="left")
    for column in ("height [m]", "robot |tau| [N m]", "human |tau| [N m]", "iterations", "residual"):
        heights.add_column(escape(column), justify="right")
    heights.add_column("status", overflow="fold")
    for outcome in assessment.heights:
        status = outcome.status if outcome.status == "solved" else f"{outcome.status}: {outcome.reason}"
        heights.add_row(
            figure(outcome.height_m),
            figure(outcome.robot_torque_norm),
            figure(outcome.human_torque_norm),
            str(outcome.iterations),
            "-" if outcome.residual is None else f"{outcome.residual:.1e}",
            escape(status),
        )
    return summary, heights
