"""Sessions of a search: a run is begun, or gone on with. The command line and Python both do it here."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import datetime
from functools import partial
from pathlib import Path

import msgspec

from evodesign import evolve
from evodesign.api.people import draw_people, usual_designs, usual_reference
from evodesign.api.stops import Deadline, Stop
from evodesign.errors import InputError, Interrupted, ResumeMismatch, RunError
from evodesign.evaluation.evaluate import AssessmentFactory
from evodesign.evaluation.factory import Remembering, evaluation_factory
from evodesign.evaluation.judge import judged_notes
from evodesign.nlp.compiler import NotCompiled
from evodesign.nlp.method import MethodName
from evodesign.nlp.native.calls import method_library
from evodesign.pool.base import Pool
from evodesign.pool.registry import make_pool
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.notes import notes
from evodesign.problem.reread import reread
from evodesign.problem.samples import asked_samples
from evodesign.records import ProblemSource, RunHeader, SearchSettings
from evodesign.runlog.directory import name_in_path, segments
from evodesign.runlog.header import header_of, renewed, source_differences, version_differences, versions
from evodesign.runlog.run import RunLog, read_run, refuse_run
from evodesign.searches.base import JOINT_STARTS
from evodesign.searches.registry import make_asynchronous_search, make_search
from evodesign.session import Display, Evaluate


@dataclass(frozen=True, slots=True)
class Budgets:
    """When a search ends, where not as the problem or the log says.

    Args:
        evaluations: of the run in total.
        hours: wall time of this session; 0 for no limit.
        stagnation_generations: in which the hypervolume may stand still; 0 for any number.
        least_growth_percent: that a doubling of the evaluations must promise; 0 for any.
    """

    evaluations: int | None = None
    hours: float | None = None
    stagnation_generations: int | None = None
    least_growth_percent: float | None = None

    def of(self, header: RunHeader) -> RunHeader:
        """A header with these budgets."""
        hours = header.hours if self.hours is None else self.hours
        stagnation, least = self.stagnation_generations, self.least_growth_percent
        return msgspec.structs.replace(
            header,
            budget=header.budget if self.evaluations is None else self.evaluations,
            hours=hours or None,
            stagnation_generations=header.stagnation_generations if stagnation is None else stagnation,
            least_growth_percent=header.least_growth_percent if least is None else least or msgspec.UNSET,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Workers:
    """Where evaluations run.

    Args:
        jobs: evaluations at the same time.
        pool: serial, joblib or dask.
        scheduler: address of a Dask scheduler.
        cache: whether designs that were evaluated before are looked up, and new ones kept.
    """

    jobs: int = 1
    pool: str = "joblib"
    scheduler: str | None = None
    cache: bool = False


def new_directory(name: str) -> Path:
    """Where a new run of a name lies, unless somebody says."""
    return Path("runs") / f"{name_in_path(name)}-{datetime.now():%Y%m%d-%H%M%S}"


def begin(
    problem: DesignProblem,
    directory: Path,
    settings: SearchSettings,
    budgets: Budgets,
    workers: Workers,
    display: Display,
    make_stop: Callable[[float | None], Stop] = Deadline,
) -> RunLog:
    """Begin a run and use up its budget.

    Args:
        problem: whose designs are searched.
        directory: of the new run.
        settings: of the search.
        budgets: beside those of the problem.
        workers: where evaluations run.
        display: shows the session.
        make_stop: makes the stop of a session of so many hours.
    Raises:
        InputError: settings that no search can use, or a pool that there is not.
        RunError: the directory holds a run already, or cannot be written.
        Interrupted: stopped; what had arrived is logged.
        AllFailed: every evaluation of the first generation, for one reason; nothing of it is logged.
        KeyboardInterrupt: stopped before there was a run.
    """
    for note in notes(problem):
        display.note(note)
    table = problem.search
    header = msgspec.structs.replace(
        header_of(problem, settings, table.evaluations),
        hours=table.hours,
        stagnation_generations=table.stagnation_generations,
        least_growth_percent=table.least_growth_percent or msgspec.UNSET,
    )
    header = budgets.of(header)
    refuse_run(directory)  # before anything takes time; the search's settings too
    (make_asynchronous_search if settings.asynchronous else make_search)(settings)
    stop = make_stop(header.hours)
    with _resumable(directory, stop), _pool(workers, display, stop) as pool:
        factory = _factory(header, pool, workers, display)
        with display.search() as observer, stop.heeded():
            run = evolve.start(directory, header, factory, pool, observer, stop=stop)
        _sampled(run, pool, display, stop)
    return _judged(run, display)


def proceed(
    directory: Path,
    budgets: Budgets,
    workers: Workers,
    display: Display,
    make_stop: Callable[[float | None], Stop] = Deadline,
    *,
    accept_versions: bool = False,
) -> RunLog:
    """Go on with a run that was stopped or killed, or give a finished one a larger budget.

    Args:
        directory: of the run.
        budgets: beside those of the log.
        workers: as in `begin`.
        display: as in `begin`.
        make_stop: as in `begin`.
        accept_versions: go on although packages that decide results have other versions, or another method
            solves.
    Raises:
        RunError: not a run, another process is writing it, or packages or the solver are others.
        ResumeMismatch: the log holds a genome that the rebuilt search does not ask for.
        Interrupted: as in `begin`.
        AllFailed: as in `begin`.
    """

    def renew(header: RunHeader) -> RunHeader:
        new, remarks = renewed(header, directory, accept_versions)
        for remark in remarks:
            display.note(remark)
        return budgets.of(new)

    logged = read_run(directory).header
    if not accept_versions:
        _refuse_other_method(logged, directory)
    _note_changed_problem(logged.problem, display)
    stop = make_stop(budgets.of(logged).hours)
    with (
        _resumable(directory, stop),
        _pool(workers, display, stop) as pool,
    ):
        factory_of = partial(_factory, pool=pool, workers=workers, display=display)
        try:
            with display.search() as observer, stop.heeded():
                run = evolve.resume(
                    directory, factory_of, pool, observer, budgets.evaluations, stop=stop, renew=renew
                )
        except ResumeMismatch as mismatch:
            raise _explained(mismatch, logged) from mismatch
        _sampled(run, pool, display, stop)
    return _judged(run, display)


def _pool(workers: Workers, display: Display, stop: Stop) -> Pool:
    return make_pool(workers.pool, workers.jobs, workers.scheduler, note=display.note, stop=stop)


def _sampled(run: RunLog, pool: Pool, display: Display, stop: Stop) -> None:
    """Evaluate the front of an ended search beside the samples of people that its problem asks for."""
    samples, designs = asked_samples(run.header.problem), usual_designs(run)
    if samples and designs and run.header.search.algorithm != JOINT_STARTS:
        reference = usual_reference(build_problem(run.header.problem), run)
        with stop.heeded():
            draw_people(run, samples, designs, reference, pool, display, stop)


def _judged(run: RunLog, display: Display) -> RunLog:
    """The run, after a word on each design of which IPOPT thinks otherwise."""
    for note in judged_notes(run.evaluations):
        display.note(note)
    return run


def _factory(header: RunHeader, pool: Pool, workers: Workers, display: Display) -> Evaluate:
    """The evaluation of a header's problem; the pool works out what is missing for it."""
    with display.precompute() as progress:
        factory = evaluation_factory(header, pool, progress)
    if workers.cache and isinstance(factory, AssessmentFactory):  # a start is no design to know again
        return Remembering(factory)
    return factory


@contextmanager
def _resumable(directory: Path, stop: Stop) -> Iterator[None]:
    """Turn a stop into an error that says how to go on, also one after the loop; none if there is no run."""
    try:
        yield
    except KeyboardInterrupt:
        if not segments(directory):
            raise
        raise Interrupted(f"stopped; go on with: evodesign resume {directory}") from None
    except Interrupted as interrupted:
        raise Interrupted(f"{stop.why}: {interrupted}" if stop.why else f"{interrupted}") from None


def _refuse_other_method(header: RunHeader, directory: Path) -> None:
    """Refuse a run of the native method where only IPOPT can solve: results differ in their last digits."""
    native = header.problem.method == MethodName.NATIVE
    if native and isinstance(lacking := method_library(), NotCompiled):
        raise RunError(
            f"{directory}: its designs were solved by the native method, which is not to be had here "
            f"({lacking.reason}); mend that, or go on with IPOPT all the same with --accept-versions"
        )


def _note_changed_problem(source: ProblemSource, display: Display) -> None:
    """Say so if the files that a run was started with, here or below, hold something else now."""
    try:
        now = reread(source, Path())
    except InputError:
        return  # moved, gone or never a file: the run has its own copy
    if differing := source_differences(source, now):
        display.note(f"since the run began, {'; '.join(differing)}; it goes on with its own copy")


def _explained(mismatch: ResumeMismatch, header: RunHeader) -> ResumeMismatch:
    """The mismatch with the versions that may have caused it."""
    differing = version_differences(header.versions, versions())
    return ResumeMismatch(f"{mismatch}; the log is of {', '.join(differing)}") if differing else mismatch
