"""What every pool of the registry promises."""

from __future__ import annotations

import errno
import socket
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from evodesign.errors import InputError
from evodesign.pool.base import Pool
from evodesign.pool.registry import POOLS, make_pool
from evodesign.pool.worker import SerialPool
from tests.pool.tasks import Broken, Counted, picky, square, squares

JOBS = 2


@pytest.fixture(scope="module", params=sorted(POOLS))
def pool(request: pytest.FixtureRequest) -> Iterator[Pool]:
    scheduler = request.getfixturevalue("cluster").address if request.param == "dask" else None
    with make_pool(request.param, JOBS, scheduler) as made:
        yield made


def test_every_argument_ends_once_with_the_value_of_a_plain_call(pool: Pool) -> None:
    numbers = list(range(30))
    ends = list(pool.run(squares, numbers))
    assert sorted(end.index for end in ends) == numbers
    assert {end.index: end.value for end in ends} == {number: square(number) for number in numbers}
    assert all(end.failure is None and not end.worker_lost for end in ends)


def test_as_many_arguments_run_at_once_as_it_says(pool: Pool) -> None:
    assert pool.processes == (1 if isinstance(pool, SerialPool) else JOBS)


def test_seconds_are_those_of_the_task(pool: Pool) -> None:
    began = time.perf_counter()
    seconds = [end.seconds for end in pool.run(squares, range(4))]
    assert min(seconds) >= 0.002, "what it sleeps"
    assert max(seconds) <= time.perf_counter() - began, "not more than all of them together"


def test_workers_have_short_names(pool: Pool) -> None:
    names = {end.worker for end in pool.run(squares, range(6))}
    assert 1 <= len(names) <= JOBS
    assert all(0 < len(name) < 60 and name.isprintable() for name in names)


def test_nothing_to_do_ends_at_once(pool: Pool) -> None:
    assert list(pool.run(squares, [])) == []


def test_a_task_is_built_once_per_worker_and_kept_between_runs(pool: Pool, tmp_path: Path) -> None:
    workers = set()
    for _ in range(3):
        equal_factory = Counted(str(tmp_path))
        workers |= {end.worker for end in pool.run(equal_factory, range(10))}
    built = [path.name.split("-")[0] for path in tmp_path.iterdir()]
    assert sorted(built) == sorted(worker.rpartition("-")[2] for worker in workers)
    assert 1 <= len(built) <= JOBS


def test_another_factory_builds_another_task(pool: Pool) -> None:
    assert sorted(end.value for end in pool.run(picky, [1, 2])) == [1, 2]
    assert sorted(end.value for end in pool.run(squares, [3, 4])) == [9, 16]


def test_an_exception_is_a_failure_that_says_kind_text_and_line(pool: Pool) -> None:
    ends = {end.index: end for end in pool.run(picky, range(8))}
    assert len(ends) == 8
    refused = ends.pop(3)
    assert refused.value is None
    assert not refused.worker_lost
    assert refused.failure is not None
    assert refused.failure.startswith("ValueError: three is refused (tasks.py:")
    assert refused.failure.endswith(" in task)")
    exited = ends.pop(5)
    assert exited.failure is not None
    assert exited.failure.startswith("SystemExit: 1")
    assert [ends[index].value for index in sorted(ends)] == [0, 1, 2, 4, 6, 7]


def test_a_factory_that_raises_fails_every_argument_and_is_tried_once(pool: Pool, tmp_path: Path) -> None:
    ends = list(pool.run(Broken(str(tmp_path)), range(9)))
    assert sorted(end.index for end in ends) == list(range(9))
    for end in ends:
        assert end.value is None
        assert not end.worker_lost
        assert end.failure is not None
        assert end.failure.startswith("the task could not be built: OSError: no such robot (tasks.py:")
    assert len(list(tmp_path.iterdir())) == len({end.worker for end in ends})


def test_a_run_left_early_does_not_disturb_the_next(pool: Pool) -> None:
    unfinished = pool.run(squares, range(50))
    next(unfinished)
    assert sorted(end.value for end in pool.run(picky, [0, 1, 2])) == [0, 1, 2]


def test_an_argument_is_taken_when_its_turn_comes_and_may_follow_from_earlier_ends(pool: Pool) -> None:
    given: list[int] = []

    def arguments() -> Iterator[int]:
        yield 1
        while len(given) < 12:
            yield 1 + sum(given[-1:])

    for end in pool.run(squares, arguments()):
        assert end.value is not None
        given.append(end.value % 7)
    assert len(given) < 12 + 4 * JOBS


def test_a_closed_pool_starts_again(pool: Pool) -> None:
    pool.close()
    pool.close()
    assert [end.value for end in pool.run(squares, [5])] == [25]


def test_an_unknown_pool_names_the_nearest() -> None:
    with pytest.raises(
        InputError, match=r"wanted one of dask, joblib, serial, found 'jobli'; did you mean 'joblib'"
    ):
        make_pool("jobli", 1)


@pytest.mark.parametrize("jobs", [0, -1])
def test_fewer_than_one_job_is_refused(jobs: int) -> None:
    with pytest.raises(InputError, match=f"--jobs: wanted a whole number from 1, found {jobs}"):
        make_pool("joblib", jobs)


def test_an_address_is_refused_where_there_is_no_scheduler_in_play() -> None:
    with pytest.raises(InputError, match="--scheduler: wanted no address without --pool dask, found 'tcp"):
        make_pool("joblib", 1, "tcp://127.0.0.1:1")


def test_dask_without_an_address_is_refused() -> None:
    with pytest.raises(
        InputError, match=r"--scheduler: wanted the address of a running Dask scheduler.*none"
    ):
        make_pool("dask", 1)


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:1", "nonsense"])
def test_a_silent_scheduler_is_refused_with_one_sentence(
    address: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("evodesign.pool.dask_pool.PROBE_SECONDS", 0.5)
    with pytest.raises(InputError, match=f"--scheduler: wanted the address .*, found '{address}' ") as caught:
        make_pool("dask", 1, address)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("answer", "reason"),
    [(b"", "no answer within 0.5 s"), (b"HTTP/1.1 400 Bad Request\r\n\r\n", "no Dask scheduler")],
)
def test_what_listens_but_is_no_scheduler_is_refused_soon(
    answer: bytes, reason: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("evodesign.pool.dask_pool.PROBE_SECONDS", 0.5)
    with socket.create_server(("127.0.0.1", 0)) as server:

        def serve() -> None:
            connection, _ = server.accept()
            with connection:
                connection.sendall(answer)
                connection.recv(1 << 20)
                time.sleep(2.0)

        threading.Thread(target=serve, daemon=True).start()
        address = f"tcp://127.0.0.1:{server.getsockname()[1]}"
        with pytest.raises(
            InputError, match=f"--scheduler: wanted the address .*, found '{address}' .*{reason}"
        ):
            make_pool("dask", 1, address)


def test_where_no_semaphore_can_be_had_the_serial_pool_takes_joblib_s_place_and_says_so(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def refuse(method: str) -> None:
        raise OSError(errno.EROFS, "Read-only file system")

    monkeypatch.setattr("evodesign.pool.registry.multiprocessing.get_context", refuse)
    notes = list[str]()
    with make_pool("joblib", JOBS, note=notes.append) as made:
        assert isinstance(made, SerialPool)
    (note,) = notes
    assert note.startswith("no worker processes (semaphores in /dev/shm: Read-only file system)")
    with pytest.warns(UserWarning, match="no worker processes"):
        make_pool("joblib", JOBS).close()
