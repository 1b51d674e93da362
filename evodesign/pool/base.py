"""What a pool is: a place where evaluations run, knowing no robots.

A task is built once per worker by a `factory` (which must pickle, and compare equal to its copies: a
function of a module or a frozen dataclass) and then receives arguments one by one. Results come back in
any order, each with the index of its argument.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from types import TracebackType
from typing import Generic, Protocol, Self, TypeVar, runtime_checkable

A = TypeVar("A")
R = TypeVar("R")
Factory = Callable[[], Callable[[A], R]]


@dataclass(frozen=True, slots=True)
class Limits:
    """What one argument may cost before its worker is ended and replaced.

    Args:
        seconds: wall time [s] of one argument.
        building_seconds: wall time [s] of starting a worker and building its task.
        memory: of a worker's process [byte]; None for what the machine has.
    """

    seconds: float = 600.0
    building_seconds: float = 600.0
    memory: int | None = None


@runtime_checkable
class Limited(Protocol):
    """A factory that knows its limits; any other one has those of `Limits()`."""

    @property
    def limits(self) -> Limits:
        """What one argument may cost."""


def limits_of(factory: Factory[A, R]) -> Limits:
    """The limits of a factory's task."""
    return factory.limits if isinstance(factory, Limited) else Limits()


@dataclass(frozen=True)
class Finished(Generic[R]):
    """One argument's end.

    Args:
        index: position of the argument in those given.
        value: the task's result; None when it failed.
        failure: a sentence saying why there is no value; None when there is one.
        worker_lost: whether the worker died (also when retried alone).
        seconds: wall time of the task [s].
        worker: name of the worker.
        out_of_time: whether the worker was ended because the argument took too long.
        out_of_memory: whether the task could not have the memory that it asked for.
        more: whether the next end is there already.
    """

    index: int
    value: R | None
    failure: str | None
    worker_lost: bool
    seconds: float
    worker: str
    out_of_time: bool = False
    out_of_memory: bool = False
    more: bool = False


class Pool(Protocol):
    """Runs one task over many arguments; a context manager that closes itself.

    A pool holds one run at a time: exhaust or close its iterator before the next.
    """

    @property
    def processes(self) -> int:
        """How many arguments run at the same time."""
        return 1

    def run(self, factory: Factory[A, R], arguments: Iterable[A]) -> Iterator[Finished[R]]:
        """Every argument's end, once each, in the order in which they come; a task's error never raises.

        Arguments are taken one by one, only while the caller waits for the next end, and only as many as
        workers need to be kept busy: an argument may be made from all ends given so far.
        """

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
