"""Samples of people from Python, as `evodesign spread` draws them."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from evodesign.analysis.people_spread import PeopleSpread, spread_of_run
from evodesign.api.people import draw_people, usual_designs, usual_reference
from evodesign.api.run import Run
from evodesign.api.search import display_of
from evodesign.api.sessions import Workers
from evodesign.api.stops import Deadline, Stop
from evodesign.errors import InputError, Interrupted
from evodesign.pool.registry import make_pool
from evodesign.problem.build import build_problem
from evodesign.runlog.run import RunLog, read_run
from evodesign.session import Display


def spread(
    run: Run | str | os.PathLike[str],
    designs: Sequence[int] | None = None,
    *,
    samples: int | None = None,
    reference: int | None = None,
    jobs: int = 1,
    pool: str = "joblib",
    scheduler: str | None = None,
    progress: bool = False,
) -> Run:
    """Evaluate designs of a run beside people drawn from the distribution of measured ones.

    What was evaluated before is not evaluated again. `Run.spread` has the results.

    Args:
        run: opened, or its directory.
        designs: numbers of its designs; left out, those of the front, of a large one the 20 most different.
        samples: how many; left out, the problem's `spread`.
        reference: number of the design that others are compared with; left out, the unscaled robot.
        jobs: evaluations at the same time, each in a process of its own.
        pool: as in `search`.
        scheduler: likewise.
        progress: likewise.
    Returns:
        The run.
    Raises:
        InputError: designs that the run has not, people who cannot be drawn, or nobody says how many.
        RunError: not a run, or another process is writing it.
        Interrupted: stopped by Ctrl-C; what had arrived is kept.
    Example:
        >>> people = evodesign.spread("runs/people", reference=0).spread
        >>> people["samples"], people["reference"]
        (3, 0)
    """
    directory = run.log.directory if isinstance(run, Run) else Path(run)
    opened = read_run(directory)
    workers = Workers(jobs=jobs, pool=pool, scheduler=scheduler)
    spread_over_people(
        opened, designs, samples, reference, workers, display_of(None, progress), Deadline(None)
    )
    return Run(opened)


def spread_over_people(
    run: RunLog,
    designs: Sequence[int] | None,
    samples: int | None,
    reference: int | None,
    workers: Workers,
    display: Display,
    stop: Stop,
) -> PeopleSpread | None:
    """The spread of designs of a run over samples of people; arguments and errors as in `spread`."""
    problem = build_problem(run.header.problem)
    asked = problem.samples if samples is None else samples
    if asked < 2:
        found = "no spread in the problem" if samples is None else f"{samples}"
        raise InputError("samples", "", "how many people to draw, from 2", found)
    chosen = usual_designs(run) if designs is None else designs
    compared = usual_reference(problem, run) if reference is None else reference
    try:
        with (
            make_pool(workers.pool, workers.jobs, workers.scheduler, note=display.note, stop=stop) as pool,
            stop.heeded(),
        ):
            kept = draw_people(run, asked, chosen, compared, pool, display, stop)
    except KeyboardInterrupt:
        raise Interrupted("stopped; what had arrived is kept, and the same call goes on") from None
    return spread_of_run(run, kept)
