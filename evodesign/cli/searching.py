"""`search` and `resume`: the loop with its pool, its log and someone who watches."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import datetime
from functools import partial
from pathlib import Path

import msgspec

from evodesign import evolve
from evodesign.cli.fronts import show_run
from evodesign.cli.making import making
from evodesign.cli.output import show_notes
from evodesign.cli.progress import observer
from evodesign.cli.stopping import Stop
from evodesign.errors import InputError, Interrupted, ResumeMismatch
from evodesign.pool.base import Pool
from evodesign.pool.registry import make_pool
from evodesign.problem.build import build_problem
from evodesign.problem.evaluate import AssessmentFactory
from evodesign.problem.evaluation_cache import Remembering
from evodesign.problem.factory import evaluation_factory
from evodesign.problem.notes import notes
from evodesign.problem.source import read_source
from evodesign.records import ProblemSource, RunHeader, SearchSettings
from evodesign.runlog.branch import begin_branch
from evodesign.runlog.difference import source_differences, version_differences
from evodesign.runlog.directory import name_in_path, refuse_run, segments
from evodesign.runlog.header import header_of, renewed, versions
from evodesign.runlog.run import Run, read_run
from evodesign.search.registry import make_asynchronous_search, make_search
from evodesign.session import Evaluate

__all__ = ["BranchPoint", "Budgets", "Wishes", "Workers", "branch", "go_on", "start"]


@dataclass(frozen=True, slots=True)
class Budgets:
    """What ends a session, as the command line says; None leaves it to the run or the problem file."""

    evaluations: int | None
    hours: float | None
    stagnation_generations: int | None

    def applied(self, header: RunHeader) -> RunHeader:
        """The header with these budgets."""
        hours = header.hours if self.hours is None else self.hours or None
        stagnation = self.stagnation_generations
        return msgspec.structs.replace(
            header,
            budget=header.budget if self.evaluations is None else self.evaluations,
            hours=hours,
            stagnation_generations=header.stagnation_generations if stagnation is None else stagnation,
        )


@dataclass(frozen=True, slots=True)
class Wishes:
    """What the command line says about a search; None leaves it to the problem file."""

    algorithm: str | None
    population: int | None
    seed: int | None
    asynchronous: bool | None

    def applied(self, settings: SearchSettings) -> SearchSettings:
        """The settings as wished."""
        return msgspec.structs.replace(
            settings,
            algorithm=settings.algorithm if self.algorithm is None else self.algorithm,
            population=settings.population if self.population is None else self.population,
            seed=settings.seed if self.seed is None else self.seed,
            asynchronous=settings.asynchronous if self.asynchronous is None else self.asynchronous,
        )


@dataclass(frozen=True, slots=True)
class Workers:
    """Where evaluations run, and whether they are kept for other runs."""

    pool: str
    jobs: int
    scheduler: str | None
    cache: bool

    def made(self) -> Pool:
        """The pool, ready to work."""
        return make_pool(self.pool, self.jobs, self.scheduler)

    def factory(self, header: RunHeader, pool: Pool) -> Evaluate:
        """The evaluation of a header's problem; the pool works out what is missing for it."""
        with making() as progress:
            factory = evaluation_factory(header, pool, progress)
        if self.cache and isinstance(factory, AssessmentFactory):  # a start is no design to know again
            return Remembering(factory)
        return factory


@dataclass(frozen=True, slots=True)
class BranchPoint:
    """After which generation a branch leaves its run, and in which directory it goes on."""

    generation: int
    directory: Path | None


def start(
    path: Path,
    run: Path | None,
    wishes: Wishes,
    budgets: Budgets,
    workers: Workers,
    symmetry: str | None,
    json: bool,
) -> None:
    """Search a problem in a new run directory and print the front."""
    problem = build_problem(read_source(path, symmetry))
    show_notes(notes(problem))
    table = problem.search
    algorithm = table.algorithm if wishes.algorithm is None else wishes.algorithm  # its start depends on it
    settings = problem.settings(algorithm, table.population, table.seed, table.asynchronous)
    settings = wishes.applied(settings)
    header = header_of(problem, settings, table.evaluations)
    header = msgspec.structs.replace(
        header, hours=table.hours, stagnation_generations=table.stagnation_generations
    )
    header = budgets.applied(header)
    directory = _new_directory(problem.name) if run is None else run
    refuse_run(directory)  # before anything takes time; the search's settings too
    (make_asynchronous_search if settings.asynchronous else make_search)(settings)
    stop = Stop(header.hours)
    with _resumable(directory, stop), workers.made() as pool:
        factory = workers.factory(header, pool)
        with observer() as watching, stop.heeded():
            done = evolve.start(directory, header, factory, pool, watching, stop=stop)
    _show_result(done, json)


def go_on(run: Path, budgets: Budgets, workers: Workers, accept_versions: bool, json: bool) -> None:
    """Resume a run and print the front."""
    header = read_run(run).header
    _note_changed_problem(header.problem)
    stop = Stop(budgets.applied(header).hours)

    def renew(header: RunHeader) -> RunHeader:
        new, remarks = renewed(header, run, accept_versions)
        show_notes(remarks)
        return budgets.applied(new)

    with (
        _resumable(run, stop),
        workers.made() as pool,
        observer() as watching,
        stop.heeded(),
    ):
        try:
            done = evolve.resume(
                run,
                partial(workers.factory, pool=pool),
                pool,
                watching,
                budgets.evaluations,
                stop=stop,
                renew=renew,
            )
        except ResumeMismatch as mismatch:
            raise _explained(mismatch, header) from mismatch
    _show_result(done, json)


def branch(
    run: Path, turn: BranchPoint, wishes: Wishes, budgets: Budgets, workers: Workers, json: bool
) -> None:
    """Begin a new run with the first generations of another one, go on with it and print the front."""
    old = read_run(run)
    directory = _new_directory(old.header.problem_name) if turn.directory is None else turn.directory
    past = begin_branch(old, directory, turn.generation, wishes.applied(old.header.search))
    show_notes([f"{past} evaluations taken over from {run}; the new run lies in {directory}"])
    go_on(directory, budgets, workers, accept_versions=True, json=json)


def _note_changed_problem(source: ProblemSource) -> None:
    """Say so if the files that a run was started with hold something else now."""
    try:
        now = read_source(Path(source.path), source.symmetry)
    except InputError:
        return  # moved or gone: the run has its own copy
    if differing := source_differences(source, now):
        show_notes([f"since the run began, {'; '.join(differing)}; it goes on with its own copy"])


def _explained(mismatch: ResumeMismatch, header: RunHeader) -> ResumeMismatch:
    """The mismatch with the versions that may have caused it."""
    differing = version_differences(header.versions, versions())
    return ResumeMismatch(f"{mismatch}; the log is of {', '.join(differing)}") if differing else mismatch


def _new_directory(name: str) -> Path:
    return Path("runs") / f"{name_in_path(name)}-{datetime.now():%Y%m%d-%H%M%S}"


def _show_result(run: Run, json: bool) -> None:
    """The front, and why the search ended if it was not for its budget of evaluations."""
    if len(run.evaluations) < run.header.budget:
        show_notes(
            [
                f"ended after {len(run.evaluations)} of {run.header.budget} evaluations: the hypervolume "
                f"stood still for {run.header.stagnation_generations} generations; to go on all the same: "
                f"evodesign resume {run.directory} --stagnation-generations 0"
            ]
        )
    show_run(run, json)


@contextmanager
def _resumable(directory: Path, stop: Stop) -> Iterator[None]:
    """BranchPoint a stop into an error that says how to go on, also one before or after the loop itself."""
    try:
        yield
    except KeyboardInterrupt:
        hint = f"; go on with: evodesign resume {directory}" if segments(directory) else ""
        raise Interrupted(f"stopped{hint}") from None
    except Interrupted as interrupted:
        raise Interrupted(f"{stop.why}: {interrupted}" if stop.why else f"{interrupted}") from None
