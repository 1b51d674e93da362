"""`polish`: one design of a run made better by going downhill on its exact gradients."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from rich.markup import escape
from rich.table import Table

from evodesign.cli.making import making
from evodesign.cli.output import console, figure, print_json, show_notes
from evodesign.cli.tables.front import heading
from evodesign.errors import InputError
from evodesign.problem.build import Problem, build_problem
from evodesign.problem.designs import designs_text
from evodesign.problem.factory import evaluator_of
from evodesign.problem.polish import Aim, Polished, Step, aim_of, polish
from evodesign.records import Genome
from evodesign.runlog.run import Run, read_run

__all__ = ["polish_design"]


def polish_design(
    directory: Path,
    number: int,
    objective: str | None,
    weights: str | None,
    evaluations: int,
    to: Path | None,
    jobs: int,
    json: bool,
) -> None:
    """Polish a design of a run, write it to a file of designs, and print what changed."""
    run = read_run(directory)
    show_notes(run.notes)
    genome = _genome(run, number)
    problem = build_problem(run.header.problem)
    aim = _aim(problem, objective, weights)
    file = run.directory / f"polished-{number}.toml" if to is None else to
    _refuse_existing(file)
    with making() as progress:
        evaluator = evaluator_of(problem, jobs, progress)
    done = polish(evaluator, genome, aim, evaluations, lambda step: _show(step, evaluations))
    name = f"polished_{number}"
    remark = f"Design {number} of {problem.name}, polished for {', '.join(aim.weights)}."
    _write(file, designs_text(name, {name: done.values}, problem.space, remark))
    if json:
        print_json(_json(run, number, aim, done, file))
        return
    for table in _tables(problem, number, done):
        console().print(table)
    said = f"{done.evaluations} designs evaluated, {done.reason}; the polished design is '{name}' in {file}"
    console().print(said, highlight=False, markup=False, soft_wrap=True)


def _genome(run: Run, number: int) -> Genome:
    for evaluation in run.evaluations:
        if evaluation.number == number:
            return evaluation.genome
    last = max((evaluation.number for evaluation in run.evaluations), default=None)
    wanted = "a design of the run" + ("" if last is None else f", 0 to {last}")
    raise InputError("DESIGN", "", wanted, str(number))


def _aim(problem: Problem, objective: str | None, weights: str | None) -> Aim:
    """The aim that the options name."""
    if objective is not None and weights is not None:
        raise InputError("--objective", "", "either --objective or --weights", "both")
    if objective is not None:
        return aim_of(problem, {objective: 1.0}, "--objective")
    return aim_of(problem, _weights(weights or ""), "--weights")


def _weights(text: str) -> dict[str, float]:
    """Weights by objective, from text such as `robot_torque=1,reach_height=0.5`."""
    weights: dict[str, float] = {}
    for part in filter(None, text.split(",")):
        name, _, number = part.partition("=")
        try:
            weights[name.strip()] = float(number)
        except ValueError:
            wanted = "NAME=NUMBER,... such as robot_torque=1,reach_height=0.5"
            raise InputError("--weights", "", wanted, f"'{part}'") from None
    return weights


def _show(step: Step, budget: int) -> None:
    """One line of progress per evaluation."""
    values = " ".join(f"{name} {figure(value)}" for name, value in step.assessment.objectives.items())
    word = "better" if step.taken else "not better"
    line = f"evaluation {step.number}/{budget}: {word}: {values or step.assessment.reason}"
    console(stderr=True).print(line, highlight=False, markup=False, soft_wrap=True)


def _tables(problem: Problem, number: int, done: Polished) -> tuple[Table, Table]:
    objectives = Table(title=escape(f"{problem.name}: design {number}"), title_justify="left")
    for column in ("objective", "before", "after", "change"):
        objectives.add_column(column, justify="left" if column == "objective" else "right")
    for objective in problem.objectives:
        before, after = (a.objectives[objective.name] for a in (done.before, done.after))
        change = f"{(after - before) / abs(before):+.2%}" if before else "-"
        objectives.add_row(escape(heading(objective)), figure(before), figure(after), change)
    parameters = Table(title="parameters that changed", title_justify="left")
    for column in ("parameter", "before", "after"):
        parameters.add_column(column, justify="left" if column == "parameter" else "right")
    for name, before in done.before.design.items():
        after = done.after.design[name]
        if after != before:
            parameters.add_row(escape(name), figure(before), figure(after))
    return objectives, parameters


def _json(run: Run, number: int, aim: Aim, done: Polished, file: Path) -> dict[str, Any]:
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


def _refuse_existing(file: Path) -> None:
    """Refuse to write over a file, before anything takes time."""
    if file.exists():
        raise InputError("--to", "", "a new file", f"'{file}', which exists")
    if not file.parent.is_dir():
        raise InputError("--to", "", "a file in an existing directory", f"'{file}'")


def _write(file: Path, text: str) -> None:
    try:
        file.write_text(text, encoding="utf-8")
    except OSError as error:
        raise InputError("--to", "", "a file that can be written", f"'{file}' ({error.strerror})") from error
