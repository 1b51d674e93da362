"""What polishing a design changed, as tables and as JSON."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from evodesign.cli.output import heading
from evodesign.cli.tables.design import constraints_table
from evodesign.cli.tables.table import FittedTable, names, numbers, titled
from evodesign.evaluation.polish import Aim, Polished
from evodesign.problem.build import DesignProblem
from evodesign.records import Assessment
from evodesign.runlog.run import RunLog
from evodesign.violations import constraints_json


def polish_tables(problem: DesignProblem, number: int, done: Polished) -> tuple[FittedTable, ...]:
    """Objectives, constraints and changed parameters before and after."""
    columns = [*names("objective"), *numbers("before", "after", "change")]
    objectives = titled(f"{problem.name}: design {number}", columns)
    for objective in problem.objectives:
        before, after = (a.objectives[objective.name] for a in (done.before, done.after))
        change = f"{(after - before) / abs(before):+.2%}" if before else "-"
        objectives.add_row(heading(objective), before, after, change)
    parameters = titled("parameters that changed", [*names("parameter"), *numbers("before", "after")])
    for name, before in done.before.design.items():
        after = done.after.design[name]
        if after != before:
            parameters.add_row(name, before, after)
    held = (("before", done.before), ("after", done.after))
    bounds = [constraints_table(problem.constraints, *held)] if problem.constraints else []
    return objectives, *bounds, parameters


def polish_json(run: RunLog, number: int, aim: Aim, done: Polished, file: Path) -> dict[str, Any]:
    """What changed, as a JSON object; its shape is a promise."""
    return {
        "run": str(run.directory),
        "design": number,
        "weights": dict(aim.weights),
        "none_worse": aim.none_worse,
        "evaluations": done.evaluations,
        "reason": done.reason,
        **{name: _results(run, of) for name, of in (("before", done.before), ("after", done.after))},
        "file": str(file),
    }


def _results(run: RunLog, assessment: Assessment) -> dict[str, Any]:
    constraints = run.header.constrained
    return {
        "objectives": assessment.objectives,
        "parameters": assessment.design,
        **({"constraints": constraints_json(constraints, assessment)} if constraints else {}),
    }
