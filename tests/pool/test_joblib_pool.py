"""Worker processes: they live on, die, are replaced, and never outlive their parent."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from joblib.externals.loky.process_executor import TerminatedWorkerError

from evodesign.pool.base import Limits
from evodesign.pool.joblib_pool import JoblibPool
from evodesign.pool.worker_process import WorkerProcess
from tests.pool.tasks import (
    Alone,
    Hoards,
    KillsOnce,
    SlowToBuild,
    Where,
    Within,
    deadly,
    environment,
    held,
    mark,
    process,
    squares,
    unsendable,
)
from tests.processes import is_alive, wait_until_all_end

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def pool() -> Iterator[JoblibPool]:
    with JoblibPool(2) as made:
        yield made


def test_work_runs_in_two_other_processes(pool: JoblibPool) -> None:
    pids = {end.value for end in pool.run(process, [0.02] * 10)}
    assert len(pids) == 2
    assert os.getpid() not in pids


def test_a_second_run_has_the_same_workers(pool: JoblibPool) -> None:
    first = {end.value for end in pool.run(process, [0.02] * 10)}
    time.sleep(0.5)
    second = {end.value for end in pool.run(process, [0.02] * 10)}
    assert first == second


def test_results_come_as_they_end_and_not_in_order(pool: JoblibPool, tmp_path: Path) -> None:
    hold = tmp_path / "hold"
    hold.touch()
    ends = pool.run(held, [str(hold), "", ""])
    assert [next(ends).index, next(ends).index] == [1, 2]
    hold.unlink()
    assert [end.index for end in ends] == [0]


@pytest.mark.parametrize("name", ["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"])
def test_numerical_libraries_have_one_thread_in_a_worker(
    pool: JoblibPool, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(name, "3")
    assert [end.value for end in pool.run(environment, [name])] == ["1"]


@pytest.mark.parametrize(("word", "manner"), [("kill", "signal 9"), ("exit", "exit code 7")])
def test_one_deadly_argument_among_many_is_lost_and_no_other(
    pool: JoblibPool, word: str, manner: str
) -> None:
    words = [f"word {number}" for number in range(20)]
    words[6] = word
    ends = list(pool.run(deadly, words))
    assert sorted(end.index for end in ends) == list(range(20))
    (lost,) = [end for end in ends if end.worker_lost]
    assert lost.index == 6
    assert lost.value is None
    assert lost.failure == f"the worker process died ({manner}), also when retried alone"
    assert all(end.value == words[end.index].upper() for end in ends if end is not lost)


@pytest.mark.slow
def test_when_every_argument_is_deadly_every_one_is_lost() -> None:
    with JoblibPool(3) as pool:
        ends = list(pool.run(deadly, ["kill"] * 5))
        assert sorted(end.index for end in ends) == list(range(5))
        assert all(end.worker_lost for end in ends)
        assert [end.value for end in pool.run(deadly, ["after"])] == ["AFTER"]


def test_an_argument_that_dies_once_has_its_value_from_the_retry(pool: JoblibPool, tmp_path: Path) -> None:
    ends = list(pool.run(KillsOnce(str(tmp_path), culprit=4), range(9)))
    assert (tmp_path / "killed").exists()
    assert sorted((end.index, end.value, end.failure) for end in ends) == [(i, i, None) for i in range(9)]


def test_workers_killed_from_outside_are_replaced(pool: JoblibPool) -> None:
    pids = {end.value for end in pool.run(process, [0.02] * 10)}
    ends = pool.run(process, [0.05] * 20)
    first = next(ends)
    for pid in pids:
        assert pid is not None
        os.kill(pid, signal.SIGKILL)
    rest = list(ends)
    assert sorted(end.index for end in [first, *rest]) == list(range(20))
    assert not any(end.worker_lost for end in rest)
    assert pids.isdisjoint(end.value for end in rest[-10:])


def test_idle_workers_killed_between_runs_are_replaced(pool: JoblibPool) -> None:
    pids = {end.value for end in pool.run(process, [0.02] * 10)}
    for pid in pids:
        assert pid is not None
        os.kill(pid, signal.SIGKILL)
    ends = list(pool.run(process, [0.01] * 10))
    assert sorted(end.index for end in ends) == list(range(10))
    assert not any(end.worker_lost for end in ends)


def test_one_job_runs_one_argument_at_a_time_and_survives_a_death(tmp_path: Path) -> None:
    with JoblibPool(1) as pool:
        list(pool.run(deadly, ["warm"] * 4))
        ends = list(pool.run(deadly, ["one", "kill", "two"]))
        alone = list(pool.run(Alone(str(tmp_path)), range(4)))
    assert [(end.index, end.failure) for end in alone] == [(number, None) for number in range(4)]
    assert os.getpid() not in {end.value for end in alone}
    assert {end.index: end.value for end in ends} == {0: "ONE", 1: None, 2: "TWO"}


def test_a_result_that_does_not_pickle_is_a_failure_of_its_argument(pool: JoblibPool) -> None:
    ends = {end.index: end for end in pool.run(unsendable, range(5))}
    assert sorted(ends) == list(range(5))
    failure = ends.pop(2).failure
    assert failure is not None
    assert failure.startswith("no result came back: TypeError: cannot pickle 'generator' object")
    assert all(end.value == index for index, end in ends.items())


def test_closing_a_run_early_ends_workers_at_work_and_keeps_the_others(pool: JoblibPool) -> None:
    pids = {end.value for end in pool.run(process, [0.02] * 10)}
    ends = pool.run(process, [0.01, 60.0])
    idle = next(ends).value
    ends.close()  # type: ignore[attr-defined]
    wait_until_all_end(pids - {idle})
    assert is_alive(idle)


def test_arguments_are_taken_when_a_worker_is_free_and_not_before() -> None:
    taken, given = [], []

    def arguments() -> Iterator[float]:
        for number in range(12):
            taken.append(len(given))
            yield 0.01 + number * 1e-9

    with JoblibPool(3) as pool:
        for end in pool.run(process, arguments()):
            given.append(end)  # noqa: PERF402 - one by one is the point
    assert taken == [0] * 6 + [0, 1, 2, 3, 4, 5], "three at work, three prefetched"


@pytest.mark.slow
def test_an_argument_that_takes_too_long_is_ended_and_costs_no_other_its_worker() -> None:
    with JoblibPool(2) as pool:
        ends = {end.index: end for end in pool.run(Within(Limits(seconds=3.0)), [3600.0, *[0.01] * 8])}
        late = ends.pop(0)
    assert late.out_of_time
    assert not late.worker_lost
    assert late.failure == "no result after 3 s, so the worker process was ended"
    assert late.seconds >= 3.0
    assert all(end.failure is None for end in ends.values())
    assert late.worker.startswith("local-")


@pytest.mark.slow
def test_the_building_of_a_task_does_not_count_as_time_of_its_first_argument() -> None:
    with JoblibPool(1) as pool:
        (end,) = pool.run(SlowToBuild(seconds=3.5, limits=Limits(seconds=3.0)), [0.01])
    assert end.failure is None


def test_a_task_that_takes_for_ever_to_build_is_ended() -> None:
    with JoblibPool(1) as pool:
        (end,) = pool.run(SlowToBuild(seconds=3600.0, limits=Limits(building_seconds=1.0)), [0.1])
    assert end.out_of_time
    assert end.failure == "no task built after 1 s, so the worker process was ended"


def test_a_task_that_takes_all_memory_is_stopped_at_its_limit_and_retried_alone() -> None:
    with JoblibPool(2) as pool:
        ends = {end.index: end for end in pool.run(Hoards(Limits(memory=2**30)), [0, 2**32, 0])}
        hoarder = ends.pop(1)
    assert hoarder.out_of_memory
    assert hoarder.failure is not None
    assert hoarder.failure.startswith("MemoryError")
    assert hoarder.failure.endswith("also when retried alone")
    assert all(end.failure is None for end in ends.values())


def test_a_worker_marks_itself_as_first_to_go_when_memory_runs_out(pool: JoblibPool) -> None:
    (end,) = pool.run(mark, [None])
    assert end.value == "800"


def test_close_ends_workers_at_work() -> None:
    pool = JoblibPool(2)
    pids = {end.value for end in pool.run(process, [0.02] * 10)}
    unfinished = pool.run(process, [0.01, 60.0, 60.0])
    next(unfinished)
    pool.close()
    wait_until_all_end(pids)
    assert list(unfinished) == []


LONG_RUN = """
from evodesign.pool.joblib_pool import JoblibPool
from tests.pool.tasks import process
with JoblibPool(2) as pool:
    print(*{end.value for end in pool.run(process, [0.05] * 6)}, flush=True)
    for end in pool.run(process, [PAUSE] * 1000):
        pass
"""


@pytest.mark.slow
@pytest.mark.parametrize("pause", [0.05, 60.0])
@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGINT, signal.SIGTERM])
def test_no_worker_outlives_its_parent(how: signal.Signals, pause: float) -> None:
    script = LONG_RUN.replace("PAUSE", str(pause))
    parent = subprocess.Popen(
        [sys.executable, "-c", script],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    with parent:
        assert parent.stdout is not None
        pids = {int(word) for word in parent.stdout.readline().split()}
        assert len(pids) == 2
        time.sleep(0.2)
        if how is signal.SIGINT:
            os.killpg(parent.pid, how)  # as a terminal does
        else:
            parent.send_signal(how)
        try:
            wait_until_all_end(pids)
        except AssertionError:
            parent.kill()  # one that goes on would be waited for without end
            raise
        if how is signal.SIGINT:
            assert parent.stderr is not None
            assert parent.stderr.read().count("Traceback") == 1  # the parent's own


def test_ordinary_use_writes_nothing_to_stderr_and_leaves_nothing_behind(tmp_path: Path) -> None:
    script = """
import os
from evodesign.pool.joblib_pool import JoblibPool
from tests.pool.tasks import squares
with JoblibPool(2) as pool:
    for _ in range(3):
        assert len(list(pool.run(squares, range(10)))) == 10
    own = [name for name in os.listdir("/dev/shm") if f"-{os.getpid()}-" in name]
    assert own, "this test looks for semaphores by the wrong name"
JoblibPool(2).close()
print(os.getpid())
"""
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", script], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert not list(Path("/dev/shm").glob(f"*-{done.stdout.strip()}-*"))


def test_processes_that_end_before_they_are_given_anything_are_an_argument_lost(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Loky may notice that a process is dead before it takes the first argument."""
    given: list[int] = []

    def dead(self: WorkerProcess, index: int, argument: int) -> None:
        given.append(index)
        raise TerminatedWorkerError("gone")

    monkeypatch.setattr(WorkerProcess, "_submit", dead)
    worker = WorkerProcess(squares, "here")
    end = worker.end(3, worker.begin(3, 2))
    assert (end.index, end.value, end.worker_lost) == (3, None, True)
    assert "worker process" in end.failure
    assert given == [3, 3]


@pytest.mark.slow
def test_a_worker_that_grew_goes_on_without_a_word() -> None:
    script = """
from evodesign.pool.joblib_pool import JoblibPool
from tests.pool.tasks import Grows
with JoblibPool(1) as pool:
    ends = list(pool.run(Grows(), range(5)))
    assert [end.failure for end in ends] == [None] * 5
    print(len({end.value for end in ends}))
"""
    done = subprocess.run(
        [sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True, check=False, timeout=120
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert int(done.stdout) == 1


def test_where_no_process_can_be_had_every_argument_says_so(tmp_path: Path) -> None:
    script = f"""
import sys
from evodesign.pool.joblib_pool import JoblibPool
from tests.pool.tasks import squares
sys.executable = {str(tmp_path / "none")!r}
with JoblibPool(2) as pool:
    for end in pool.run(squares, range(3)):
        assert end.value is None
        print(end.index, end.failure)
"""
    done = subprocess.run(
        [sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True, check=False, timeout=120
    )
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    assert len(lines) == 3
    assert all("worker process" in line and "also when retried alone" in line for line in lines), lines


def test_another_factory_is_given_to_the_same_process_unless_it_may_have_more_memory() -> None:
    with JoblibPool(1) as pool:
        tasks = [
            Where("one"),
            Where("other"),
            Where("other"),
            *(Where(n, memory=2**34) for n in ("more", "last")),
        ]
        ends = [next(iter(pool.run(task, [0]))).value for task in tasks]
    names, places = zip(*filter(None, ends), strict=True)
    assert names == ("one", "other", "other", "more", "last")
    assert places[0] == places[1] == places[2] != places[3] == places[4]


def test_a_worker_that_dies_at_once_is_told_however_large_its_task(monkeypatch: pytest.MonkeyPatch) -> None:
    """Loky hands a new process what it begins with through a pipe that nobody would empty."""
    monkeypatch.setattr(sys, "executable", "/bin/false")
    with JoblibPool(1) as pool:
        end = next(iter(pool.run(Where("one"), [0])))
    assert end.value is None
    assert "worker process" in (end.failure or "")
