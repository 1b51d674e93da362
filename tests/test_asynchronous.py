"""Asynchronous runs: no worker waits for a generation, and the log rebuilds the search."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterable, Iterator
from itertools import islice
from pathlib import Path
from typing import Any

import msgspec
import pytest

from evodesign.errors import Interrupted, ResumeMismatch, RunError
from evodesign.evolve import resume, start
from evodesign.pool.base import Finished, Pool
from evodesign.pool.joblib_pool import JoblibPool
from evodesign.pool.worker import SerialPool
from evodesign.records import Evaluation, Generation, Genome, RunHeader, Turn
from evodesign.runlog.run import RunLog, read_run
from evodesign.runlog.session_log import Silent
from evodesign.runlog.writer import RunWriter
from evodesign.searches.registry import ASYNCHRONOUS_SEARCHES
from tests.pool.faulty import Slow
from tests.runlog.toys import ToyTask, essence, toy_assessment, toy_header

ALGORITHMS = sorted(ASYNCHRONOUS_SEARCHES)


def header_of(algorithm: str = "nsga2", budget: int = 60, population: int = 8) -> RunHeader:
    toy = toy_header(population=population, budget=budget)
    settings = msgspec.structs.replace(toy.search, algorithm=algorithm, asynchronous=True)
    return msgspec.structs.replace(toy, search=settings)


class JugglingPool(Pool):
    """Works on several at a time in this process and gives back one at random."""

    def __init__(self, workers: int, seed: int = 1) -> None:
        self._workers = workers
        self._random = random.Random(seed)

    def run(self, factory: Any, arguments: Iterable[Any]) -> Iterator[Finished[Any]]:
        task, source, flying = factory(), enumerate(arguments), dict[int, Any]()
        while True:
            flying.update(islice(source, self._workers - len(flying)))
            if not flying:
                return
            index = self._random.choice(sorted(flying))
            yield Finished(index, task(flying.pop(index)), None, False, 0.25, "here")

    def close(self) -> None:
        pass


def begin(directory: Path, header: RunHeader, pool: Pool, **rest: Any) -> RunLog:
    return start(directory, header, rest.pop("task", None) or ToyTask(header), pool, Silent(), **rest)


def go_on(directory: Path, budget: int | None, pool: Pool) -> RunLog:
    return resume(directory, ToyTask, pool, Silent(), budget)


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_every_turn_is_evaluated_once_and_logged_in_the_order_of_arrival(
    algorithm: str, tmp_path: Path
) -> None:
    header = header_of(algorithm)
    run = begin(tmp_path / "run", header, JugglingPool(5))
    assert [each.number for each in run.evaluations] == list(range(60))
    turns = [each.turn for each in run.evaluations if each.turn is not None]
    assert sorted(turn.number for turn in turns) == list(range(60))
    assert [turn.number for turn in turns] != list(range(60))
    assert [each.generation for each in run.evaluations] == [number // 8 for number in range(60)]
    assert [each.evaluations for each in run.generations] == [8, 16, 24, 32, 40, 48, 56]
    for evaluation in run.evaluations:
        assert evaluation.assessment == toy_assessment(evaluation.genome, header)


def test_a_free_worker_is_given_work_that_follows_from_all_that_had_come(tmp_path: Path) -> None:
    run = begin(tmp_path / "run", header_of(), JugglingPool(5))
    told = sorted((each.turn.number, each.turn.told) for each in run.evaluations if each.turn)
    assert [known for _, known in told] == [0] * 5 + list(range(1, 56))


@pytest.mark.slow
@pytest.mark.parametrize("algorithm", ALGORITHMS)
@pytest.mark.parametrize(("workers", "later"), [(1, 1), (5, 5), (5, 2), (3, 20)])
def test_a_stopped_run_goes_on_from_its_log_with_any_number_of_workers(
    algorithm: str, workers: int, later: int, tmp_path: Path
) -> None:
    header = header_of(algorithm)
    task = ToyTask(header)
    with pytest.raises(Interrupted, match=r"after \d+ of 60 evaluations"):
        begin(
            tmp_path / "run",
            header,
            JugglingPool(workers),
            task=task,
            stop=lambda: len(task.genomes) >= 23,
        )
    before = read_run(tmp_path / "run").evaluations
    assert 23 <= len(before) <= 23 + workers
    run = go_on(tmp_path / "run", None, JugglingPool(later, seed=2))
    assert run.evaluations[: len(before)] == before
    assert len(run.evaluations) == 60
    again = go_on(tmp_path / "run", 90, JugglingPool(workers, seed=3))
    assert again.evaluations[:60] == run.evaluations
    assert sorted(each.turn.number for each in again.evaluations if each.turn) == list(range(90))


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_one_worker_twice_n_equals_n_and_n_more(algorithm: str, tmp_path: Path) -> None:
    whole = begin(tmp_path / "whole", header_of(algorithm, 60), SerialPool())
    begin(tmp_path / "halves", header_of(algorithm, 30), SerialPool())
    halves = go_on(tmp_path / "halves", 60, SerialPool())
    strip: Callable[[RunLog], list[Evaluation]] = lambda run: essence(run)[0]  # noqa: E731
    assert strip(halves) == strip(whole)
    fronts: Callable[[RunLog], list[Generation]] = lambda run: essence(run)[1]  # noqa: E731
    assert fronts(halves) == fronts(whole)


def test_a_kill_that_loses_what_was_in_flight_asks_for_those_turns_again(tmp_path: Path) -> None:
    header = header_of()

    def die(call: int) -> None:
        if call == 25:
            raise KeyboardInterrupt

    with pytest.raises(Interrupted, match="after 25 of 60"):
        begin(tmp_path / "run", header, JugglingPool(6), task=ToyTask(header, before=die))
    run = go_on(tmp_path / "run", None, JugglingPool(2))
    assert sorted(each.turn.number for each in run.evaluations if each.turn) == list(range(60))
    assert go_on(tmp_path / "run", 70, SerialPool()).evaluations[:60] == run.evaluations


def forged(directory: Path, header: RunHeader, evaluations: Iterable[Evaluation]) -> Path:
    with RunWriter(directory, header) as log:
        for evaluation in evaluations:
            log.write(evaluation)
    return directory


def test_another_genome_than_the_search_asks_for_is_noticed(tmp_path: Path) -> None:
    header = header_of()
    known = list(begin(tmp_path / "run", header, JugglingPool(4)).evaluations)
    other: Genome = (0.123, 0.456)
    known[40] = msgspec.structs.replace(known[40], genome=other)
    with pytest.raises(ResumeMismatch, match="evaluation 40 is of another genome"):
        go_on(forged(tmp_path / "forged", header, known), 80, SerialPool())


def test_a_hole_in_the_log_is_named(tmp_path: Path) -> None:
    header = header_of()
    known = list(begin(tmp_path / "run", header, JugglingPool(4)).evaluations)
    del known[17]
    with pytest.raises(RunError, match="evaluation 17 cannot be read"):
        go_on(forged(tmp_path / "holed", header, known), 80, SerialPool())


def test_processes_of_different_speed_do_not_wait_for_each_other(tmp_path: Path) -> None:
    header = header_of(budget=40)
    with JoblibPool(3) as pool:
        run = start(tmp_path / "run", header, Slow(header.parameters, 0.01), pool, Silent())
    assert len(run.evaluations) == 40
    assert run.evaluations[-1].turn != Turn(number=39, told=39)
    assert go_on(tmp_path / "run", 40, SerialPool()).evaluations == run.evaluations
