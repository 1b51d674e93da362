"""`branch`: a new run with the past of another one, and another seed or search."""

from __future__ import annotations

from typing import Annotated

import typer

from evodesign.cli import options
from evodesign.cli.resume import resume


def branch(
    run: options.RunPath,
    branch_from: Annotated[
        int, typer.Option(min=1, metavar="GENERATION", help="How many generations the new run takes over.")
    ],
    to: options.NewRun = None,
    algorithm: options.Algorithm = None,
    evaluations: options.Evaluations = None,
    hours: options.Hours = None,
    stagnation_generations: options.Stagnation = None,
    least_growth_percent: options.LeastGrowth = None,
    population: options.PopulationSize = None,
    seed: options.Seed = None,
    jobs: options.Jobs = options.CORES,
    pool: options.PoolName = "joblib",
    scheduler: options.Scheduler = None,
    cache: options.UseCache = False,
    json: options.Json = False,
) -> None:
    """Begin a new run with the first generations of another, and go on with another seed or search."""
    from msgspec.structs import replace

    from evodesign.api.sessions import new_directory
    from evodesign.cli.output import show_notes
    from evodesign.interrupts import INTERRUPTS
    from evodesign.runlog.rewrite import begin_branch
    from evodesign.runlog.run import read_run

    old = read_run(run)
    asked = {"algorithm": algorithm, "population": population, "seed": seed}
    given = {name: value for name, value in asked.items() if value is not None}
    settings = replace(old.header.search, **given)
    directory = new_directory(old.header.problem_name) if to is None else to
    INTERRUPTS.run = directory  # what there is of it when an interrupt comes is whole, and can be resumed
    past = begin_branch(old, directory, branch_from, settings)
    show_notes([f"{past} evaluations taken over from {run}; the new run lies in {directory}"])
    resume(
        directory,
        evaluations,
        hours,
        stagnation_generations,
        least_growth_percent,
        jobs,
        pool,
        scheduler,
        cache,
        accept_versions=True,
        json=json,
    )
