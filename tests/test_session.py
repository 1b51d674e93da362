"""Sessions in which nothing works: what is no property of designs ends the search and costs nothing."""

from __future__ import annotations

from collections.abc import Callable
from itertools import count
from pathlib import Path
from typing import Any

import msgspec
import pytest

from evodesign.errors import AllFailed, Interrupted
from evodesign.evolve import resume, start
from evodesign.pool.base import Finished
from evodesign.pool.worker import SerialPool
from evodesign.records import RunHeader, Status
from evodesign.runlog.run import read_run
from evodesign.runlog.session_log import Silent
from tests.runlog.toys import OrderedPool, ToyTask, essence, shuffled, toy_header

POPULATION = 4


def header_of(asynchronous: bool, budget: int = 12) -> RunHeader:
    toy = toy_header(population=POPULATION, budget=budget)
    search = msgspec.structs.replace(toy.search, algorithm="nsga2", asynchronous=asynchronous)
    return msgspec.structs.replace(toy, search=search)


def raising(sentence_of: Callable[[int], str]) -> Callable[[RunHeader], ToyTask]:
    """Tasks whose calls raise an error of the sentence that is made of their number, unless it is empty."""
    calls = count()

    def before(_: int) -> None:
        if sentence := sentence_of(next(calls)):
            raise KeyError(sentence)

    return lambda header: ToyTask(header, before)


class WithoutWorkers(OrderedPool):
    """A pool that can start no worker process."""

    def finish(self, task: Callable[[Any], Any], index: int, argument: Any) -> Finished[Any]:
        return Finished(index, None, "no worker process could be started", True, 0.01 * index, "local-lost")


@pytest.mark.parametrize("asynchronous", [False, True])
@pytest.mark.parametrize(
    "pool",
    [SerialPool(), WithoutWorkers(), WithoutWorkers(shuffled(1))],
    ids=["raises", "lost", "lost in another order"],
)
def test_a_first_generation_that_fails_for_one_reason_ends_the_search_and_costs_nothing(
    asynchronous: bool, pool: SerialPool | OrderedPool, tmp_path: Path
) -> None:
    header, broken = header_of(asynchronous), raising(lambda call: f"robto, at {call}.5e-3")
    reason = r"(KeyError: 'robto, at .*\)|no worker process could be started)"
    with pytest.raises(AllFailed, match=rf"^the first 4 evaluations .* kept: {reason}; mend that, .* resume"):
        start(tmp_path / "run", header, broken(header), pool, Silent())
    assert read_run(tmp_path / "run").evaluations == ()
    mended = resume(tmp_path / "run", ToyTask, SerialPool(), Silent(), None)
    whole = start(tmp_path / "whole", header, ToyTask(header), SerialPool(), Silent())
    assert essence(mended) == essence(whole)


@pytest.mark.parametrize("asynchronous", [False, True])
@pytest.mark.parametrize(
    "sentence_of",
    [lambda call: "" if call in (2, 3) else "robto", lambda call: "robto" if call != 1 else "arms"],
    ids=["two work", "two reasons"],
)
def test_failures_beside_which_something_else_comes_are_results(
    asynchronous: bool, sentence_of: Callable[[int], str], tmp_path: Path
) -> None:
    header = header_of(asynchronous)
    run = start(tmp_path / "run", header, raising(sentence_of)(header), SerialPool(), Silent())
    assert [evaluation.number for evaluation in run.evaluations] == list(range(12))
    for evaluation in run.evaluations:
        failed = evaluation.assessment.status == Status.NUMERICAL_FAILURE
        assert failed == bool(sentence_of(evaluation.number))
        assert not failed or f"KeyError: '{sentence_of(evaluation.number)}'" in evaluation.assessment.reason


@pytest.mark.parametrize("asynchronous", [False, True])
def test_a_session_that_goes_on_where_nothing_works_leaves_the_run_as_it_was(
    asynchronous: bool, tmp_path: Path
) -> None:
    header = header_of(asynchronous, budget=8)
    before = start(tmp_path / "run", header, ToyTask(header), SerialPool(), Silent())
    with pytest.raises(AllFailed, match="no worker process"):
        resume(tmp_path / "run", ToyTask, WithoutWorkers(), Silent(), 24)
    assert essence(read_run(tmp_path / "run")) == essence(before)


def test_the_only_design_that_is_missing_may_fail(tmp_path: Path) -> None:
    header = header_of(asynchronous=False, budget=3)
    start(tmp_path / "run", header, ToyTask(header), SerialPool(), Silent())
    broken = raising(lambda call: "robto" if call == 0 else "")
    run = resume(tmp_path / "run", broken, SerialPool(), Silent(), 8)
    statuses = [evaluation.assessment.status for evaluation in run.evaluations]
    assert [number for number, each in enumerate(statuses) if each == Status.NUMERICAL_FAILURE] == [3]


def test_a_small_budget_is_a_whole_generation(tmp_path: Path) -> None:
    header = header_of(asynchronous=False, budget=2)
    with pytest.raises(AllFailed, match=r"^the first 2 evaluations of this session all failed"):
        start(tmp_path / "run", header, raising(lambda call: "robto")(header), SerialPool(), Silent())


def test_a_stop_while_nothing_has_worked_yet_is_a_stop(tmp_path: Path) -> None:
    header, calls = header_of(asynchronous=False), list[int]()
    broken = raising(lambda call: calls.append(call) or "robto")  # type: ignore[func-returns-value]
    with pytest.raises(Interrupted, match=r"^stopped after 0 of 12 evaluations"):
        start(tmp_path / "run", header, broken(header), SerialPool(), Silent(), stop=lambda: len(calls) >= 2)
