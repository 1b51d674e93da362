"""Fronts as tables for people and as JSON for programs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rich.markup import escape
from rich.table import Table

from evodesign.cli.output import figure
from evodesign.errors import on_one_line
from evodesign.records import Assessment, Evaluation, Objective
from evodesign.runlog.run import Run

__all__ = ["front_json", "front_table", "heading", "heights_table"]


def heading(objective: Objective) -> str:
    """A column's heading: name, sense and unit."""
    arrow = "↓" if objective.sense == "minimise" else "↑"
    return f"{objective.name} [{objective.unit}] {arrow}"


def front_json(run: Run, designs: Sequence[Evaluation]) -> dict[str, Any]:
    """The front as a JSON object; its shape is a promise."""
    return {
        "run": str(run.directory),
        "objectives": [objective.name for objective in run.header.objectives],
        "evaluations": len(run.evaluations),
        "designs": [
            {
                "id": evaluation.number,
                "objectives": evaluation.assessment.objectives,
                "parameters": evaluation.assessment.design,
            }
            for evaluation in designs
        ],
    }


def front_table(run: Run, designs: Sequence[Evaluation]) -> Table:
    """The front, best first in its first objective."""
    objectives = run.header.objectives
    table = Table(title=escape(f"Front of {run.header.problem_name}"), title_justify="left")
    table.add_column("design", justify="right")
    for objective in objectives:
        table.add_column(escape(heading(objective)), justify="right")
    first = objectives[0]
    sign = 1.0 if first.sense == "minimise" else -1.0
    for evaluation in sorted(designs, key=lambda e: sign * e.assessment.objectives[first.name]):
        values = evaluation.assessment.objectives
        table.add_row(str(evaluation.number), *(figure(values[objective.name]) for objective in objectives))
    return table


def heights_table(assessment: Assessment, title: str) -> Table:
    """A design's postures in short, height by height, under a title unless it is empty."""
    table = Table(title=title or None, title_justify="left")
    for column in ("height [m]", "robot |tau| [N m]", "human |tau| [N m]", "iterations", "residual"):
        table.add_column(escape(column), justify="right")
    table.add_column("status", overflow="fold")
    for outcome in assessment.heights:
        status = outcome.status if outcome.status == "solved" else f"{outcome.status}: {outcome.reason}"
        table.add_row(
            figure(outcome.height_m),
            figure(outcome.robot_torque_norm),
            figure(outcome.human_torque_norm),
            str(outcome.iterations),
            "-" if outcome.residual is None else f"{outcome.residual:.1e}",
            escape(on_one_line(status)),
        )
    return table
