"""A pool of many machines: futures of a Dask scheduler that the user started.

Twice as many arguments as the workers have threads are handed out, so that no worker waits for the next one.
Workers may come and go: Dask gives the work of a lost one to another. When the scheduler goes, all that it
held is forgotten; the pool waits until one answers again at the same address and hands out anew what had not
come back.

Every thread of a Dask worker keeps a worker process of its own for the evaluations. So whatever an evaluation
does, the Dask worker lives on and reports the reason. Its processes end with it.

Beyond 300 lines: losses of workers, of schedulers and stops meet in one loop.
"""

from __future__ import annotations

import asyncio
import itertools
import logging
import multiprocessing
import socket
import threading
import time
import weakref
from collections.abc import Callable, Generator, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from queue import Empty, SimpleQueue
from typing import Any, Generic

from distributed import Client, Future, Security, rpc
from distributed.scheduler import KilledWorker

from evodesign.errors import InputError, Interrupted, explain
from evodesign.pool.base import A, Factory, Finished, Pool, R
from evodesign.pool.dispatch import ends_of
from evodesign.pool.worker_group import WorkerGroup
from evodesign.pool.worker_process import WorkerProcess

HANDED_OUT_PER_THREAD = 2
"""One argument that runs and one that is prefetched."""

COUNT_EVERY = 1.0
"""Interval [s] at which workers are counted."""

LOOK_EVERY = 0.5
"""Interval [s] at which the connection is looked at while nothing comes back."""

PROBE_SECONDS = 3.0
"""Longest wait [s] for a scheduler to say that it is one."""

CONNECT_SECONDS = 10.0
"""Longest wait [s] for a connection to a scheduler that has said so."""

CLOSE_SECONDS = 1.0
"""Longest wait [s] for a connection to end."""

PATIENCE = 3600.0
"""Longest wait [s] for a scheduler that was lost."""

FORGOTTEN = ("cancelled", "lost", "error")
"""States of a future that will not have a value any more."""

TALK_OF_LOSS = ("distributed.client", "distributed.batched")
"""Loggers that print a traceback when a connection is lost."""

NO_WORKER = "dask-lost"
"""Worker name of an argument of which no worker could report."""


class DaskPool(Pool):
    """Runs on the workers of a Dask scheduler, which need this package and its dependencies.

    Dask's own words on a lost connection, tracebacks, are not shown from then on in this process.

    Args:
        scheduler: address, such as `tcp://127.0.0.1:8786`.
        note: is told in a sentence when a scheduler is lost.
        stop: asked while a lost scheduler is waited for; True ends that as Ctrl-C does.
        patience: longest wait [s] for a scheduler that was lost.
    Raises:
        InputError: no scheduler answers there.
    """

    def __init__(
        self,
        scheduler: str,
        note: Callable[[str], None],
        stop: Callable[[], bool],
        patience: float = PATIENCE,
    ) -> None:
        for name in TALK_OF_LOSS:
            logging.getLogger(name).setLevel(logging.CRITICAL)
        self._scheduler = scheduler
        self._note = note
        self._stop = stop
        self._patience = patience
        self._current: weakref.ref[Generator[Any, None, None]] | None = None
        try:
            self._client: Client | None = _connect(scheduler)
        except NoSchedulerError as error:
            wanted = "the address of a running Dask scheduler, such as tcp://127.0.0.1:8786"
            raise InputError("--scheduler", "", wanted, f"'{scheduler}' ({error})") from error

    @property
    def processes(self) -> int:
        """How many arguments run at the same time: threads of the workers that are there now, or one."""
        with suppress(OSError):  # just lost
            return int(sum(self.living().nthreads().values())) or 1
        return 1

    def run(self, factory: Factory[A, R], arguments: Iterable[A]) -> Iterator[Finished[R]]:
        """Every argument's end, in the order in which they come; ends a run that was left unfinished."""
        self._end_run()
        ends = self._ends(factory, arguments)
        self._current = weakref.ref(ends)
        return ends

    def close(self) -> None:
        """Leave the scheduler; its workers stay, and finish what they are at."""
        self._end_run()
        client, self._client = self._client, None
        if client is not None:
            _disconnect(client)

    def _end_run(self) -> None:
        unfinished = self._current() if self._current is not None else None
        if unfinished is not None:
            unfinished.close()

    def _ends(self, factory: Factory[A, R], arguments: Iterable[A]) -> Generator[Finished[R], None, None]:
        if self._client is None:
            self._client = self._again()
        yield from ends_of(_Crowd(self, factory), arguments)

    def living(self) -> Client:
        """A client with a connection; waits for the scheduler when that was lost.

        Raises:
            Interrupted: the scheduler has not come back.
            KeyboardInterrupt: a stop was asked for while it was waited for.
        """
        client = self._client
        if client is not None and client.status != "running":
            waited = f"waiting for it, at most {self._patience:g} s"
            self._note(f"the connection to the scheduler {self._scheduler} is lost; {waited}")
            end = time.monotonic() + self._patience
            while client.status == "connecting" and time.monotonic() < end:
                self._wait()
        if client is None or client.status != "running":
            self._client = None
            if client is not None:
                _disconnect(client)
            client = self._client = self._again()
        return client

    def _again(self) -> Client:
        deadline = time.monotonic() + self._patience
        while time.monotonic() < deadline:
            self._wait()
            with suppress(NoSchedulerError):
                return _connect(self._scheduler)
        raise Interrupted(
            f"the scheduler {self._scheduler} has not come back for {self._patience:g} s; "
            "start it and its workers again, then resume the run"
        )

    def _wait(self) -> None:
        """Wait a moment for a lost scheduler, unless a stop was asked for: nothing in flight can arrive."""
        if self._stop():
            raise KeyboardInterrupt
        time.sleep(LOOK_EVERY)


class NoSchedulerError(Exception):
    """No scheduler answers at an address; the text says what was met there."""


def _connect(scheduler: str) -> Client:
    """A client of a scheduler that answers.

    A client that finds none waits for it as it is closed, and again when it is collected; so a probe, in a
    thread whose loop is its own, comes first.
    """
    with ThreadPoolExecutor(1) as thread:
        error = thread.submit(asyncio.run, _probe(scheduler)).exception()
    if error is None:
        try:
            return Client(scheduler, timeout=CONNECT_SECONDS, set_as_default=False)
        except OSError as lost:
            error = lost
    known = isinstance(error, OSError | ValueError)
    raise NoSchedulerError(str(error) if known else "what answers there is no Dask scheduler") from error


async def _probe(address: str) -> None:
    """Ask what is at an address whether it is a scheduler, and raise whatever error says that it is none."""
    connection = Security().get_connection_args("client")
    try:
        async with asyncio.timeout(PROBE_SECONDS):
            async with rpc(address, connection_args=connection) as there:
                kind = (await there.identity())["type"]
    except TimeoutError:
        raise OSError(f"no answer within {PROBE_SECONDS:g} s") from None
    if kind != "Scheduler":
        raise OSError(f"a {kind.lower()} answers there")


def _disconnect(client: Client) -> None:
    """Close a client, also one whose scheduler does not answer any more."""
    try:
        client.close(timeout=CLOSE_SECONDS)
    except OSError:
        client.status = "closed"  # or it would wait again when it is collected


class _Crowd(Generic[A, R]):
    """The workers of all machines.

    Args:
        pool: that has the connection.
        factory: of the task.
    """

    def __init__(self, pool: DaskPool, factory: Factory[A, R]) -> None:
        self._pool = pool
        self._factory = factory
        self._work: Future | None = None
        self._begun: dict[int, tuple[A, float]] = {}
        self._futures: dict[str, tuple[int, Future]] = {}
        self._done: SimpleQueue[str] = SimpleQueue()
        self._ends: list[Finished[R]] = []
        self._threads = 0
        self._counted = float("-inf")
        self._names = (f"evodesign-{id(self)}-{time.time_ns()}-{number}" for number in itertools.count())

    def free(self) -> int:
        """How many more arguments the workers may hold."""
        if time.monotonic() - self._counted > COUNT_EVERY:
            with suppress(OSError):  # just lost: what is on its way will come back as forgotten
                self._threads = sum(self._pool.living().nthreads().values())
            self._counted = time.monotonic()
        return max(0, max(1, HANDED_OUT_PER_THREAD * self._threads) - len(self._begun))

    def begin(self, index: int, argument: A) -> None:
        """Hand an argument to the scheduler."""
        self._begun[index] = argument, time.perf_counter()
        self._submit(index)

    def more(self) -> bool:
        """Whether other ends have come back."""
        return bool(self._ends) or not self._done.empty()

    def next_end(self) -> Finished[R]:
        """The next end to come back; what was forgotten with a scheduler is handed out anew."""
        while not self._ends:
            self._collect(self._names_done())
        end = self._ends.pop()
        del self._begun[end.index]
        return end

    def _submit(self, index: int) -> None:
        client, name = self._pool.living(), next(self._names)
        if self._work is None or self._work.client is not client or self._work.status in FORGOTTEN:
            self._work = client.submit(deliver, self._factory, key=f"{name}-factory", pure=False)
        argument, _ = self._begun[index]
        future = client.submit(finish_there, self._work, index, argument, key=name, pure=False)
        self._futures[name] = index, future
        future.add_done_callback(lambda done: self._done.put(done.key))

    def _names_done(self) -> list[str]:
        """Names of the futures that ended in some way, each once; waits for one."""
        try:
            names = [self._done.get(timeout=LOOK_EVERY)]
        except Empty:
            living = self._pool.living()
            return [name for name, (_, future) in self._futures.items() if future.client is not living]
        while not self._done.empty():
            names.append(self._done.get())
        return [name for name in dict.fromkeys(names) if name in self._futures]

    def _collect(self, names: list[str]) -> None:
        """Take the ends of futures; hand out anew what is not there any more."""
        ended = [self._futures.pop(name) for name in names]
        there = [(index, future) for index, future in ended if future.status == "finished"]
        found = {end.index: end for end in _gathered([future for _, future in there])}
        for index, future in ended:
            if index in found:
                self._ends.append(found[index])
            elif future.status == "error":
                self._ends.append(self._failed(index, future))
            else:
                self._submit(index)

    def _failed(self, index: int, future: Future) -> Finished[R]:
        """The end of an argument of which Dask itself says that it failed."""
        error = future.exception()
        lost = isinstance(error, KilledWorker)
        failure = "the Dask workers that had it died" if lost else f"no result came back: {explain(error)}"
        seconds = time.perf_counter() - self._begun[index][1]
        return Finished(index, None, failure, lost, seconds, NO_WORKER)


def _gathered(futures: list[Future]) -> list[Finished[Any]]:
    """The results of futures, without those that are lost."""
    if not futures:
        return []
    try:
        return list(futures[0].client.gather(futures, errors="skip"))
    except Exception:  # noqa: BLE001 - whatever broke: without their results they are handed out anew
        return []


class _Thread(threading.local):
    """The worker process of each thread of this Dask worker."""

    process: WorkerProcess[Any, Any] | None = None


_thread = _Thread()


def deliver(factory: Factory[A, R]) -> Factory[A, R]:
    """A factory, as a result that Dask keeps, copies to each worker once, and makes again when it is lost."""
    return factory


def finish_there(factory: Factory[A, R], index: int, argument: A) -> Finished[R]:
    """Run a factory's task on an argument, in the process of this thread."""
    if _thread.process is None:
        multiprocessing.current_process().daemon = False  # Dask's mark, with which no process may be started
        _thread.process = WorkerProcess(factory, socket.gethostname())
    elif _thread.process.factory != factory:
        _thread.process.take(factory)
    group = WorkerGroup([_thread.process])
    group.begin(index, argument)
    return group.next_end()
