"""What runs in a Dask worker: every thread of it keeps a worker process of its own for the evaluations.

So whatever an evaluation does, the Dask worker lives on and reports the reason. Its processes end
with it.
"""

from __future__ import annotations

import multiprocessing
import socket
import threading
from typing import Any, TypeVar

from evodesign.pool.base import Factory, Finished
from evodesign.pool.worker_group import WorkerGroup
from evodesign.pool.worker_process import WorkerProcess

__all__ = ["deliver", "finish_there"]

A = TypeVar("A")
R = TypeVar("R")


class _Thread(threading.local):
    """The worker process of each thread of this Dask worker."""

    process: WorkerProcess[Any, Any] | None = None


_thread = _Thread()


def deliver(factory: Factory[A, R]) -> Factory[A, R]:
    """A factory, as a result that Dask keeps, copies to each worker once, and makes again when it is lost."""
    return factory


def finish_there(factory: Factory[A, R], index: int, argument: A) -> Finished[R]:
    """Run a factory's task on an argument, in the process of this thread."""
    if _thread.process is None or _thread.process.factory != factory:
        if _thread.process is not None:
            _thread.process.close()
        multiprocessing.current_process().daemon = False  # Dask's mark, with which no process may be started
        _thread.process = WorkerProcess(factory, socket.gethostname())
    group = WorkerGroup([_thread.process])
    group.begin(index, argument)
    return group.next_end()
