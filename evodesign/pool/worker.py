"""What happens inside a worker: build the task once, then turn every argument into a `Finished`.

A task's exception ends in the record of its argument, never in the caller. The same bench serves the
serial pool in this process and each worker process of the others.
"""

from __future__ import annotations

import os
import resource
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Generic

from evodesign.errors import explain
from evodesign.pool.base import A, Factory, Finished, Pool, R

ORPHAN_CHECK = 1.0
"""Interval [s] at which a worker looks whether its parent still lives."""


FIRST_TO_GO = "800"
"""Linux takes a process with this mark, of at most 1000, before others when memory runs out."""

NO_MEMORY = ("MemoryError", "bad_alloc")
"""What Python and C++ say when there is no memory."""


@dataclass(frozen=True, slots=True)
class CallResult(Generic[R]):
    """What a call gave: a value, or a sentence saying why there is none."""

    value: R | None
    failure: str | None

    @property
    def out_of_memory(self) -> bool:
        """Whether there is no value for want of memory."""
        return self.failure is not None and any(word in self.failure for word in NO_MEMORY)


def attempt(call: Callable[[], R]) -> CallResult[R]:
    """Call, and keep an exception as a sentence. A task that exits has failed as well."""
    try:
        return CallResult(call(), None)
    except (Exception, SystemExit) as error:  # noqa: BLE001 - a design that fails must not end the search
        return CallResult(None, explain(error))


class Workbench(Generic[A, R]):
    """A factory and the task that it builds at the first argument, once, even when it fails.

    Args:
        factory: builds the task.
        place: first part of the worker's name.
    """

    def __init__(self, factory: Factory[A, R], place: str) -> None:
        self.factory = factory
        self.name = f"{place}-{os.getpid()}"

    @cached_property
    def _built(self) -> CallResult[Callable[[A], R]]:
        return attempt(self.factory)

    def build(self) -> bool:
        """Build the task now, unless it is; gives whether there is one."""
        return self._built.value is not None

    def finish(self, index: int, argument: A) -> Finished[R]:
        """Run the task on the argument of an index; its seconds do not count the building."""
        task = self._built.value
        if task is None:
            failure = f"the task could not be built: {self._built.failure or 'its factory gave None'}"
            return Finished(index, None, failure, worker_lost=False, seconds=0.0, worker=self.name)
        start = time.perf_counter()
        done = attempt(lambda: task(argument))
        seconds = time.perf_counter() - start
        return Finished(
            index, done.value, done.failure, False, seconds, self.name, out_of_memory=done.out_of_memory
        )


class SerialPool(Pool):
    """Runs in this process: no start-up time, no protection against a task that kills or hangs it."""

    def __init__(self) -> None:
        self._bench: Workbench[Any, Any] | None = None

    def run(self, factory: Factory[A, R], arguments: Iterable[A]) -> Iterator[Finished[R]]:
        """Every argument's end, in order; the task is kept for the next run with an equal factory."""
        if self._bench is None or self._bench.factory != factory:
            self._bench = Workbench(factory, "local")
        bench = self._bench
        for index, argument in enumerate(arguments):
            yield bench.finish(index, argument)

    def close(self) -> None:
        """Forget the task."""
        self._bench = None


class _Process:
    """The one bench of a worker process; its parent sends a factory, then arguments only."""

    bench: Workbench[Any, Any]


def start_worker(memory: int | None, parent: int) -> None:
    """Make this process a worker: first thing that runs in it.

    Ctrl-C reaches every process of a terminal; the parent alone decides what it means. A worker whose
    parent was killed ends by itself. When the machine runs out of memory, a worker goes before the search.

    Loky would replace a worker that has grown by 300 MB, as those do that keep what they have built; here the
    limit of its memory counts.

    Args:
        memory: that this process may have [byte]; None for what the machine has.
        parent: its process number; a parent that is gone by now is seen to be.
    """
    from joblib.externals.loky import process_executor  # where there is no shared memory it complains

    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with, args=(parent,), name="orphan-watch", daemon=True).start()
    with suppress(OSError):  # not Linux, or not allowed
        Path("/proc/self/oom_score_adj").write_text(FIRST_TO_GO, encoding="ascii")
    if memory is not None:
        hard = resource.getrlimit(resource.RLIMIT_DATA)[1]
        allowed = memory if hard == resource.RLIM_INFINITY else min(memory, hard)
        resource.setrlimit(resource.RLIMIT_DATA, (allowed, hard))
    process_executor._MAX_MEMORY_LEAK_SIZE = sys.maxsize


def build_here(factory: Factory[A, R], place: str) -> str:
    """Build this worker's task, whether or not that succeeds; gives the name of the worker.

    Args:
        factory: builds the task.
        place: first part of the worker's name.
    """
    _Process.bench = Workbench(factory, place)
    _Process.bench.build()
    return _Process.bench.name


def finish_here(index: int, argument: A) -> Finished[Any]:
    """Run this worker's task on an argument."""
    return _Process.bench.finish(index, argument)


def _end_with(parent: int) -> None:
    while os.getppid() == parent:
        time.sleep(ORPHAN_CHECK)
    os._exit(1)
