"""`polish`: one design of a run made better by going downhill on its exact gradients."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from evodesign.cli.options import CORES, Jobs, Json, RunPath
from evodesign.errors import InputError

if TYPE_CHECKING:
    from evodesign.evaluation.polish import Step
    from evodesign.records import Genome
    from evodesign.runlog.run import RunLog


def polish(
    run: RunPath,
    design: Annotated[int, typer.Argument(min=0, metavar="DESIGN", help="Number of a design of the run.")],
    objective: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="What is to get better.", show_default="all, none getting worse"),
    ] = None,
    weights: Annotated[
        str | None,
        typer.Option(
            metavar="NAME=NUMBER,...", help="Several objectives, weighted relative to their values."
        ),
    ] = None,
    evaluations: Annotated[int, typer.Option(min=2, metavar="N", help="Designs that may be evaluated.")] = 60,
    to: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="New file of designs.", show_default="in RUN"),
    ] = None,
    jobs: Jobs = CORES,
    json: Json = False,
) -> None:
    """Improve one design of a run by going downhill on its exact gradients; never returns a worse one."""
    from evodesign.cli.output import console, print_json, print_lines, show_notes, write_text
    from evodesign.cli.progress import precompute_progress
    from evodesign.cli.tables.polish import polish_json, polish_tables
    from evodesign.evaluation import polish as polishing
    from evodesign.evaluation.factory import evaluator_of
    from evodesign.problem.build import build_problem
    from evodesign.problem.designs import designs_text
    from evodesign.runlog.run import read_run

    logged = read_run(run)
    show_notes(logged.notes)
    genome = _genome(logged, design)
    problem = build_problem(logged.header.problem)
    option = "--weights" if objective is None else "--objective"
    aim = polishing.aim_of(problem, _weights(objective, weights), option)
    file = run / f"polished-{design}.toml" if to is None else to
    _refuse_existing(file)
    with precompute_progress() as progress:
        evaluator = evaluator_of(problem, jobs, progress)
    done = polishing.polish(evaluator, genome, aim, evaluations, lambda step: _show(step, evaluations))
    name = f"polished_{design}"
    remark = f"Design {design} of {problem.name}, polished for {', '.join(aim.weights)}."
    write_text(
        file, designs_text(name, {name: done.values}, problem.space, remark), "--to", follow=to is not None
    )
    if json:
        print_json(polish_json(logged, design, aim, done, file))
        return
    for table in polish_tables(problem, design, done):
        console().print(table)
    print_lines(
        f"{done.evaluations} designs evaluated, {done.reason}; the polished design is '{name}' in {file}"
    )


def _genome(run: RunLog, number: int) -> Genome:
    for evaluation in run.evaluations:
        if evaluation.number == number:
            return evaluation.genome
    last = max((evaluation.number for evaluation in run.evaluations), default=None)
    wanted = "a design of the run" + ("" if last is None else f", 0 to {last}")
    raise InputError("DESIGN", "", wanted, str(number))


def _weights(objective: str | None, weights: str | None) -> dict[str, float]:
    """Weights by objective: one alone, or from text such as `robot_torque=1,reach_height=0.5`."""
    if objective is not None and weights is not None:
        raise InputError("--objective", "", "either --objective or --weights", "both")
    if objective is not None:
        return {objective: 1.0}
    by_name: dict[str, float] = {}
    for part in filter(None, (weights or "").split(",")):
        name, _, number = part.partition("=")
        try:
            by_name[name.strip()] = float(number)
        except ValueError:
            wanted = "NAME=NUMBER,... such as robot_torque=1,reach_height=0.5"
            raise InputError("--weights", "", wanted, f"'{part}'") from None
    return by_name


def _show(step: Step, budget: int) -> None:
    """One line of progress per evaluation."""
    from evodesign.cli.output import print_lines, rounded

    values = " ".join(f"{name} {rounded(value)}" for name, value in step.assessment.objectives.items())
    word = "better" if step.taken else "not better"
    line = f"evaluation {step.number}/{budget}: {word}: {values or step.assessment.reason}"
    print_lines(line, stderr=True)


def _refuse_existing(file: Path) -> None:
    """Refuse to write over a file, before anything takes time."""
    if os.path.lexists(file):
        raise InputError("--to", "", "a new file", f"'{file}', which exists")
    if not file.parent.is_dir():
        raise InputError("--to", "", "a file in an existing directory", f"'{file}'")
