"""A gate before a pool: once it is shut, no further argument is worked on.

A pool takes its arguments one by one while it runs. A shut gate gives it a placeholder in the place of each
argument that is still to come, and the gated task gives a placeholder back untouched; so the pool soon comes
to the end of its run, and what was in flight when the gate was shut is finished properly.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Generic, TypeVar, cast, overload

from evodesign.pool.base import Factory, Finished, Pool

__all__ = ["Gate", "Gated", "Withheld", "run_gated"]

A = TypeVar("A")
R = TypeVar("R")


class Withheld(Enum):
    """Stands for an argument that came too late, and for the result that it does not have."""

    WITHHELD = "withheld"


@dataclass(frozen=True)
class Gated(Generic[A, R]):
    """A factory of tasks that leave placeholders alone; equal to its copies as the factory inside is."""

    factory: Factory[A, R]

    def __call__(self) -> Callable[[A | Withheld], R | Withheld]:
        """The task of the factory inside, behind the gate."""
        task = self.factory()
        return lambda argument: argument if isinstance(argument, Withheld) else task(argument)


class Gate(Sequence[A | Withheld]):
    """The arguments of a run, each given away only as long as the gate is open.

    Args:
        arguments: in order.
        shut: asked whenever an argument is taken, in any thread; True from some moment on.
    Attributes:
        withheld: indices of the arguments that came too late.
    """

    def __init__(self, arguments: Sequence[A], shut: Callable[[], bool]) -> None:
        self._arguments = arguments
        self._shut = shut
        self.withheld: set[int] = set()

    def __len__(self) -> int:
        return len(self._arguments)

    @overload
    def __getitem__(self, index: int) -> A | Withheld: ...

    @overload
    def __getitem__(self, index: slice) -> Sequence[A | Withheld]: ...

    def __getitem__(self, index: int | slice) -> A | Withheld | Sequence[A | Withheld]:
        if isinstance(index, slice):
            return [self[each] for each in range(*index.indices(len(self)))]
        argument = self._arguments[index]  # an index out of range ends an iteration, also of a shut gate
        if self._shut():
            self.withheld.add(index)
            return Withheld.WITHHELD
        return argument


def run_gated(
    pool: Pool, factory: Factory[A, R], arguments: Sequence[A], shut: Callable[[], bool]
) -> Generator[Finished[R], None, None]:
    """The ends of all arguments that a pool took before the gate was shut, as they come.

    Args:
        pool: where the task runs.
        factory: as in `Pool.run`.
        arguments: as in `Pool.run`.
        shut: as in `Gate`.
    """
    gate = Gate(arguments, shut)
    results = pool.run(Gated(factory), gate)
    try:
        for finished in results:
            if finished.index not in gate.withheld:
                yield cast("Finished[R]", finished)
    finally:
        if isinstance(results, Generator):
            results.close()
