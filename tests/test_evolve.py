from __future__ import annotations

import gc
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from evodesign.analysis.hypervolume import hypervolume
from evodesign.analysis.run_state import exhausted
from evodesign.errors import Interrupted, ResumeMismatch, RunError
from evodesign.evolve import resume, start
from evodesign.pool.base import Finished, Pool
from evodesign.pool.registry import make_pool
from evodesign.records import Evaluation, Generation, Genome, RunHeader, Status
from evodesign.runlog.run import RunLog, read_run
from evodesign.runlog.session_log import Silent
from evodesign.runlog.writer import RunWriter
from evodesign.searches.registry import SEARCHES
from tests.runlog.toys import (
    OrderedPool,
    ToySearch,
    ToyTask,
    essence,
    shuffled,
    toy_assessment,
    toy_detail,
    toy_header,
)

ROOT = Path(__file__).parents[1]


def begin(directory: Path, header: RunHeader, pool: OrderedPool | None = None, **rest: Any) -> RunLog:
    task = rest.pop("task", None) or ToyTask(header)
    observer = rest.pop("observer", Silent())
    return start(directory, header, task, pool or OrderedPool(), observer, make_search=ToySearch, **rest)


def go_on(directory: Path, budget: int | None = None, pool: OrderedPool | None = None, **rest: Any) -> RunLog:
    factory_of = rest.pop("factory_of", ToyTask)
    observer = rest.pop("observer", Silent())
    pool = pool or OrderedPool()
    return resume(directory, factory_of, pool, observer, budget, make_search=ToySearch, **rest)


class Listener:
    """An observer that notes what it is shown, and what the log held at that moment."""

    def __init__(self, directory: Path) -> None:
        self.directory = directory
        self.seen: list[tuple[Any, ...]] = []

    def started(self, header: RunHeader, evaluations_done: int) -> None:
        self.seen.append(("started", evaluations_done))

    def evaluated(self, evaluation: Evaluation, done: int, budget: int) -> None:
        assert evaluation in read_run(self.directory).evaluations
        self.seen.append(("evaluated", evaluation.number, done, budget))

    def generation_done(self, generation: Generation) -> None:
        assert generation in read_run(self.directory).generations
        self.seen.append(("generation", generation.number))

    def finished(self, run: RunLog) -> None:
        self.seen.append(("finished", len(run.evaluations)))


def test_the_budget_is_used_to_the_last_evaluation(tmp_path: Path) -> None:
    run = begin(tmp_path / "run", toy_header(population=4, budget=10))
    assert [evaluation.number for evaluation in run.evaluations] == list(range(10))
    assert [evaluation.generation for evaluation in run.evaluations] == [0] * 4 + [1] * 4 + [2] * 2
    assert [generation.evaluations for generation in run.generations] == [4, 8]
    assert run.complete
    assert not run.notes


def test_evaluations_are_what_the_task_makes_of_the_genomes(tmp_path: Path) -> None:
    header = toy_header()
    run = begin(tmp_path / "run", header)
    for evaluation in run.evaluations:
        assert evaluation.assessment == toy_assessment(evaluation.genome, header)
        assert (evaluation.seconds, evaluation.worker) == (0.25, "here")


def fronts_with_postures(run: RunLog) -> set[int]:
    """Members of all fronts, each of which must have its own postures in the log."""
    details = {detail.evaluation: detail for detail in run.details}
    members = {number for front in run.fronts for number in front.evaluations}
    for number in members:
        assert details[number] == toy_detail(run.evaluations[number])
    return members


def test_every_design_of_a_front_is_logged_with_its_postures(tmp_path: Path) -> None:
    run = begin(tmp_path / "run", toy_header(population=6, budget=60), OrderedPool(shuffled(3)))
    members = fronts_with_postures(run)
    assert members
    assert len(run.details) < 30, "a design that is dominated when it arrives is logged in short"


def test_postures_of_a_front_survive_stops(tmp_path: Path) -> None:
    header = toy_header(population=6, budget=60)
    task = ToyTask(header)
    pool = OrderedPool(shuffled(3))
    with pytest.raises(Interrupted):
        begin(tmp_path / "run", header, pool, task=task, stop=lambda: len(task.genomes) >= 20)
    assert fronts_with_postures(go_on(tmp_path / "run")) == fronts_with_postures(
        begin(tmp_path / "whole", header)
    )


def test_generations_tell_the_state_of_the_run(tmp_path: Path) -> None:
    header = toy_header(population=6, budget=24)
    run = begin(tmp_path / "run", header)
    references = [generation.reference for generation in run.generations if generation.reference]
    assert len(references) == 4, "the first generation of this seed holds a feasible design"
    assert all(reference == references[0] for reference in references), "fixed once"
    for generation, front in zip(run.generations, run.fronts, strict=True):
        known = run.evaluations[: generation.evaluations]
        born = known[6 * generation.number :]
        torques = [each.assessment.objectives["robot_torque"] for each in known if each.feasible]
        reaches = [each.assessment.objectives["reach_height"] for each in known if each.feasible]
        assert generation.best == {"robot_torque": min(torques), "reach_height": max(reaches)}
        assert generation.feasible_share == pytest.approx(np.mean([each.feasible for each in born]))
        assert generation.hypervolume == pytest.approx(hypervolume(header.objectives, known, references[0]))
        assert set(front.evaluations) <= {each.number for each in known if each.feasible}
        assert front.evaluations


def test_the_search_is_told_minimised_values_only_after_they_are_on_the_disk(tmp_path: Path) -> None:
    told = []

    class Spy(ToySearch):
        def tell(self, outcomes: Sequence[Any]) -> None:
            run = read_run(tmp_path / "run")
            last = run.generations[-1]
            assert last.evaluations == len(run.evaluations) == len(told) + len(outcomes)
            assert run.fronts[-1].generation == last.number
            told.extend(outcomes)
            super().tell(outcomes)

    header = toy_header(budget=8)
    run = start(tmp_path / "run", header, ToyTask(header), OrderedPool(), Silent(), make_search=Spy)
    assert len(told) == 8
    assert {outcome.feasible for outcome in told} == {True, False}
    for outcome, evaluation in zip(told, run.evaluations, strict=True):
        values = evaluation.assessment.objectives
        if "robot_torque" in values:
            assert outcome.objectives == (values["robot_torque"], -values["reach_height"])
        else:
            assert outcome.objectives is None
        assert outcome.violation == evaluation.assessment.violation


@settings(max_examples=25)
@given(
    first=st.integers(1, 14),
    more=st.integers(0, 14),
    population=st.integers(1, 6),
    order=st.integers(0, 5),
)
def test_a_run_and_its_resumption_equal_one_longer_run_whatever_the_order_of_arrival(
    tmp_path_factory: pytest.TempPathFactory, first: int, more: int, population: int, order: int
) -> None:
    directory = tmp_path_factory.mktemp("runs")
    begin(directory / "parts", toy_header(population, first), OrderedPool(shuffled(order)))
    parts = go_on(directory / "parts", first + more, OrderedPool(shuffled(order + 1)))
    whole = begin(directory / "whole", toy_header(population, first + more))
    assert essence(parts) == essence(whole)
    assert parts.header.budget == first + more


@pytest.fixture(scope="module", params=[("serial", 1), ("joblib", 2)], ids=lambda each: each[0])
def pool(request: pytest.FixtureRequest) -> Iterator[Pool]:
    with make_pool(*request.param) as made:
        yield made


@pytest.mark.parametrize("algorithm", SEARCHES)
def test_every_search_of_the_registry_resumes_as_if_never_interrupted(
    tmp_path: Path, algorithm: str, pool: Pool
) -> None:
    header = toy_header(population=8, budget=40, dimension=3)
    settings = msgspec.structs.replace(header.search, algorithm=algorithm)
    header = msgspec.structs.replace(header, search=settings)
    whole = start(tmp_path / "whole", header, ToyTask(header), OrderedPool(), Silent())
    shorter = msgspec.structs.replace(header, budget=19)
    start(tmp_path / "parts", shorter, ToyTask(header), pool, Silent())
    parts = resume(tmp_path / "parts", ToyTask, pool, Silent(), 40)
    assert essence(parts) == essence(whole)


def test_evaluations_are_on_the_disk_as_they_arrive(tmp_path: Path) -> None:
    listener = Listener(tmp_path / "run")
    pool = OrderedPool(lambda count: range(count - 1, -1, -1))
    begin(tmp_path / "run", toy_header(population=3, budget=6), pool, observer=listener)
    assert listener.seen == [
        ("started", 0),
        ("evaluated", 2, 1, 6),
        ("evaluated", 1, 2, 6),
        ("evaluated", 0, 3, 6),
        ("generation", 0),
        ("evaluated", 5, 4, 6),
        ("evaluated", 4, 5, 6),
        ("evaluated", 3, 6, 6),
        ("generation", 1),
        ("finished", 6),
    ]


def test_pools_are_exhausted_so_that_their_workers_live_on(tmp_path: Path) -> None:
    pool = OrderedPool()
    begin(tmp_path / "run", toy_header(), pool)
    assert pool.closed_early == 0


def test_a_finished_run_is_left_as_it_is(tmp_path: Path) -> None:
    begin(tmp_path / "run", toy_header(population=4, budget=10))
    before = {path.name: path.read_bytes() for path in (tmp_path / "run").iterdir()}

    def no_problem(header: RunHeader) -> ToyTask:
        raise AssertionError("nothing is missing")

    for budget in (None, 10, 5):
        run = go_on(tmp_path / "run", budget, factory_of=no_problem)
        assert len(run.evaluations) == 10
    assert {path.name: path.read_bytes() for path in (tmp_path / "run").iterdir()} == before


def test_a_partly_logged_generation_is_completed_and_nothing_is_evaluated_twice(tmp_path: Path) -> None:
    header = toy_header(population=5, budget=15)
    whole = begin(tmp_path / "whole", header)
    with RunWriter(tmp_path / "run", header) as log:
        for evaluation in whole.evaluations[:7]:
            log.write(evaluation)
    task = ToyTask(header)
    run = go_on(tmp_path / "run", factory_of=lambda header: task)
    assert task.genomes == [evaluation.genome for evaluation in whole.evaluations[7:]]
    assert essence(run) == essence(whole), "also the first generation's record, which was missing"


def test_a_hole_in_the_log_is_filled(tmp_path: Path) -> None:
    header = toy_header(population=5, budget=15)
    whole = begin(tmp_path / "whole", header)
    with RunWriter(tmp_path / "run", header) as log:
        for evaluation in (*whole.evaluations[:3], *whole.evaluations[4:9]):
            log.write(evaluation)
    task = ToyTask(header)
    run = go_on(tmp_path / "run", factory_of=lambda header: task)
    assert task.genomes == [whole.evaluations[number].genome for number in (3, *range(9, 15))]
    assert essence(run) == essence(whole)


@pytest.mark.parametrize("concluded", [False, True])
def test_records_missing_after_the_last_evaluation_are_written(tmp_path: Path, concluded: bool) -> None:
    header = toy_header(population=5, budget=5)
    whole = begin(tmp_path / "whole", header)
    with RunWriter(tmp_path / "run", header) as log:
        for evaluation in whole.evaluations:
            log.write(evaluation)
        if concluded:  # and killed before the front
            log.write(whole.generations[0])
    assert essence(go_on(tmp_path / "run")) == essence(whole)


def test_a_log_of_another_seed_does_not_fit_the_search(tmp_path: Path) -> None:
    run = begin(tmp_path / "run", toy_header(seed=1))
    with RunWriter(tmp_path / "forged", toy_header(seed=2)) as log:
        for evaluation in run.evaluations:
            log.write(evaluation)
    before = (tmp_path / "forged/000.mcap").read_bytes()
    with pytest.raises(ResumeMismatch, match="forged: evaluation 0 is of another genome"):
        go_on(tmp_path / "forged", 24)
    assert (tmp_path / "forged/000.mcap").read_bytes() == before
    assert not (tmp_path / "forged/001.mcap").exists()


def test_one_changed_outcome_in_the_log_is_noticed_in_the_next_generation(tmp_path: Path) -> None:
    header = toy_header(population=4, budget=12)
    run = begin(tmp_path / "run", header)
    with RunWriter(tmp_path / "forged", header) as log:
        for evaluation in run.evaluations:
            if evaluation.number == 5:
                changed = msgspec.structs.replace(evaluation.assessment, violation=0.125)
                evaluation = msgspec.structs.replace(evaluation, assessment=changed)
            log.write(evaluation)
    with pytest.raises(ResumeMismatch, match="evaluation 8 "):
        go_on(tmp_path / "forged")


def test_a_directory_that_holds_a_run_is_refused_and_left_as_it_is(tmp_path: Path) -> None:
    begin(tmp_path / "run", toy_header())
    before = (tmp_path / "run/000.mcap").read_bytes()
    with pytest.raises(RunError, match="holds a run already"):
        begin(tmp_path / "run", toy_header())
    assert (tmp_path / "run/000.mcap").read_bytes() == before


def test_resuming_what_is_no_run_makes_no_directory(tmp_path: Path) -> None:
    with pytest.raises(RunError, match="no such run directory"):
        go_on(tmp_path / "missing")
    assert not (tmp_path / "missing").exists()


def test_a_search_that_asks_for_nothing_ends_with_a_sentence(tmp_path: Path) -> None:
    class Mute(ToySearch):
        def ask(self) -> tuple[Genome, ...]:
            return ()

    header = toy_header()
    with pytest.raises(RunError, match="asks for no further designs"):
        start(tmp_path / "run", header, ToyTask(header), OrderedPool(), Silent(), make_search=Mute)


class FailingPool(OrderedPool):
    """Gives for the first arguments: a lost worker, an error, a number that is not finite, nothing."""

    def finish(self, task: Callable[[Any], Any], index: int, argument: Any) -> Finished[Any]:
        value = task(argument)
        infinite = msgspec.structs.replace(
            value,
            assessment=msgspec.structs.replace(value.assessment, objectives={"robot_torque": float("nan")}),
        )
        ends = (
            Finished(0, None, "the worker process died (signal 9)", True, 0.5, "gone"),
            Finished(1, None, "ValueError: no root", False, 0.5, "here"),
            Finished(2, infinite, None, False, 0.5, "here"),
            Finished(3, None, None, False, 0.5, "here"),
        )
        return ends[index] if index < len(ends) else super().finish(task, index, argument)


def test_a_failure_is_remembered_with_its_reason_and_the_search_goes_on(tmp_path: Path) -> None:
    header = toy_header(population=6, budget=12)
    run = begin(tmp_path / "run", header, FailingPool())
    assert len(run.evaluations) == 12
    lost, wrong, infinite, nothing = (evaluation.assessment for evaluation in run.evaluations[:4])
    assert (lost.status, lost.reason) == (Status.WORKER_LOST, "the worker process died (signal 9)")
    assert (wrong.status, wrong.reason) == (Status.NUMERICAL_FAILURE, "ValueError: no root")
    assert infinite.status is nothing.status is Status.NUMERICAL_FAILURE
    assert infinite.reason == "not a finite number: assessment.objectives.robot_torque is nan"
    for assessment, evaluation in zip((lost, wrong, infinite, nothing), run.evaluations, strict=False):
        assert assessment.violation is None
        assert assessment.objectives == {}
        low, high = 0.5, 2.0
        expected = {f"arm.{i}": low + u * (high - low) for i, u in enumerate(evaluation.genome)}
        assert assessment.design == pytest.approx(expected)
        assert not evaluation.feasible
    assert essence(go_on(tmp_path / "run", 12)) == essence(run)


@pytest.mark.parametrize("asked_after", range(9))
def test_a_stopped_search_goes_on_as_if_it_had_not_been(tmp_path: Path, asked_after: int) -> None:
    header = toy_header(population=4, budget=8)
    task = ToyTask(header)
    stop = lambda: len(task.genomes) >= asked_after  # noqa: E731
    if asked_after < 8:
        with pytest.raises(Interrupted, match=f"after {asked_after} of 8 evaluations.*evodesign resume"):
            begin(tmp_path / "run", header, task=task, stop=stop)
    else:
        begin(tmp_path / "run", header, task=task, stop=stop)
    left = read_run(tmp_path / "run")
    assert (len(left.evaluations), left.complete) == (asked_after, True)
    assert essence(go_on(tmp_path / "run")) == essence(begin(tmp_path / "whole", header))


def test_ctrl_c_keeps_what_arrived_out_of_order(tmp_path: Path) -> None:
    header = toy_header(population=4, budget=8)

    def press_ctrl_c(call: int) -> None:
        if call == 2:
            raise KeyboardInterrupt

    pool = OrderedPool(lambda count: [3, 1, 0, 2][:count])
    with pytest.raises(Interrupted, match="after 2 of 8"):
        begin(tmp_path / "run", header, pool, task=ToyTask(header, before=press_ctrl_c))
    assert [each.number for each in read_run(tmp_path / "run").evaluations] == [1, 3]
    second = ToyTask(header)
    run = go_on(tmp_path / "run", factory_of=lambda header: second)
    assert len(second.genomes) == 6
    assert essence(run) == essence(begin(tmp_path / "whole", header))


def test_ctrl_c_leaves_a_committed_readable_log(tmp_path: Path) -> None:
    header = toy_header(population=4, budget=12)

    def press_ctrl_c(call: int) -> None:
        if call == 6:
            os.kill(os.getpid(), signal.SIGINT)
            time.sleep(1.0)

    with pytest.raises(Interrupted, match="after 6 of 12"):
        begin(tmp_path / "run", header, task=ToyTask(header, before=press_ctrl_c))
    left = read_run(tmp_path / "run")
    assert (len(left.evaluations), left.complete) == (6, True)
    assert essence(go_on(tmp_path / "run")) == essence(begin(tmp_path / "whole", header))


def test_ctrl_c_while_the_search_thinks_leaves_a_readable_log(tmp_path: Path) -> None:
    class Thinker(ToySearch):
        def tell(self, outcomes: Sequence[Any]) -> None:
            raise KeyboardInterrupt

    header = toy_header(population=4, budget=12)
    with pytest.raises(Interrupted, match="after 4 of 12"):
        start(tmp_path / "run", header, ToyTask(header), OrderedPool(), Silent(), make_search=Thinker)
    assert essence(go_on(tmp_path / "run")) == essence(begin(tmp_path / "whole", header))


def test_a_new_session_may_renew_its_header(tmp_path: Path) -> None:
    begin(tmp_path / "run", toy_header(budget=4))
    run = go_on(
        tmp_path / "run", 8, renew=lambda header: msgspec.structs.replace(header, versions={"evodesign": "2"})
    )
    assert (run.header.versions, run.header.budget) == ({"evodesign": "2"}, 8)


@pytest.fixture
def killed(tmp_path: Path) -> Path:
    """The directory of a run whose process was killed (signal 9) in the middle of a generation."""
    directory = tmp_path / "killed"
    command = [sys.executable, "-m", "tests.runlog.slow_session", str(directory)]
    with subprocess.Popen(command, cwd=ROOT) as session:
        try:
            deadline = time.monotonic() + 300.0
            while _evaluations_so_far(directory) < 13:
                assert session.poll() is None, "the session ended by itself"
                assert time.monotonic() < deadline
                time.sleep(0.005)
            with pytest.raises(RunError, match="another evodesign is writing this run"):
                go_on(directory)
        finally:
            session.kill()
    return directory


def _evaluations_so_far(directory: Path) -> int:
    try:
        return len(read_run(directory).evaluations)
    except RunError:
        return 0


def test_a_killed_session_is_resumed_as_if_nothing_had_happened(killed: Path, tmp_path: Path) -> None:
    left = read_run(killed)
    assert not left.complete
    assert 13 <= len(left.evaluations) < 200
    assert [each.number for each in left.evaluations] == list(range(len(left.evaluations)))
    tasks = []

    def factory_of(header: RunHeader) -> ToyTask:
        tasks.append(ToyTask(header))
        return tasks[-1]

    run = go_on(killed, 40, factory_of=factory_of)
    (task,) = tasks
    assert len(task.genomes) == 40 - len(left.evaluations)
    assert essence(run) == essence(begin(tmp_path / "whole", toy_header(population=5, budget=40)))
    assert sorted(path.name for path in killed.iterdir()) == ["000.mcap", "001.mcap", "lock"]
    assert (killed / "lock").read_bytes() == b"", "no pickles: the run is its log"


def test_a_search_whose_hypervolume_stands_still_ends_and_can_be_told_to_go_on(tmp_path: Path) -> None:
    class Stubborn(ToySearch):
        def tell(self, outcomes: Sequence[Any]) -> None:
            """Learn nothing: ask for the same designs for ever."""

    header = msgspec.structs.replace(toy_header(population=4, budget=60), stagnation_generations=3)

    def patient(header: RunHeader) -> RunHeader:
        return msgspec.structs.replace(header, stagnation_generations=6)

    run = start(tmp_path / "run", header, ToyTask(header), OrderedPool(), Silent(), make_search=Stubborn)
    assert len(run.evaluations) == 16, "one generation, and three that add nothing"
    assert run.complete
    again = resume(tmp_path / "run", ToyTask, OrderedPool(), Silent(), None, make_search=Stubborn)
    assert len(again.evaluations) == 16, "it still stands still"
    further = resume(
        tmp_path / "run", ToyTask, OrderedPool(), Silent(), None, make_search=Stubborn, renew=patient
    )
    assert len(further.evaluations) == 28


def test_a_search_that_promises_too_little_growth_ends_and_can_be_told_to_go_on(tmp_path: Path) -> None:
    header = msgspec.structs.replace(toy_header(population=4, budget=400), least_growth_percent=30.0)

    def greedy(header: RunHeader) -> RunHeader:
        return msgspec.structs.replace(header, least_growth_percent=msgspec.UNSET)

    run = start(tmp_path / "run", header, ToyTask(header), OrderedPool(), Silent(), make_search=ToySearch)
    history = [(each.evaluations, each.hypervolume) for each in run.generations]
    assert 8 <= len(run.evaluations) < 400
    assert exhausted(history, 30.0)
    assert not exhausted(history[:-1], 30.0)
    further = resume(
        tmp_path / "run", ToyTask, OrderedPool(), Silent(), None, make_search=ToySearch, renew=greedy
    )
    assert len(further.evaluations) == 400


def test_a_session_lets_go_of_what_it_has_told(tmp_path: Path) -> None:
    """Only the front is carried on: a session of any length needs the same memory."""
    counts = []

    class Counter(Silent):
        def generation_done(self, generation: Generation) -> None:
            if generation.number in (4, 29):
                counts.append(sum(isinstance(each, Evaluation) for each in gc.get_objects()))

    gc.collect()
    before = sum(isinstance(each, Evaluation) for each in gc.get_objects())
    begin(tmp_path / "run", toy_header(population=10, budget=300), observer=Counter())
    early, late = (count - before for count in counts)
    assert 10 <= early <= late < 80, "a generation and the front, not the run"
