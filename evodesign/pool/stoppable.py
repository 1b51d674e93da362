"""Stopping a pool early: from some moment on it is given no further argument, and finishes what it has."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable, Iterator
from typing import TypeVar

from evodesign.pool.base import Factory, Finished, Pool

__all__ = ["run_stoppable"]

A = TypeVar("A")
R = TypeVar("R")


def run_stoppable(
    pool: Pool, factory: Factory[A, R], arguments: Iterable[A], stop: Callable[[], bool]
) -> Generator[Finished[R], None, None]:
    """The ends of all arguments that a pool took before the stop, as they come.

    Args:
        pool: where the task runs.
        factory: as in `Pool.run`.
        arguments: as in `Pool.run`.
        stop: called whenever an argument is about to be taken; True from some moment on.
    """
    results = pool.run(factory, _until(stop, arguments))
    try:
        yield from results
    finally:
        if isinstance(results, Generator):
            results.close()


def _until(stop: Callable[[], bool], arguments: Iterable[A]) -> Iterator[A]:
    for argument in arguments:
        if stop():
            return
        yield argument
