"""Fronts as tables for people and as JSON for programs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rich.markup import escape
from rich.table import Table

from evodesign.cli.output import figure
from evodesign.records import Evaluation, Objective
from evodesign.runlog.run import Run

__all__ = ["front_json", "front_table", "heading"]


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
