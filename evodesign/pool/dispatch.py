"""Handing out arguments and taking back ends, whatever the workers are.

An argument that lost its worker, or found no memory, may have suffered from what ran beside it. It is set
aside and tried once more when all others have ended, with nothing beside it: that second end holds. What a
retry cannot help (an exception, a time limit) ends at once.
"""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Iterable, Iterator
from typing import Protocol, TypeVar

from evodesign.pool.base import Finished

__all__ = ["Workers", "ends_of"]

A = TypeVar("A")
R = TypeVar("R")
A_in = TypeVar("A_in", contravariant=True)


class Workers(Protocol[A_in, R]):
    """Workers as the dispatch sees them."""

    def free(self) -> int:
        """How many arguments would be begun at once; at least one when none is at work."""

    def begin(self, index: int, argument: A_in) -> None:
        """Begin an argument."""

    def more(self) -> bool:
        """Whether the next end is there already."""

    def next_end(self) -> Finished[R]:
        """Wait for the end of one of the arguments begun; whatever happens to a worker is an end."""


def ends_of(hands: Workers[A, R], arguments: Iterable[A]) -> Iterator[Finished[R]]:
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
