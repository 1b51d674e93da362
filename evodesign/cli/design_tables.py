"""One design as tables for people."""

from __future__ import annotations

from rich.markup import escape
from rich.table import Table

from evodesign.cli.height_table import heights_table
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
    return summary, heights_table(assessment, "the load at each height")
