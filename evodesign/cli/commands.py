"""The commands' names, arguments and options.

What a command needs is imported when it is called: showing a front must not wait for CasADi to load.
"""

from __future__ import annotations

import math
import os
from pathlib import Path
from typing import Annotated

import typer

__all__ = ["COMMANDS"]

ProblemPath = Annotated[Path, typer.Argument(metavar="PROBLEM", help="Problem file (TOML).")]
RunPath = Annotated[Path, typer.Argument(metavar="RUN", help="Directory of a run.")]
Json = Annotated[bool, typer.Option("--json", help="Print JSON instead of tables.")]
SymmetryName = Annotated[
    str | None,
    typer.Option("--symmetry", help="Postures: on, off or polish.", show_default="as in the problem"),
]
Evaluations = Annotated[
    int | None, typer.Option(min=1, help="Total evaluations of the run.", show_default="as in the problem")
]
Hours = Annotated[
    float | None,
    typer.Option(
        help="Wall time of a session; then it stops, resumable. 0 for no limit.", show_default="no limit"
    ),
]
Stagnation = Annotated[
    int | None,
    typer.Option(
        min=0,
        metavar="N",
        help="End when the hypervolume has grown by less than 0.1 % in N generations; 0 for never.",
        show_default="never",
    ),
]
Algorithm = Annotated[
    str | None, typer.Option(help="nsga2, cma-es or random.", show_default="as in the problem")
]
PopulationSize = Annotated[
    int | None, typer.Option(min=2, help="Evaluations of a generation.", show_default="as in the problem")
]
Seed = Annotated[int | None, typer.Option(min=0, help="Of the search.", show_default="as in the problem")]
Jobs = Annotated[int, typer.Option(min=1, help="Evaluations that run at the same time.")]
PoolName = Annotated[str, typer.Option("--pool", help="Where evaluations run: serial or joblib.")]

CORES = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def checked_hours(hours: float | None) -> float | None:
    """The hours given, if any.

    Raises:
        typer.BadParameter: a negative number, or none.
    """
    if hours is not None and not 0.0 <= hours < math.inf:
        raise typer.BadParameter(f"wanted a number of hours from 0, found {hours:g}", param_hint="--hours")
    return hours


def search(
    problem: ProblemPath,
    run: Annotated[
        Path | None, typer.Option(help="Directory of the new run.", show_default="runs/NAME-TIME")
    ] = None,
    algorithm: Algorithm = None,
    evaluations: Evaluations = None,
    hours: Hours = None,
    stagnation_generations: Stagnation = None,
    population: PopulationSize = None,
    seed: Seed = None,
    symmetry: SymmetryName = None,
    jobs: Jobs = CORES,
    pool: PoolName = "joblib",
    json: Json = False,
) -> None:
    """Search a problem's designs; every evaluation is logged, and the search can be stopped and resumed."""
    from evodesign.cli.searching import Budgets, Wishes, start

    budgets = Budgets(evaluations, checked_hours(hours), stagnation_generations)
    start(problem, run, Wishes(algorithm, population, seed, symmetry), budgets, jobs, pool, json)


def resume(
    run: RunPath,
    evaluations: Evaluations = None,
    hours: Hours = None,
    stagnation_generations: Stagnation = None,
    jobs: Jobs = CORES,
    pool: PoolName = "joblib",
    accept_versions: Annotated[
        bool, typer.Option("--accept-versions", help="Go on although packages have other versions.")
    ] = False,
    json: Json = False,
) -> None:
    """Go on with a run that was stopped or killed, or give a finished one a larger budget."""
    from evodesign.cli.searching import Budgets, go_on

    budgets = Budgets(evaluations, checked_hours(hours), stagnation_generations)
    go_on(run, budgets, jobs, pool, accept_versions, json)


def branch(
    run: RunPath,
    branch_from: Annotated[
        int, typer.Option(min=1, metavar="GENERATION", help="How many generations the new run takes over.")
    ],
    to: Annotated[
        Path | None,
        typer.Option("--run", help="Directory of the new run.", show_default="runs/NAME-TIME"),
    ] = None,
    algorithm: Algorithm = None,
    evaluations: Evaluations = None,
    hours: Hours = None,
    stagnation_generations: Stagnation = None,
    population: PopulationSize = None,
    seed: Seed = None,
    jobs: Jobs = CORES,
    pool: PoolName = "joblib",
    json: Json = False,
) -> None:
    """Begin a new run with the first generations of another, and go on with another seed or search."""
    from evodesign.cli.searching import Budgets, Turn, Wishes
    from evodesign.cli.searching import branch as begin

    budgets = Budgets(evaluations, checked_hours(hours), stagnation_generations)
    begin(run, Turn(branch_from, to), Wishes(algorithm, population, seed, None), budgets, jobs, pool, json)


def front(
    run: RunPath,
    json: Json = False,
    plot: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Also write a figure of the front (HTML).")
    ] = None,
) -> None:
    """The designs of a run that no other design beats in every objective."""
    from evodesign.cli.fronts import show

    show(run, json, plot)


def evaluate(
    problem: ProblemPath,
    design: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="File of named designs.", show_default="the unscaled robot"),
    ] = None,
    name: Annotated[
        str | None,
        typer.Option(help="Which design of the file.", show_default="the file's only one"),
    ] = None,
    symmetry: SymmetryName = None,
    jobs: Jobs = CORES,
    json: Json = False,
) -> None:
    """One design in full: reach, postures, torques, wrenches, residuals."""
    from evodesign.cli.designs import evaluate_design

    evaluate_design(problem, design, name, symmetry, jobs, json)


def check(problem: ProblemPath, json: Json = False) -> None:
    """Read a problem and show what was understood: agents, load, task, and what each parameter changes."""
    from evodesign.cli.designs import check_problem

    check_problem(problem, json)


def verify(run: RunPath, json: Json = False) -> None:
    """Check a run: every checksum and record, their order, what follows from them, and the replay."""
    from evodesign.cli.files import verify_run

    verify_run(run, json)


def recover(
    run: RunPath,
    to: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Directory to write.", show_default="RUN-recovered")
    ] = None,
    json: Json = False,
) -> None:
    """Write all that can be read of a damaged run to a new directory, and say what is lost."""
    from evodesign.cli.files import recover_run

    recover_run(run, to, json)


def merge(
    run: RunPath,
    to: Annotated[
        Path | None, typer.Option(metavar="FILE", help="File to write.", show_default="in place")
    ] = None,
    json: Json = False,
) -> None:
    """Put all segments of a run into one indexed MCAP file."""
    from evodesign.cli.files import merge_run

    merge_run(run, to, json)


def seeds(problem: ProblemPath, jobs: Jobs = CORES, json: Json = False) -> None:
    """What a problem is solved from: its seeds, and how well they lead other designs."""
    from evodesign.cli.seeding import show_seeds

    show_seeds(problem, jobs, json)


COMMANDS = (search, resume, branch, front, evaluate, check, seeds, verify, recover, merge)
