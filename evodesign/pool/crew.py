"""Worker processes of one machine, working side by side."""

from __future__ import annotations

import time
from collections.abc import Iterable
from concurrent.futures import FIRST_COMPLETED, Future, wait
from typing import Generic, TypeVar

from evodesign.pool.base import Finished
from evodesign.pool.cell import Cell

__all__ = ["Crew"]

A = TypeVar("A")
R = TypeVar("R")

LOOK_EVERY = 0.2
"""Interval [s] at which limits are looked at: a new worker's begins when its task is built."""


class Crew(Generic[A, R]):
    """Cells that are free, and those at work.

    Args:
        cells: of one factory, all free.
    """

    def __init__(self, cells: Iterable[Cell[A, R]]) -> None:
        self._free = list(cells)
        self._busy: dict[Future[Finished[R]], tuple[int, Cell[A, R]]] = {}

    def free(self) -> int:
        """Cells without work."""
        return len(self._free)

    def begin(self, index: int, argument: A) -> None:
        """Give an argument to a free cell."""
        cell = self._free.pop()
        self._busy[cell.begin(index, argument)] = index, cell

    def next_end(self) -> Finished[R]:
        """The first end to come, or the first that is too late."""
        while True:
            earliest = min(cell.due for _, cell in self._busy.values())
            patience = min(LOOK_EVERY, max(0.0, earliest - time.perf_counter()))
            done, _ = wait(self._busy, patience, FIRST_COMPLETED)
            late = (future for future, (_, cell) in self._busy.items() if cell.due <= time.perf_counter())
            future = next(iter(done), None) or next(late, None)
            if future is not None:
                index, cell = self._busy.pop(future)
                end = cell.end(index, future)
                self._free.append(cell)
                return end

    def end_work(self) -> None:
        """End what is still at work."""
        for _, cell in self._busy.values():
            cell.close()
        self._busy.clear()
