"""`reproduce`: the paper's experiment again, by gradients and by evolution, held against its claims."""

from __future__ import annotations

import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from evodesign.cli.options import CORES, Jobs, Json, PoolName
from evodesign.errors import InputError

if TYPE_CHECKING:
    from evodesign.problem.build import DesignProblem

__all__ = ["reproduce"]


def reproduce(
    to: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="New folder for runs, figures and robots.", show_default="in runs/"),
    ] = None,
    problem: Annotated[
        str, typer.Option(metavar="PROBLEM", help="The problem with physical limits.")
    ] = "sartore2022",
    published: Annotated[
        str, typer.Option(metavar="PROBLEM", help="The published setting, without limits.")
    ] = "sartore2022-as-published",
    starts: Annotated[int, typer.Option(min=1, metavar="N", help="Starts of the joint problem.")] = 50,
    evaluations: Annotated[
        int, typer.Option(min=1, metavar="N", help="Designs that the search evaluates.")
    ] = 480,
    seed: Annotated[int, typer.Option(min=0, metavar="N", help="Random seed of starts and search.")] = 1,
    minutes: Annotated[
        float,
        typer.Option(min=0.1, metavar="M", help="After which both have ended, with what they have by then."),
    ] = 12.0,
    jobs: Jobs = CORES,
    pool: PoolName = "joblib",
    json: Json = False,
) -> None:
    """The paper's experiment again: its table, claims and figures, with verdicts, then by evolution."""
    from evodesign.api.sessions import new_directory
    from evodesign.cli.output import console, print_json, print_lines
    from evodesign.cli.session import DISPLAY
    from evodesign.cli.tables.reproduction import claims_table, reproduction_lines, torque_table
    from evodesign.report.export.folder import refuse_full
    from evodesign.report.reproduction import reproduction_json, write_reproduction
    from evodesign.reproduction import Effort, Experiment, reproduction

    began = time.monotonic()
    directory = new_directory("reproduce") if to is None else to
    refuse_full(directory)
    effort = Effort(starts, evaluations, seed, minutes, jobs, pool)
    experiment = Experiment(_scalar(problem), directory, effort, began, DISPLAY)
    done = reproduction(experiment, _scalar(published))
    compared = (done.original, *(one.robot for one in done.found))
    files = write_reproduction(directory, compared, (done.published.original, done.published.optimised))
    seconds = time.monotonic() - began
    if json:
        print_json(reproduction_json(done, directory, files, seconds))
        return
    console().print(torque_table(done))
    console().print(claims_table(done.claims))
    print_lines(*reproduction_lines(done, directory, seconds))


def _scalar(name: str) -> DesignProblem:
    """A problem with one objective, so that one robot is the best."""
    from evodesign.problem.build import build_problem
    from evodesign.problem.source import read_source

    problem = build_problem(read_source(name))
    if len(problem.objectives) != 1:
        raise InputError(name, "objectives", "one objective to reproduce", f"{len(problem.objectives)}")
    return problem
