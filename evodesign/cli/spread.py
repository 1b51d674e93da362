"""`spread`: designs of a run beside people drawn from the distribution of measured ones."""

from __future__ import annotations

from typing import Annotated

import typer

from evodesign.cli import options


def spread(
    run: options.RunPath,
    designs: Annotated[
        list[int] | None,
        typer.Argument(
            min=0, metavar="[DESIGN]...", help="Numbers of designs.", show_default="the front's, 20 at most"
        ),
    ] = None,
    samples: Annotated[
        int | None,
        typer.Option(min=2, max=1000, metavar="N", help="How many.", show_default="spread of the problem"),
    ] = None,
    reference: Annotated[
        int | None,
        typer.Option(
            min=0,
            metavar="DESIGN",
            help="Compare others with this design.",
            show_default="the unscaled robot",
        ),
    ] = None,
    jobs: options.Jobs = options.CORES,
    pool: options.PoolName = "joblib",
    scheduler: options.Scheduler = None,
    json: options.Json = False,
    damaged: options.Damaged = False,
) -> None:
    """Evaluate designs beside people drawn from the measured distribution; nothing is evaluated twice."""
    from evodesign.analysis.people_spread import all_spreads_json, spread_sentence
    from evodesign.api.sessions import Workers
    from evodesign.api.spread import spread_over_people
    from evodesign.cli.output import console, print_json, print_lines, show_notes
    from evodesign.cli.session import DISPLAY, SignalledStop
    from evodesign.cli.tables.spread import spread_table
    from evodesign.runlog.run import read_run

    logged = read_run(run)
    show_notes(logged.notes)
    workers = Workers(jobs=jobs, pool=pool, scheduler=scheduler)
    stop = SignalledStop(None, run=run)
    found = spread_over_people(logged, designs or None, samples, reference, workers, DISPLAY, stop)
    if found is None:
        print_lines("the run has no feasible design")
    elif json:
        print_json({"run": str(run), **all_spreads_json(found)})
    else:
        console().print(spread_table(found, logged.header.objectives, logged.header.constrained))
        print_lines(spread_sentence(found))
    options.end_damaged(logged, accepted=damaged)
