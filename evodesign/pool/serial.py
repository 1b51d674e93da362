"""A pool of one: everything runs in this process, in order."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any, TypeVar

from evodesign.pool.base import Factory, Finished, Pool
from evodesign.pool.worker import Workbench

__all__ = ["SerialPool"]

A = TypeVar("A")
R = TypeVar("R")


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
