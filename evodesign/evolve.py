"""The loop: ask, evaluate, remember, tell.

A search is told only what is on the disk. Starting and resuming are the same loop: it begins with a fresh
search each time, and an evaluation that the log holds is compared and told instead of repeated (resume by
replay). Whatever the number of workers, evaluations are logged in order of number, so that

    start with a budget of 2n  =  start with a budget of n, then resume with 2n,

but for times and names of workers. The last generation is cut where the budget ends; a cut generation is
neither concluded nor told, and a later session with a larger budget completes it.
"""

from __future__ import annotations

import functools
import time
from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import msgspec

from evodesign.analysis.front import RunningFront, front, minimised
from evodesign.analysis.hypervolume import best, hypervolume, reference_point
from evodesign.errors import Interrupted, RunError
from evodesign.pool.base import Factory, Pool
from evodesign.records import (
    Assessed,
    Evaluation,
    Front,
    Generation,
    Genome,
    RunHeader,
    SearchSettings,
)
from evodesign.runlog.arrival import Arrival, arrival_of
from evodesign.runlog.directory import locked, make_directory, run_segments
from evodesign.runlog.memory import Memory
from evodesign.runlog.observer import Observer, Silent
from evodesign.runlog.run import Run, read_run
from evodesign.runlog.writer import RunWriter
from evodesign.search import registry
from evodesign.search.base import Outcome, Search

__all__ = ["MakeSearch", "Observer", "Silent", "resume", "start"]

MakeSearch = Callable[[SearchSettings], Search]
Evaluate = Factory[Genome, Assessed]


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
) -> Run:
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
    """
    search = make_search(header.search)
    make_directory(directory)
    with locked(directory):
        log = RunWriter(directory, header)
        fresh = Run(directory, header, (), (), (), (), complete=False, notes=())
        with log, Memory(fresh, lambda: log) as memory:
            running = RunningFront(header.objectives)
            _work(_Session(directory, header, memory, lambda: factory, pool, observer, stop, running), search)
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
) -> Run:
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
        search = make_search(header.search)
        factory = functools.cache(lambda: factory_of(header))
        with Memory(run, lambda: RunWriter.next_segment(directory, header)) as memory:
            running = RunningFront(header.objectives)
            _work(_Session(directory, header, memory, factory, pool, observer, stop, running), search)
        return _finished(directory, observer)


@dataclass(frozen=True, slots=True)
class _Session:
    """What the loop works with."""

    directory: Path
    header: RunHeader
    memory: Memory
    factory: Callable[[], Evaluate]
    pool: Pool
    observer: Observer
    stop: Callable[[], bool]
    front: RunningFront


def _work(session: _Session, search: Search) -> None:
    """Run the loop; a stop becomes an error that says how to go on."""
    session.observer.started(session.header, session.memory.evaluations)
    try:
        _evolve(session, search)
    except KeyboardInterrupt:
        raise Interrupted(
            f"stopped after {session.memory.evaluations} of {session.header.budget} evaluations; "
            f"go on with: evodesign resume {session.directory}"
        ) from None


def _finished(directory: Path, observer: Observer) -> Run:
    run = read_run(directory)
    observer.finished(run)
    return run


def _evolve(session: _Session, search: Search) -> None:
    """Go through all generations, from the first one on, until the budget is used up."""
    done: list[Evaluation] = []
    reference: dict[str, float] | None = None
    generation = 0
    while len(done) < session.header.budget:
        begun = time.perf_counter()
        genomes = _ask(session, search)
        born = _evaluate(session, generation, len(done), genomes[: session.header.budget - len(done)])
        done += born
        if len(born) < len(genomes):
            session.memory.commit()
            return
        reference = _conclude(session, generation, done, born, reference, begun)
        search.tell([_outcome(session.header, evaluation) for evaluation in born])
        generation += 1


def _ask(session: _Session, search: Search) -> list[Genome]:
    """The next generation's genomes, of Python numbers, so that they are equal to their copies in the log."""
    genomes = [tuple(float(coordinate) for coordinate in genome) for genome in search.ask()]
    if not genomes:
        name = session.header.search.algorithm
        raise RunError(f"{session.directory}: the search '{name}' asks for no further designs")
    return genomes


def _outcome(header: RunHeader, evaluation: Evaluation) -> Outcome:
    values = minimised(header.objectives, evaluation.assessment)
    return Outcome(objectives=values, violation=evaluation.assessment.violation)


def _evaluate(session: _Session, generation: int, first: int, genomes: Sequence[Genome]) -> list[Evaluation]:
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
    session: _Session, generation: int, missing: Mapping[int, Genome]
) -> dict[int, Evaluation]:
    """Evaluate genomes by number; log them in order of number, whatever the order in which they arrive.

    Raises:
        KeyboardInterrupt: by Ctrl-C or because `stop` asks for it; everything that had arrived is logged.
    """
    numbers, genomes = list(missing), list(missing.values())
    logged: dict[int, Evaluation] = {}
    early: dict[int, Arrival] = {}
    _heed(session.stop)
    results = session.pool.run(session.factory(), genomes)
    try:
        for finished in results:
            number = numbers[finished.index]
            parameters = session.header.parameters
            early[number] = arrival_of(number, generation, missing[number], parameters, finished)
            while len(logged) < len(numbers) and (due := numbers[len(logged)]) in early:
                _remember(session, early[due])
                logged[due] = early.pop(due).evaluation
            if len(logged) < len(numbers):
                _heed(session.stop)
    except BaseException:
        with suppress(RunError):  # the error on its way says more than a log that cannot be written
            for number in sorted(early):
                _remember(session, early[number])
        raise
    finally:
        if isinstance(results, Generator):
            results.close()
    return logged


def _heed(stop: Callable[[], bool]) -> None:
    """Do as Ctrl-C does if a stop is asked for."""
    if stop():
        raise KeyboardInterrupt


def _remember(session: _Session, arrival: Arrival) -> None:
    """Put an evaluation on the disk, with its postures if nothing so far beats it."""
    evaluation = arrival.evaluation
    session.memory.remember(evaluation, arrival.detail if session.front.enters(evaluation) else None)
    session.observer.evaluated(evaluation, session.memory.evaluations, session.header.budget)


def _conclude(
    session: _Session,
    generation: int,
    done: Sequence[Evaluation],
    born: Sequence[Evaluation],
    reference: dict[str, float] | None,
    begun: float,
) -> dict[str, float] | None:
    """Put a generation on the disk, with its state and front unless they are known; give the reference."""
    known = session.memory.generation(generation)
    if known is not None:
        session.memory.commit()
        return known.reference
    objectives = session.header.objectives
    reference = reference or reference_point(objectives, done)
    state = Generation(
        number=generation,
        evaluations=len(done),
        feasible_share=sum(evaluation.feasible for evaluation in born) / len(born),
        hypervolume=None if reference is None else hypervolume(objectives, done, reference),
        reference=reference,
        best=best(objectives, done),
        seconds=time.perf_counter() - begun,
    )
    numbers = tuple(evaluation.number for evaluation in front(objectives, done))
    session.memory.conclude(state, Front(generation=generation, evaluations=numbers))
    session.memory.commit()
    session.observer.generation_done(state)
    return reference
