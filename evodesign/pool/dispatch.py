"""Handing out arguments and taking back ends, whatever the workers are.

An argument that lost its worker, or found no memory, may have suffered from what ran beside it. It is set
aside and tried once more when all others have ended, with nothing beside it: that second end holds. What a
retry cannot help (an exception, a time limit) ends at once.

A run that is to stop early is given no further argument from some moment on, and finishes what it has.
"""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Callable, Generator, Iterable, Iterator
from typing import Protocol, TypeVar

from evodesign.pool.base import A, Factory, Finished, Pool, R

A_in = TypeVar("A_in", contravariant=True)


class WorkerSet(Protocol[A_in, R]):
    """Workers as the dispatch sees them."""

    def free(self) -> int:
        """How many arguments would be begun at once; at least one when none is at work."""

    def begin(self, index: int, argument: A_in) -> None:
        """Begin an argument."""

    def more(self) -> bool:
        """Whether the next end is there already."""

    def next_end(self) -> Finished[R]:
        """Wait for the end of one of the arguments begun; whatever happens to a worker is an end."""


def ends_of(hands: WorkerSet[A, R], arguments: Iterable[A]) -> Iterator[Finished[R]]:
    """The end of every argument, once each, as they come; those tried again come last."""
    source = enumerate(arguments)
    begun: dict[int, A] = {}
    again: dict[int, A] = {}

    def hand_out() -> None:
        for index, argument in itertools.islice(source, hands.free()):
            begun[index] = argument
            hands.begin(index, argument)

    hand_out()
    while begun:
        end = hands.next_end()
        argument = begun.pop(end.index)
        hand_out()
        if end.worker_lost or end.out_of_memory:
            again[end.index] = argument
        else:
            yield dataclasses.replace(end, more=True) if hands.more() else end
    for index, argument in again.items():
        hands.begin(index, argument)
        yield _second(hands.next_end())


def _second(end: Finished[R]) -> Finished[R]:
    if end.failure is None:
        return end
    return dataclasses.replace(end, failure=f"{end.failure}, also when retried alone")


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
