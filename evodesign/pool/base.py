"""What a pool is: a place where evaluations run, knowing no robots.

A task is built once per worker by a `factory` (which must pickle, and compare equal to its copies: a
function of a module or a frozen dataclass) and then receives arguments one by one. Results come back in
any order, each with the index of its argument.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from types import TracebackType
from typing import Generic, Protocol, Self, TypeVar

__all__ = ["Factory", "Finished", "Pool"]

A = TypeVar("A")
R = TypeVar("R")
Factory = Callable[[], Callable[[A], R]]


@dataclass(frozen=True)
class Finished(Generic[R]):
    """One argument's end.

    Args:
        index: position of the argument in the sequence given.
        value: the task's result; None when it failed.
        failure: a sentence saying why there is no value; None when there is one.
        worker_lost: whether the worker died (also when retried alone).
        seconds: wall time of the task [s].
        worker: name of the worker.
    """

    index: int
    value: R | None
    failure: str | None
    worker_lost: bool
    seconds: float
    worker: str


class Pool(Protocol):
    """Runs one task over many arguments; a context manager that closes itself.

    A pool holds one run at a time: exhaust or close its iterator before the next.
    """

    def run(self, factory: Factory[A, R], arguments: Sequence[A]) -> Iterator[Finished[R]]:
        """Every argument's end, once each, in the order in which they come; a task's error never raises."""

    def close(self) -> None:
        """Release the workers; a later run starts new ones."""

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        where: TracebackType | None,
    ) -> None:
        self.close()
