"""`resume`: a run that was stopped or killed goes on, or a finished one with a larger budget."""

from __future__ import annotations

from functools import partial
from typing import Annotated

import typer

from evodesign.cli import options


def resume(
    run: options.RunPath,
    evaluations: options.Evaluations = None,
    hours: options.Hours = None,
    stagnation_generations: options.Stagnation = None,
    least_growth_percent: options.LeastGrowth = None,
    jobs: options.Jobs = options.CORES,
    pool: options.PoolName = "joblib",
    scheduler: options.Scheduler = None,
    cache: options.UseCache = False,
    accept_versions: Annotated[
        bool, typer.Option("--accept-versions", help="Go on although packages have other versions.")
    ] = False,
    json: options.Json = False,
) -> None:
    """Go on with a run that was stopped or killed, or give a finished one a larger budget."""
    from evodesign.api.sessions import Budgets, Workers, proceed
    from evodesign.cli.session import DISPLAY, SignalledStop, show_result

    done = proceed(
        run,
        Budgets(evaluations, hours, stagnation_generations, least_growth_percent),
        Workers(jobs=jobs, pool=pool, scheduler=scheduler, cache=cache),
        DISPLAY,
        partial(SignalledStop, run=run),
        accept_versions=accept_versions,
    )
    show_result(done, json=json)
