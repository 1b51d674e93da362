"""The loop: ask, evaluate, remember, tell.

A search is told only what is on the disk. Starting and resuming are the same loop: it begins with a fresh
search each time, and an evaluation that the log holds is compared and told instead of repeated (resume by
replay). An evaluation is on the disk as soon as it has arrived. Whatever the number of workers and the order
of arrival,

    start with a budget of 2n  =  start with a budget of n, then resume with 2n,

but for times and names of workers. The last generation is cut where the budget ends; a cut generation is
neither concluded nor told, and a later session with a larger budget completes it. A stop finishes what is in
flight; what was not yet handed out is left to a later session as well.
"""

from __future__ import annotations

import functools
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import closing, suppress
from pathlib import Path
from typing import NoReturn

import msgspec

from evodesign.analysis.front import RunningFront
from evodesign.analysis.run_state import RunState
from evodesign.asynchronous import evolve_asynchronously
from evodesign.errors import Interrupted, RunError
from evodesign.pool.base import Pool
from evodesign.pool.dispatch import run_stoppable
from evodesign.pool.worker import SerialPool
from evodesign.records import Evaluation, Genome, RunHeader, SearchSettings
from evodesign.runlog.directory import locked, make_directory, run_segments
from evodesign.runlog.run import RunLog, read_run
from evodesign.runlog.session_log import Observer, SessionLog, Silent
from evodesign.runlog.writer import RunWriter
from evodesign.searches import registry
from evodesign.searches.base import Search
from evodesign.session import (
    Evaluate,
    Session,
    conclude,
    evaluation_outcome,
    remember,
    search_outcome,
    settle,
)

MakeSearch = Callable[[SearchSettings], Search]


def never() -> bool:
    """A stop that is never asked for."""
    return False


def start(
    directory: Path,
    header: RunHeader,
    factory: Evaluate,
    pool: Pool,
    observer: Observer,
    *,
    stop: Callable[[], bool] = never,
    make_search: MakeSearch = registry.make_search,
) -> RunLog:
    """Begin a run and use up its budget.

    Args:
        directory: of the new run; made when missing.
        header: problem, search and budget.
        factory: makes the evaluation of a genome in a worker.
        pool: where evaluations run; its owner closes it.
        observer: is shown what happens.
        stop: asked before waiting for each evaluation; True ends the session.
        make_search: makes the search that the header's settings describe.
    Raises:
        InputError: settings that no search can use.
        RunError: the directory holds a run already, or cannot be written.
        Interrupted: stopped, by `stop` or by Ctrl-C; what had arrived is logged.
        AllFailed: every evaluation of the first generation, for one reason; nothing of it is logged.
    """
    evolve = _loop(header.search, make_search)
    make_directory(directory)
    with locked(directory):
        log = RunWriter(directory, header)
        fresh = RunLog(directory, header, (), (), (), (), complete=False, notes=())
        with log, SessionLog(fresh, lambda: log) as memory:
            running = RunningFront(header.objectives)
            _work(Session(directory, header, memory, lambda: factory, pool, observer, stop, running), evolve)
        return _finished(directory, observer)


def resume(
    directory: Path,
    factory_of: Callable[[RunHeader], Evaluate],
    pool: Pool,
    observer: Observer,
    budget: int | None,
    *,
    stop: Callable[[], bool] = never,
    make_search: MakeSearch = registry.make_search,
    renew: Callable[[RunHeader], RunHeader] = lambda header: header,
) -> RunLog:
    """Go on with a run, until its budget is used up.

    Args:
        directory: of the run.
        factory_of: rebuilds the evaluation from the header's problem; called when something is missing.
        pool: as in `start`.
        observer: as in `start`.
        budget: the run's new total of evaluations; None for the one that it has.
        stop: as in `start`.
        make_search: as in `start`.
        renew: the header as this session writes it, with its own versions and time of start.
    Raises:
        RunError: not a run, or another process is writing it.
        ResumeMismatch: the log holds a genome that the rebuilt search does not ask for.
        Interrupted: as in `start`.
    """
    run_segments(directory)
    with locked(directory):
        run = read_run(directory)
        total = run.header.budget if budget is None else budget
        header = msgspec.structs.replace(renew(run.header), budget=total)
        evolve = _loop(header.search, make_search)
        factory = functools.cache(lambda: factory_of(header))
        with SessionLog(run, lambda: RunWriter.next_segment(directory, header)) as memory:
            running = RunningFront(header.objectives)
            _work(Session(directory, header, memory, factory, pool, observer, stop, running), evolve)
        return _finished(directory, observer)


class _EndOfLog(Exception):
    """A replay has come to where the log ends."""


def replay(run: RunLog, *, make_search: MakeSearch = registry.make_search) -> None:
    """Ask and tell all that a run's log holds, as `resume` does, evaluating and writing nothing.

    Raises:
        ResumeMismatch: the log holds a genome that the rebuilt search does not ask for.
    """

    def end() -> NoReturn:
        raise _EndOfLog

    last = max((evaluation.number for evaluation in run.evaluations), default=-1)
    header = msgspec.structs.replace(
        run.header, budget=1 + last, stagnation_generations=None, least_growth_percent=msgspec.UNSET
    )
    running = RunningFront(header.objectives)
    with SessionLog(run, end) as memory, SerialPool() as pool, suppress(_EndOfLog):
        evolve = _loop(header.search, make_search)
        evolve(Session(run.directory, header, memory, end, pool, Silent(), never, running))


def _loop(settings: SearchSettings, make_search: MakeSearch) -> Callable[[Session], None]:
    """The loop that suits the settings, with its search ready to ask."""
    if settings.asynchronous:
        return functools.partial(evolve_asynchronously, search=registry.make_asynchronous_search(settings))
    return functools.partial(_evolve, search=make_search(settings))


def _work(session: Session, evolve: Callable[[Session], None]) -> None:
    """Run the loop; a stop becomes an error that says how to go on."""
    session.observer.started(session.header, session.memory.evaluations)
    try:
        evolve(session)
    except KeyboardInterrupt:
        raise Interrupted(
            f"stopped after {session.memory.evaluations} of {session.header.budget} evaluations; "
            f"go on with: evodesign resume {session.directory}"
        ) from None


def _finished(directory: Path, observer: Observer) -> RunLog:
    run = read_run(directory)
    observer.finished(run)
    return run


def _evolve(session: Session, search: Search) -> None:
    """Go through all generations, from the first one on, until the budget is used up or nothing is gained."""
    run_state = RunState(session.header.objectives)
    done = generation = 0
    while done < session.header.budget:
        _heed(session.stop)
        begun = time.perf_counter()
        genomes = _ask(session, search)
        born = _evaluate(session, generation, done, genomes[: session.header.budget - done])
        settle(session, min(len(genomes), session.header.budget))
        done += len(born)
        if len(born) < len(genomes):
            return
        conclude(session, generation, run_state, born, begun)
        if run_state.over(session.header):
            return
        search.tell([search_outcome(session.header, evaluation) for evaluation in born])
        generation += 1


def _ask(session: Session, search: Search) -> list[Genome]:
    """The next generation's genomes, of Python numbers, so that they are equal to their copies in the log."""
    genomes = [tuple(float(coordinate) for coordinate in genome) for genome in search.ask()]
    if not genomes:
        name = session.header.search.algorithm
        raise RunError(f"{session.directory}: the search '{name}' asks for no further designs")
    return genomes


def _evaluate(session: Session, generation: int, first: int, genomes: Sequence[Genome]) -> list[Evaluation]:
    """Evaluations of a generation's genomes, numbered from `first`; those that are known are not repeated."""
    known = {
        number: evaluation
        for number, genome in enumerate(genomes, first)
        if (evaluation := session.memory.recall(number, genome)) is not None
    }
    for evaluation in known.values():
        session.front.enters(evaluation)
    missing = {number: genome for number, genome in enumerate(genomes, first) if number not in known}
    if missing:
        known |= _evaluate_missing(session, generation, missing)
    return [known[number] for number in range(first, first + len(genomes))]


def _evaluate_missing(
    session: Session, generation: int, missing: Mapping[int, Genome]
) -> dict[int, Evaluation]:
    """Evaluate genomes by number; each evaluation is on the disk before the next is looked at."""
    numbers, parameters = list(missing), session.header.parameters
    arrived: dict[int, Evaluation] = {}
    results = run_stoppable(session.pool, session.factory(), missing.values(), session.stop)
    with closing(results):
        for finished in results:
            number = numbers[finished.index]
            outcome = evaluation_outcome(number, generation, missing[number], parameters, finished)
            remember(session, outcome, more=finished.more)
            arrived[number] = outcome.evaluation
    if len(arrived) < len(missing):
        raise KeyboardInterrupt
    return arrived


def _heed(stop: Callable[[], bool]) -> None:
    """Do as Ctrl-C does if a stop is asked for."""
    if stop():
        raise KeyboardInterrupt
