"""A pool of processes on this machine: joblib's executors, one per worker.

Workers live on between runs and build each task once; arguments are handed out one by one. A worker that
dies or takes too long is replaced, and nothing else notices.
"""

from __future__ import annotations

import weakref
from collections.abc import Generator, Iterable, Iterator
from typing import Any

from evodesign.pool.base import A, Factory, Finished, Pool, R
from evodesign.pool.dispatch import ends_of
from evodesign.pool.worker_group import WorkerGroup
from evodesign.pool.worker_process import WorkerProcess


class JoblibPool(Pool):
    """Runs in processes, each with one thread for numerical libraries.

    Arguments and results must pickle. A run with another factory gives it to the same workers.

    Args:
        jobs: arguments that run at the same time, at least 1.
    """

    def __init__(self, jobs: int) -> None:
        self._jobs = jobs
        self._processes: list[WorkerProcess[Any, Any]] = []
        self._current: weakref.ref[Generator[Any, None, None]] | None = None

    @property
    def processes(self) -> int:
        """How many arguments run at the same time."""
        return self._jobs

    def run(self, factory: Factory[A, R], arguments: Iterable[A]) -> Iterator[Finished[R]]:
        """Every argument's end, in the order in which they come; ends a run that was left unfinished."""
        self._end_run()
        if not self._processes:
            self._processes = [WorkerProcess(factory, "local") for _ in range(self._jobs)]
        elif self._processes[0].factory != factory:
            for process in self._processes:
                process.take(factory)
        ends = _ends(WorkerGroup(self._processes, prefetch=self._jobs), arguments)
        self._current = weakref.ref(ends)
        return ends

    def close(self) -> None:
        """End the workers, also those at work."""
        self._end_run()
        processes, self._processes = self._processes, []
        for process in processes:
            process.close()

    def _end_run(self) -> None:
        unfinished = self._current() if self._current is not None else None
        if unfinished is not None:
            unfinished.close()


def _ends(group: WorkerGroup[A, R], arguments: Iterable[A]) -> Generator[Finished[R], None, None]:
    try:
        yield from ends_of(group, arguments)
    finally:
        group.end_work()
