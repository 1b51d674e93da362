"""What runs in a Dask worker: every thread of it keeps a worker process of its own for the evaluations.

So whatever an evaluation does, the Dask worker lives on, knows the reason, and tells it. Its processes end
with it.
"""

from __future__ import annotations

import multiprocessing
import socket
import threading
from typing import Any, TypeVar

from evodesign.pool.base import Factory, Finished
from evodesign.pool.cell import Cell
from evodesign.pool.crew import Crew

__all__ = ["deliver", "finish_there"]

A = TypeVar("A")
R = TypeVar("R")


class _Thread(threading.local):
    """The cell of each thread of this Dask worker."""

    cell: Cell[Any, Any] | None = None


_thread = _Thread()


def deliver(factory: Factory[A, R]) -> Factory[A, R]:
    """A factory, as a result that Dask keeps, copies to each worker once, and makes again when it is lost."""
    return factory


def finish_there(factory: Factory[A, R], index: int, argument: A) -> Finished[R]:
    """Run a factory's task on an argument, in the process of this thread."""
    if _thread.cell is None or _thread.cell.factory != factory:
        if _thread.cell is not None:
            _thread.cell.close()
        multiprocessing.current_process().daemon = False  # Dask's mark, with which no process may be started
        _thread.cell = Cell(factory, socket.gethostname())
    crew = Crew([_thread.cell])
    crew.begin(index, argument)
    return crew.next_end()
