"""A worker process of its own: what happens in it happens to one argument only.

The process is that of a loky executor (joblib's) with one worker. An argument that kills it, takes too long
or cannot send its result back has an end that says so; the process is then replaced at the next argument.
Executors with several workers would not do: when one of those dies, loky ends them all.
"""

from __future__ import annotations

import os
import re
import signal
import time
from collections.abc import Iterator
from concurrent.futures import Future
from contextlib import contextmanager
from multiprocessing import resource_tracker
from typing import Any, Generic

from joblib.externals.loky.backend import resource_tracker as loky_resource_tracker
from joblib.externals.loky.process_executor import (
    BrokenProcessPool,
    ProcessPoolExecutor,
    TerminatedWorkerError,
)

from evodesign.errors import explain
from evodesign.pool.base import A, Factory, Finished, R, limits_of
from evodesign.pool.worker import build_here, finish_here, start_worker

ONE_THREAD = dict.fromkeys(
    (
        "OMP_NUM_THREADS",
        "OPENBLAS_NUM_THREADS",
        "MKL_NUM_THREADS",
        "BLIS_NUM_THREADS",
        "NUMEXPR_NUM_THREADS",
        "VECLIB_MAXIMUM_THREADS",
    ),
    "1",
)
"""Environment of a worker: the pool uses the cores, numerical libraries must not."""


class WorkerProcess(Generic[A, R]):
    """One worker process and the argument that it works on. Its process starts with the first argument.

    Args:
        factory: builds the task, once per process.
        place: first part of the worker's name.
    """

    def __init__(self, factory: Factory[A, R], place: str) -> None:
        self.factory, self._limits = factory, limits_of(factory)
        self._place = place
        self._name = f"{place}-lost"
        self._executor: ProcessPoolExecutor | None = None
        self._given: Factory[A, R] | None = None
        self._begun = 0.0
        self._ready = False

    def take(self, factory: Factory[A, R]) -> None:
        """Work with another factory from the next argument on; none may be at work.

        Its process goes on, with what it keeps, if it may have as much memory.
        """
        limits = limits_of(factory)
        if limits.memory != self._limits.memory:
            self.close()
        self.factory, self._limits, self._ready = factory, limits, False

    def begin(self, index: int, argument: A) -> Future[Finished[R]]:
        """Begin an argument; the future is to be given to `end`."""
        self._begun = time.perf_counter()
        try:
            return self._submitted(index, argument)
        except (OSError, ValueError) as error:  # as loky says it when no process can be had
            return self._never(_NotStartedError(f"no worker process could be started ({explain(error)})"))
        except BrokenProcessPool as error:  # it ended before it could be given anything, and so did the next
            return self._never(error)

    @property
    def due(self) -> float:
        """When the argument must have ended, on the clock of `time.perf_counter` [s]."""
        limits = self._limits
        return self._begun + (limits.seconds if self._ready else limits.building_seconds)

    def end(self, index: int, future: Future[Finished[R]]) -> Finished[R]:
        """The end of the argument: what came back, or why nothing did. Call when it is done or due."""
        if not future.done():
            return self._too_late(index)
        try:
            return future.result()
        except Exception as error:  # noqa: BLE001 - whatever keeps the result back is this argument's failure
            lost = isinstance(error, TerminatedWorkerError | _NotStartedError)
            failure = _death(error) if lost else f"no result came back: {explain(error)}"
            if isinstance(error, BrokenProcessPool):
                self.close()
            return Finished(index, None, failure, lost, self._seconds, self._name)

    def close(self) -> None:
        """End the process, also one at work."""
        executor, self._executor, self._ready, self._given = self._executor, None, False, None
        if executor is not None:
            executor.shutdown(wait=True, kill_workers=True)

    @property
    def _seconds(self) -> float:
        return time.perf_counter() - self._begun

    def _never(self, why: Exception) -> Future[Finished[R]]:
        self.close()
        never: Future[Finished[R]] = Future()
        never.set_exception(why)
        return never

    def _submitted(self, index: int, argument: A) -> Future[Finished[R]]:
        try:
            return self._submit(index, argument)
        except BrokenProcessPool:  # died while it had nothing to do
            self.close()
            return self._submit(index, argument)

    def _submit(self, index: int, argument: A) -> Future[Finished[R]]:
        if self._executor is None:
            _begin_resource_trackers()
            self._executor = ProcessPoolExecutor(
                max_workers=1,
                initializer=start_worker,
                initargs=(self._limits.memory, os.getpid()),
                env=ONE_THREAD,
            )
        if self._given is not self.factory:
            with _interrupts_held_off():
                built = self._executor.submit(build_here, self.factory, self._place)
            built.add_done_callback(self._built)
            self._given = self.factory
        future: Future[Finished[R]] = self._executor.submit(finish_here, index, argument)
        return future

    def _built(self, future: Future[Any]) -> None:
        """The clock of the first argument starts when its task is built."""
        if not future.cancelled() and future.exception() is None:
            self._name = future.result()
            self._begun = time.perf_counter()
            self._ready = True

    def _too_late(self, index: int) -> Finished[R]:
        what = "no result" if self._ready else "no task built"
        failure = f"{what} after {self.due - self._begun:g} s, so the worker process was ended"
        self.close()
        return Finished(index, None, failure, False, self._seconds, self._name, out_of_time=True)


class _NotStartedError(Exception):
    """No process could be had; the text says why."""


def _begin_resource_trackers() -> None:
    """Begin the processes that remove what this one leaves behind, without a word on what that was.

    Loky begins them otherwise, and they let interrupts in when they have begun. What is left is what a second
    Ctrl-C, or a kill, gave no time to remove.
    """
    before = os.environ.get("PYTHONWARNINGS")
    os.environ["PYTHONWARNINGS"] = ",".join(filter(None, (before, "ignore:resource_tracker")))
    try:
        resource_tracker.ensure_running()
        loky_resource_tracker.ensure_running()
    finally:
        if before is None:
            del os.environ["PYTHONWARNINGS"]
        else:
            os.environ["PYTHONWARNINGS"] = before


@contextmanager
def _interrupts_held_off() -> Iterator[None]:
    """Processes and threads begun within this never see Ctrl-C, not even before `start_worker`."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _death(error: BaseException) -> str:
    """A sentence on a worker's death, with the exit code that loky mentions, such as `SIGKILL(-9)`."""
    if isinstance(error, _NotStartedError):
        return str(error)
    codes = [int(code) for code in re.findall(r"[A-Z]\((-?\d+)\)", str(error))]
    manners = sorted({f"signal {-code}" if code < 0 else f"exit code {code}" for code in codes})
    return f"the worker process died ({', '.join(manners) or 'unknown cause'})"
