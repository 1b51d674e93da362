"""`search`: the designs of a problem, searched in a run of its own."""

from __future__ import annotations

from functools import partial
from typing import Annotated

import typer

from evodesign.cli import options


def search(
    problem: options.ProblemPath,
    run: options.NewRun = None,
    algorithm: options.Algorithm = None,
    evaluations: options.Evaluations = None,
    hours: options.Hours = None,
    stagnation_generations: options.Stagnation = None,
    least_growth_percent: options.LeastGrowth = None,
    population: options.PopulationSize = None,
    seed: options.Seed = None,
    asynchronous: Annotated[
        bool | None,
        typer.Option(
            "--asynchronous/--generations",
            help="Whether no worker waits for the slowest of a generation.",
            show_default="as in the problem",
        ),
    ] = None,
    symmetry: options.SymmetryName = None,
    jobs: options.Jobs = options.CORES,
    pool: options.PoolName = "joblib",
    scheduler: options.Scheduler = None,
    cache: options.UseCache = False,
    json: options.Json = False,
) -> None:
    """Search a problem's designs; every evaluation is logged, and the search can be stopped and resumed."""
    from evodesign.api.sessions import Budgets, Workers, begin, new_directory
    from evodesign.cli.session import DISPLAY, SignalledStop, show_result
    from evodesign.problem.build import build_problem
    from evodesign.problem.source import read_source

    built = build_problem(read_source(problem, symmetry))
    directory = new_directory(built.name) if run is None else run
    done = begin(
        built,
        directory,
        built.settings(algorithm, population, seed, asynchronous),
        Budgets(evaluations, hours, stagnation_generations, least_growth_percent),
        Workers(jobs=jobs, pool=pool, scheduler=scheduler, cache=cache),
        DISPLAY,
        partial(SignalledStop, run=directory),
    )
    show_result(done, json=json)
