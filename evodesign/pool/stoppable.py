"""A gate before a pool: once it is shut, the pool is given no further argument, and finishes what it has."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable, Iterator
from typing import TypeVar

from evodesign.pool.base import Factory, Finished, Pool

__all__ = ["run_stoppable"]

A = TypeVar("A")
R = TypeVar("R")


def run_stoppable(
    pool: Pool, factory: Factory[A, R], arguments: Iterable[A], shut: Callable[[], bool]
) -> Generator[Finished[R], None, None]:
    """The ends of all arguments that a pool took before the gate was shut, as they come.

    Args:
        pool: where the task runs.
        factory: as in `Pool.run`.
        arguments: as in `Pool.run`.
        shut: asked whenever an argument is about to be taken; True from some moment on.
    """
    results = pool.run(factory, _until(shut, arguments))
    try:
        yield from results
    finally:
        if isinstance(results, Generator):
            results.close()


def _until(shut: Callable[[], bool], arguments: Iterable[A]) -> Iterator[A]:
    for argument in arguments:
        if shut():
            return
        yield argument
