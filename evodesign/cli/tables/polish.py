"""What polishing a design changed, as tables and as JSON."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from rich.markup import escape

from evodesign.cli.output import heading, rounded
from evodesign.cli.tables.table import FittedTable, names, numbers, titled
from evodesign.problem.build import DesignProblem
from evodesign.problem.polish import Aim, Polished
from evodesign.runlog.run import RunLog

__all__ = ["polish_json", "polish_tables"]


def polish_tables(problem: DesignProblem, number: int, done: Polished) -> tuple[FittedTable, FittedTable]:
    """Objectives and changed parameters before and after."""
    columns = [*names("objective"), *numbers("before", "after", "change")]
    objectives = titled(f"{problem.name}: design {number}", columns)
    for objective in problem.objectives:
        before, after = (a.objectives[objective.name] for a in (done.before, done.after))
        change = f"{(after - before) / abs(before):+.2%}" if before else "-"
        objectives.add_row(escape(heading(objective)), rounded(before), rounded(after), change)
    parameters = titled("parameters that changed", [*names("parameter"), *numbers("before", "after")])
    for name, before in done.before.design.items():
        after = done.after.design[name]
        if after != before:
            parameters.add_row(escape(name), rounded(before), rounded(after))
    return objectives, parameters


def polish_json(run: RunLog, number: int, aim: Aim, done: Polished, file: Path) -> dict[str, Any]:
    """What changed, as a JSON object; its shape is a promise."""
    return {
        "run": str(run.directory),
        "design": number,
        "weights": dict(aim.weights),
        "none_worse": aim.none_worse,
        "evaluations": done.evaluations,
        "reason": done.reason,
        "before": {"objectives": done.before.objectives, "parameters": done.before.design},
        "after": {"objectives": done.after.objectives, "parameters": done.after.design},
        "file": str(file),
    }
