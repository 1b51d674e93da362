"""`reproduce`: the experiments of the paper and of its sequel again, held against their claims."""

from __future__ import annotations

import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from evodesign.cli.options import CORES, Jobs, Json, PoolName
from evodesign.errors import InputError

if TYPE_CHECKING:
    from evodesign.problem.build import DesignProblem
    from evodesign.reproduction.experiment import Experiment

FIRST, SEQUEL = 2022, 2023


def reproduce(
    to: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="New folder for runs, figures and robots.", show_default="in runs/"),
    ] = None,
    paper: Annotated[
        int, typer.Option(metavar="YEAR", help="2022, or 2023 for its sequel with 3 people and 3 loads.")
    ] = FIRST,
    problem: Annotated[
        str | None,
        typer.Option(
            metavar="PROBLEM",
            help="The problem with physical limits.",
            show_default="sartore2022 or sartore2023",
        ),
    ] = None,
    published: Annotated[
        str | None,
        typer.Option(
            metavar="PROBLEM",
            help="The published setting of 2022, without limits.",
            show_default="sartore2022-as-published",
        ),
    ] = None,
    starts: Annotated[
        int | None,
        typer.Option(min=1, metavar="N", help="Starts of the joint problem of 2022.", show_default="50"),
    ] = None,
    evaluations: Annotated[
        int, typer.Option(min=1, metavar="N", help="Designs that the search evaluates.")
    ] = 480,
    seed: Annotated[int, typer.Option(min=0, metavar="N", help="Random seed of starts and search.")] = 1,
    minutes: Annotated[
        float,
        typer.Option(
            min=0.1, metavar="M", help="After which searches have ended, with what they have by then."
        ),
    ] = 12.0,
    jobs: Jobs = CORES,
    pool: PoolName = "joblib",
    json: Json = False,
) -> None:
    """The paper's experiment again, or its sequel's: tables, claims and figures, with verdicts."""
    from evodesign.api.sessions import new_directory
    from evodesign.cli.session import DISPLAY
    from evodesign.report.export.folder import refuse_full
    from evodesign.reproduction.experiment import Effort, Experiment

    if paper not in (FIRST, SEQUEL):
        raise InputError("--paper", "", f"{FIRST} or {SEQUEL}", f"{paper}")
    for option, value in (("--published", published), ("--starts", starts)):
        if paper == SEQUEL and value is not None:
            raise InputError(option, "", f"no such option with --paper {SEQUEL}", f"{value}")
    began = time.monotonic()
    directory = new_directory("reproduce") if to is None else to
    refuse_full(directory)
    effort = Effort(evaluations, seed, minutes, jobs, pool)
    limited = _built(problem or f"sartore{paper}")
    experiment = Experiment(limited, directory, effort, began, DISPLAY)
    if paper == SEQUEL:
        _sequel(experiment, json=json)
        return
    without = _built(published or "sartore2022-as-published")
    for each in (limited, without):
        if len(each.objectives) != 1:
            wanted = "one objective to reproduce"
            raise InputError(each.source.path, "objectives", wanted, f"{len(each.objectives)}")
    _first(experiment, without, starts or 50, json=json)


def _built(name: str) -> DesignProblem:
    from evodesign.problem.build import build_problem
    from evodesign.problem.source import read_source

    return build_problem(read_source(name))


def _first(experiment: Experiment, without: DesignProblem, starts: int, *, json: bool) -> None:
    """The experiment of 2022."""
    from evodesign.cli.output import console, print_json, print_lines
    from evodesign.cli.tables.reproduction import (
        claims_table,
        reproduction_lines,
        stricter_table,
        torque_table,
    )
    from evodesign.reproduction.files2022 import reproduction_json, write_reproduction
    from evodesign.reproduction.lifting2022 import reproduction

    done = reproduction(experiment, without, starts)
    directory = experiment.directory
    compared = (done.original, *(one.robot for one in done.found))
    files = write_reproduction(directory, compared, (done.published.original, done.published.optimised))
    seconds = time.monotonic() - experiment.began
    if json:
        print_json(reproduction_json(done, directory, files, seconds))
        return
    for table in (torque_table(done), stricter_table(done), claims_table(done.claims)):
        console().print(table)
    print_lines(*reproduction_lines(done, directory, seconds))


def _sequel(experiment: Experiment, *, json: bool) -> None:
    """The experiment of 2023."""
    from evodesign.cli.output import console, print_json, print_lines
    from evodesign.cli.tables.reproduction import claims_table
    from evodesign.cli.tables.sequel import robots_table, sequel_lines
    from evodesign.reproduction.codesign2023 import sequel_reproduction
    from evodesign.reproduction.files2023 import sequel_json, write_sequel

    done = sequel_reproduction(experiment)
    directory = experiment.directory
    files = write_sequel(directory, done)
    seconds = time.monotonic() - experiment.began
    if json:
        print_json(sequel_json(done, directory, files, seconds))
        return
    for table in (robots_table(done), claims_table(done.claims)):
        console().print(table)
    print_lines(*sequel_lines(done, directory, seconds))
