"""`resume`: a run that was stopped or killed goes on, or a finished one with a larger budget."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from evodesign.cli import options
from evodesign.errors import InputError, ResumeMismatch

if TYPE_CHECKING:
    from evodesign.records import ProblemSource, RunHeader

__all__ = ["resume"]


def resume(
    run: options.RunPath,
    evaluations: options.Evaluations = None,
    hours: options.Hours = None,
    stagnation_generations: options.Stagnation = None,
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
    from evodesign import evolve
    from evodesign.cli.output import show_notes
    from evodesign.cli.progress import search_progress
    from evodesign.cli.session import factory_of, show_result, with_budgets
    from evodesign.cli.stopping import Stop, resumable
    from evodesign.pool.registry import make_pool
    from evodesign.runlog.header import renewed
    from evodesign.runlog.run import read_run

    def renew(header: RunHeader) -> RunHeader:
        new, remarks = renewed(header, run, accept_versions)
        show_notes(remarks)
        return with_budgets(new, evaluations, hours, stagnation_generations)

    logged = read_run(run).header
    _note_changed_problem(logged.problem)
    stop = Stop(with_budgets(logged, evaluations, hours, stagnation_generations).hours)
    with (
        resumable(run, stop),
        make_pool(pool, jobs, scheduler) as workers,
        search_progress() as observer,
        stop.heeded(),
    ):
        factory = partial(factory_of, pool=workers, cache=cache)
        try:
            done = evolve.resume(run, factory, workers, observer, evaluations, stop=stop, renew=renew)
        except ResumeMismatch as mismatch:
            raise _explained(mismatch, logged) from mismatch
    show_result(done, json=json)


def _note_changed_problem(source: ProblemSource) -> None:
    """Say so if the files that a run was started with hold something else now."""
    from evodesign.cli.output import show_notes
    from evodesign.problem.source import read_source
    from evodesign.runlog.header import source_differences

    try:
        now = read_source(Path(source.path), source.symmetry)
    except InputError:
        return  # moved or gone: the run has its own copy
    if differing := source_differences(source, now):
        show_notes([f"since the run began, {'; '.join(differing)}; it goes on with its own copy"])


def _explained(mismatch: ResumeMismatch, header: RunHeader) -> ResumeMismatch:
    """The mismatch with the versions that may have caused it."""
    from evodesign.runlog.header import version_differences, versions

    differing = version_differences(header.versions, versions())
    return ResumeMismatch(f"{mismatch}; the log is of {', '.join(differing)}") if differing else mismatch
