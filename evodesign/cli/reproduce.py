"""`reproduce`: the experiments of the three papers again, held against their claims."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from evodesign.cli.options import CORES, Jobs, Json, PoolName
from evodesign.errors import InputError

if TYPE_CHECKING:
    from evodesign.cli.tables.table import FittedTable
    from evodesign.problem.build import DesignProblem
    from evodesign.reproduction.experiment import Experiment

FIRST = 2022


def reproduce(
    to: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="New folder for runs, figures and robots.", show_default="in runs/"),
    ] = None,
    paper: Annotated[
        int,
        typer.Option(
            metavar="YEAR",
            help="2022, 2023 for its sequel with 3 people and 3 loads, or 2025 for robots A, B and C.",
        ),
    ] = FIRST,
    problem: Annotated[
        str | None,
        typer.Option(
            metavar="PROBLEM",
            help="The problem with physical limits.",
            show_default="sartore2022, sartore2023 or sartore2025",
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
        int, typer.Option(min=1, metavar="N", help="Designs that each search evaluates.")
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
    """The experiment of a paper again: tables, claims and figures, with verdicts."""
    from evodesign.api.sessions import new_directory
    from evodesign.cli.output import console, print_json, print_lines
    from evodesign.cli.session import DISPLAY
    from evodesign.report.export.folder import refuse_full
    from evodesign.reproduction.experiment import Effort, Experiment

    if paper != FIRST and paper not in LATER:
        raise InputError("--paper", "", " or ".join(map(str, (FIRST, *LATER))), f"{paper}")
    for option, value in (("--published", published), ("--starts", starts)):
        if paper != FIRST and value is not None:
            raise InputError(option, "", f"no such option with --paper {paper}", f"{value}")
    began = time.monotonic()
    directory = new_directory("reproduce") if to is None else to
    refuse_full(directory)
    effort = Effort(evaluations, seed, minutes, jobs, pool)
    experiment = Experiment(_built(problem or f"sartore{paper}"), directory, effort, began, DISPLAY)
    if paper == FIRST:
        shown = _first(experiment, _built(published or "sartore2022-as-published"), starts or 50)
    else:
        shown = LATER[paper](experiment)
    seconds = time.monotonic() - began
    if json:
        print_json(shown.as_json(seconds))
        return
    for table in shown.tables:
        console().print(table)
    print_lines(*shown.lines(seconds))


@dataclass(frozen=True, slots=True)
class _Shown:
    """A reproduction that is written: its tables, and what is said and printed after so many seconds."""

    tables: Sequence[FittedTable]
    lines: Callable[[float], Sequence[str]]
    as_json: Callable[[float], Mapping[str, Any]]


def _built(name: str) -> DesignProblem:
    from evodesign.problem.build import build_problem
    from evodesign.problem.source import read_source

    return build_problem(read_source(name))


def _first(experiment: Experiment, without: DesignProblem, starts: int) -> _Shown:
    """The experiment of 2022."""
    from evodesign.cli.tables import reproduction as tables
    from evodesign.reproduction.files2022 import reproduction_json, write_reproduction
    from evodesign.reproduction.lifting2022 import reproduction

    for each in (experiment.problem, without):
        if len(each.objectives) != 1:
            wanted = "one objective to reproduce"
            raise InputError(each.source.path, "objectives", wanted, f"{len(each.objectives)}")
    done, directory = reproduction(experiment, without, starts), experiment.directory
    compared = (done.original, *(one.robot for one in done.found))
    files = write_reproduction(directory, compared, (done.published.original, done.published.optimised))
    return _Shown(
        (tables.torque_table(done), tables.stricter_table(done), tables.claims_table(done.claims)),
        lambda seconds: tables.reproduction_lines(done, directory, seconds),
        lambda seconds: reproduction_json(done, directory, files, seconds),
    )


def _sequel(experiment: Experiment) -> _Shown:
    """The experiment of 2023."""
    from evodesign.cli.tables.reproduction import claims_table, robots_table, sequel_lines
    from evodesign.reproduction.codesign2023 import sequel_json, sequel_reproduction, write_sequel

    done, directory = sequel_reproduction(experiment), experiment.directory
    files = write_sequel(directory, done)
    return _Shown(
        (robots_table(done), claims_table(done.claims)),
        lambda seconds: sequel_lines(done, directory, seconds),
        lambda seconds: sequel_json(done, directory, files, seconds),
    )


def _third(experiment: Experiment) -> _Shown:
    """The robots of 2025."""
    from evodesign.cli.tables.reproduction import (
        claims_table,
        ergonomic_lines,
        height_figures,
        robots_of_2025,
    )
    from evodesign.reproduction.ergonomic2025 import ergonomic_json, ergonomic_reproduction, write_ergonomic

    done, directory = ergonomic_reproduction(experiment), experiment.directory
    files = write_ergonomic(directory, done)
    return _Shown(
        (height_figures(done), robots_of_2025(done), claims_table(done.claims)),
        lambda seconds: ergonomic_lines(done, directory, seconds),
        lambda seconds: ergonomic_json(done, directory, files, seconds),
    )


LATER: Mapping[int, Callable[[Experiment], _Shown]] = {2023: _sequel, 2025: _third}
"""The papers that followed, by year."""
