"""The asynchronous loop: no worker waits for the slowest evaluation of a generation.

The search is told every outcome as it comes, and asked for a genome whenever a worker is free. The log holds
the evaluations in the order in which they came, and what the search knew at each turn, so that it is replayed
as any other; a session that goes on from there asks again for what was in flight.
"""

from __future__ import annotations

import time
from collections.abc import Generator, Iterator, Mapping
from contextlib import closing

from evodesign.analysis.run_state import RunState
from evodesign.pool.dispatch import run_stoppable
from evodesign.records import Evaluation, Genome, Turn
from evodesign.searches.base import AsynchronousSearch
from evodesign.session import (
    Session,
    conclude,
    evaluation_outcome,
    remember,
    search_outcome,
    settle,
)


def evolve_asynchronously(session: Session, search: AsynchronousSearch) -> None:
    """Keep all workers busy until the budget is used up or nothing is gained.

    Every end is told at once, and every free worker asks. As many evaluations as the population, in the order
    in which they came, are a generation.
    """
    run_state = RunState(session.header.objectives)
    begun, born = time.perf_counter(), list[Evaluation]()
    population = session.header.search.population
    whole = min(population, session.header.budget)
    with closing(_asynchronous_evaluations(session, search)) as evaluations:
        for evaluation in evaluations:
            born.append(evaluation)
            if len(born) == population:
                settle(session, whole)
                conclude(session, evaluation.generation, run_state, born, begun)
                if run_state.over(session.header):
                    return
                begun, born = time.perf_counter(), []
    settle(session, whole)


def _asynchronous_evaluations(
    session: Session, search: AsynchronousSearch
) -> Generator[Evaluation, None, None]:
    """Evaluations in the order in which they came, first those that are known; each is told when taken."""
    turns = session.memory.turns()
    for evaluation in _replay(session, search, turns):
        session.front.enters(evaluation)
        yield evaluation
    taken = {turn.number for turn in turns.values()}
    missing = (number for number in range(session.header.budget) if number not in taken)
    asked: dict[int, tuple[Turn, Genome]] = {}
    told = len(turns)

    def genomes() -> Iterator[Genome]:
        for index, number in enumerate(missing):
            genome = search.ask(number)
            asked[index] = Turn(number=number, told=told), genome
            yield genome

    if told == session.header.budget:
        return
    parameters, population = session.header.parameters, session.header.search.population
    with closing(run_stoppable(session.pool, session.factory(), genomes(), session.stop)) as results:
        for finished in results:
            turn, genome = asked.pop(finished.index)
            outcome = evaluation_outcome(told, told // population, genome, parameters, finished, turn)
            remember(session, outcome, more=finished.more)
            search.tell(turn.number, search_outcome(session.header, outcome.evaluation))
            told += 1
            yield outcome.evaluation
    if told < session.header.budget:
        raise KeyboardInterrupt


def _replay(session: Session, search: AsynchronousSearch, turns: Mapping[int, Turn]) -> Iterator[Evaluation]:
    """Tell a fresh search what is known, asking for every genome when it was asked, and compare."""
    by_told: dict[int, list[int]] = {}
    for number, turn in turns.items():
        by_told.setdefault(turn.told, []).append(number)
    known: dict[int, Evaluation] = {}
    for told, turn in turns.items():
        for number in by_told.pop(told, ()):
            evaluation = session.memory.recall(number, search.ask(turns[number].number))
            if evaluation is not None:
                known[number] = evaluation
        evaluation = known.pop(told)
        search.tell(turn.number, search_outcome(session.header, evaluation))
        yield evaluation
