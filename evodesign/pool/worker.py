"""What happens inside a worker: build the task once, then turn every argument into a `Finished`.

A task's exception ends in the record of its argument, never in the caller. The same bench serves the
serial pool in this process and each worker process of the others.
"""

from __future__ import annotations

import os
import signal
import threading
import time
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Generic, TypeVar

from evodesign.pool.base import Factory, Finished

__all__ = ["Workbench", "explain", "finish_here", "start_worker", "worker_name"]

A = TypeVar("A")
R = TypeVar("R")

ORPHAN_CHECK = 1.0
"""Interval [s] at which a worker looks whether its parent still lives."""


@dataclass(frozen=True, slots=True)
class Attempt(Generic[R]):
    """What a call gave: a value, or a sentence saying why there is none."""

    value: R | None
    failure: str | None


def attempt(call: Callable[[], R]) -> Attempt[R]:
    """Call, and keep an exception as a sentence. A task that exits has failed as well."""
    try:
        return Attempt(call(), None)
    except (Exception, SystemExit) as error:  # noqa: BLE001 - a design that fails must not end the search
        return Attempt(None, explain(error))


def explain(error: BaseException) -> str:
    """Kind, text and last line of an exception, such as `ValueError: no root (model.py:120 in root)`."""
    text = " ".join(str(error).split())
    sentence = f"{type(error).__name__}: {text}" if text else type(error).__name__
    frames = traceback.extract_tb(error.__traceback__)
    if not frames:
        return sentence
    last = frames[-1]
    return f"{sentence} ({Path(last.filename).name}:{last.lineno} in {last.name})"


class Workbench(Generic[A, R]):
    """A factory and the task that it builds at the first argument, once, even when it fails."""

    def __init__(self, factory: Factory[A, R]) -> None:
        self.factory = factory

    @cached_property
    def _built(self) -> Attempt[Callable[[A], R]]:
        return attempt(self.factory)

    def finish(self, index: int, argument: A) -> Finished[R]:
        """Run the task on the argument of an index; its seconds do not count the building."""
        task = self._built.value
        if task is None:
            failure = f"the task could not be built: {self._built.failure or 'its factory gave None'}"
            return Finished(index, None, failure, worker_lost=False, seconds=0.0, worker=worker_name())
        start = time.perf_counter()
        done = attempt(lambda: task(argument))
        seconds = time.perf_counter() - start
        return Finished(index, done.value, done.failure, False, seconds, worker_name())


def worker_name() -> str:
    """Name of this process as a worker."""
    return f"local-{os.getpid()}"


class _Process:
    """The one bench of a worker process; its parent sends the factory at the start, then arguments only."""

    bench: Workbench[Any, Any]


def start_worker(factory: Factory[A, R]) -> None:
    """Make this process a worker: first thing that runs in it.

    Ctrl-C reaches every process of a terminal; the parent alone decides what it means. A worker whose
    parent was killed ends by itself.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with, args=(os.getppid(),), name="orphan-watch", daemon=True).start()
    _Process.bench = Workbench(factory)


def finish_here(index: int, argument: A) -> Finished[Any]:
    """Run this worker's task on an argument."""
    return _Process.bench.finish(index, argument)


def _end_with(parent: int) -> None:
    while os.getppid() == parent:
        time.sleep(ORPHAN_CHECK)
    os._exit(1)
