"""Searching from Python, as `evodesign search` and `evodesign resume` do: logged, parallel, resumable."""

from __future__ import annotations

import logging
import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from evodesign.api.design import Design
from evodesign.api.problem import Problem, open_problem
from evodesign.api.progress_lines import PrecomputeLines, SearchLines
from evodesign.api.run import Run, open_run
from evodesign.api.sessions import Budgets, Workers, begin, new_directory, proceed
from evodesign.api.stops import Deadline
from evodesign.errors import InputError, Interrupted
from evodesign.evaluation.progress import SILENT, PrecomputeProgress
from evodesign.records import Constraint, Evaluation, Generation, RunHeader
from evodesign.runlog.run import RunLog
from evodesign.runlog.session_log import Observer
from evodesign.session import Display

LOGGER = logging.getLogger("evodesign")
"""Hears what is strange about a problem or a run, at the level of information."""

Callback = Callable[[Design | Generation], object]
"""Is called with each evaluated design, and with the state of the run after each generation."""


def search(
    problem: Problem | str | os.PathLike[str],
    run: str | os.PathLike[str] | None = None,
    *,
    algorithm: str | None = None,
    evaluations: int | None = None,
    population: int | None = None,
    seed: int | None = None,
    asynchronous: bool | None = None,
    hours: float | None = None,
    stagnation_generations: int | None = None,
    least_growth_percent: float | None = None,
    jobs: int = 1,
    pool: str = "joblib",
    scheduler: str | None = None,
    cache: bool = False,
    callback: Callback | None = None,
    progress: bool = False,
) -> Run:
    """Search the designs of a problem in a run of its own; every evaluation is logged when it has arrived.

    What is left out is as in the problem file. The run is the one that `evodesign search` would make of the
    same problem and settings, whatever the number of jobs, and either can go on with the other's.

    Args:
        problem: opened, a problem file, or the name of one that comes with evodesign.
        run: directory of the new run; left out, `runs/NAME-TIME`.
        algorithm: surrogate, nsga2, cma-es, random, or any other in the registry of searches.
        evaluations: of the run in total.
        population: evaluations of a generation.
        seed: of the search.
        asynchronous: whether no worker waits for the slowest evaluation of a generation.
        hours: wall time [h]; at its end the run is returned as it is, and can be resumed.
        stagnation_generations: end when the hypervolume has not grown for so many.
        least_growth_percent: end when not one in ten searches would grow by so much with as many evaluations.
        jobs: evaluations at the same time, each in a process of its own.
        pool: joblib, dask, or serial for this process.
        scheduler: address of a Dask scheduler.
        cache: look up designs that were evaluated before, and keep new ones.
        callback: called with a `Design` after each evaluation and a `Generation` after each generation; what
            it raises ends the session, and the run can be resumed.
        progress: show a line per generation on standard error.
    Returns:
        The run, also when `hours` ended it.
    Raises:
        InputError: a problem, setting or pool that cannot be used.
        RunError: the directory holds a run already, or cannot be written.
        Interrupted: stopped by Ctrl-C (in a notebook: the stop button); `resume` goes on.
        AllFailed: every evaluation of the first generation, for one reason; `resume` evaluates it again.
    Example:
        >>> new = evodesign.search("problem.toml", "runs/new", evaluations=4, population=4, pool="serial")
        >>> len(new)
        4
    """
    opened = problem if isinstance(problem, Problem) else open_problem(problem)
    _at_least(1, evaluations=evaluations, jobs=jobs)
    _at_least(2, population=population)
    _at_least(0, seed=seed, hours=hours, stagnation_generations=stagnation_generations)
    _at_least(0, least_growth_percent=least_growth_percent)
    directory = new_directory(opened.name) if run is None else Path(run)
    built = opened.built
    settings = built.settings(algorithm, population, seed, asynchronous)
    budgets = Budgets(evaluations, hours, stagnation_generations, least_growth_percent)
    workers = Workers(jobs=jobs, pool=pool, scheduler=scheduler, cache=cache)
    display = display_of(callback, progress)
    with _ended_by_time() as deadline:
        return Run(begin(built, directory, settings, budgets, workers, display, deadline))
    return open_run(directory)


def resume(
    run: Run | str | os.PathLike[str],
    *,
    evaluations: int | None = None,
    hours: float | None = None,
    stagnation_generations: int | None = None,
    least_growth_percent: float | None = None,
    jobs: int = 1,
    pool: str = "joblib",
    scheduler: str | None = None,
    cache: bool = False,
    accept_versions: bool = False,
    callback: Callback | None = None,
    progress: bool = False,
) -> Run:
    """Go on with a run that was stopped or killed, or give a finished one a larger budget.

    Args:
        run: opened, or its directory.
        evaluations: of the run in total; left out, as many as it was to have.
        hours: as in `search`, as the other arguments are.
        stagnation_generations: 0 for never.
        least_growth_percent: likewise.
        jobs: may differ from those before.
        pool: likewise.
        scheduler: likewise.
        cache: likewise.
        accept_versions: go on although packages that decide results have other versions.
        callback: is not called for what the log holds already.
        progress: likewise.
    Raises:
        RunError: not a run, another process is writing it, or packages have other versions.
        ResumeMismatch: the log holds a genome that the search does not ask for.
        Interrupted: as in `search`.
        AllFailed: as in `search`.
    Example:
        >>> short = evodesign.search("problem.toml", "runs/short", evaluations=2, population=2, pool="serial")
        >>> len(evodesign.resume(short, evaluations=4, pool="serial"))
        4
    """
    _at_least(1, evaluations=evaluations, jobs=jobs)
    _at_least(0, hours=hours, stagnation_generations=stagnation_generations)
    _at_least(0, least_growth_percent=least_growth_percent)
    directory = run.log.directory if isinstance(run, Run) else Path(run)
    budgets = Budgets(evaluations, hours, stagnation_generations, least_growth_percent)
    workers = Workers(jobs=jobs, pool=pool, scheduler=scheduler, cache=cache)
    display = display_of(callback, progress)
    with _ended_by_time() as deadline:
        return Run(proceed(directory, budgets, workers, display, deadline, accept_versions=accept_versions))
    return open_run(directory)


def _at_least(least: int, **given: float | None) -> None:
    for name, value in given.items():
        if value is not None and not value >= least:
            raise InputError(name, "", f"a number from {least}", f"{value}")


@contextmanager
def _ended_by_time() -> Iterator[Callable[[float | None], Deadline]]:
    """Makes the stop of a session; where its time ends a run that has begun, that is no error."""
    made: list[Deadline] = []

    def deadline(hours: float | None) -> Deadline:
        made.append(Deadline(hours))
        return made[-1]

    try:
        yield deadline
    except Interrupted:
        if not (made and made[-1].over):
            raise


class _Calls(Observer):
    """Shows a session to a callback, and to an observer."""

    def __init__(self, callback: Callback, shown: Observer) -> None:
        self._callback = callback
        self._shown = shown
        self._bounds: tuple[Constraint, ...] = ()

    def started(self, header: RunHeader, evaluations_done: int) -> None:
        self._bounds = header.constrained
        self._shown.started(header, evaluations_done)

    def evaluated(self, evaluation: Evaluation, done: int, budget: int) -> None:
        self._shown.evaluated(evaluation, done, budget)
        self._callback(Design(evaluation.number, evaluation.assessment, bounds=self._bounds))

    def generation_done(self, generation: Generation) -> None:
        self._shown.generation_done(generation)
        self._callback(generation)

    def finished(self, run: RunLog) -> None:
        self._shown.finished(run)


def display_of(callback: Callback | None, progress: bool) -> Display:
    """What shows a session to a callback, and with `progress` on standard error."""

    @contextmanager
    def shown_search() -> Iterator[Observer]:
        shown = SearchLines(sys.stderr) if progress else Observer()
        yield shown if callback is None else _Calls(callback, shown)

    @contextmanager
    def shown_precompute() -> Iterator[PrecomputeProgress]:
        yield PrecomputeLines(sys.stderr) if progress else SILENT

    return Display(LOGGER.info, shown_precompute, shown_search)
