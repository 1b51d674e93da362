"""What a solution leads to with the rows on that it violates: one way for holds, reach and lifts.

Rows that part bodies are left out of a program at first (`posture.parting`). Where a solution violates some,
the solve goes on with these on; where going on leads nowhere, it begins anew with them on. A solution that
rows hold is parted in other ways, as long as it gains by them.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Generic, TypeVar

import numpy as np

from evodesign.posture.seeking.budget import BUDGET

Solve = TypeVar("Solve")
Rows = TypeVar("Rows")

UNSETTLED = "rows remain that are to be switched on"


class Switched(ABC, Generic[Solve, Rows]):
    """Solves of a program with rows that can be switched on."""

    @abstractmethod
    def is_solved(self, solve: Solve, /) -> bool:
        """Whether it succeeded."""

    @abstractmethod
    def cost(self, solve: Solve, /) -> float:
        """Of its last iterate."""

    @abstractmethod
    def has_rows(self, solve: Solve, /) -> bool:
        """Whether rows are on at its end."""

    @abstractmethod
    def began_with_rows(self, solve: Solve, /) -> bool:
        """Whether rows were on where the first of the solves that led to it began."""

    @abstractmethod
    def violated(self, solve: Solve, /) -> Rows | None:
        """The rows that it violates, to be switched on; None if it violates none."""

    @abstractmethod
    def better(self, solve: Solve, least: float, /) -> Rows | None:
        """Rows that part its bodies in other ways; None where they gain less than `least`."""

    @abstractmethod
    def further(self, solve: Solve, rows: Rows, /, *, near: bool = False) -> Solve:
        """The solve that goes on with rows on; `near` tells whether its end is expected close by."""

    @abstractmethod
    def anew(self, first: Solve, found: Solve, /) -> Solve:
        """The solve that begins where the first one began, with rows on: at least those of what it led to."""

    @abstractmethod
    def unsettled(self, solve: Solve, /) -> Solve:
        """A solve as one that failed, as rows remain that are to be switched on."""

    def parted(self, first: Solve, *, anew: bool = True) -> Solve:
        """A solution with the rows on that it violates; itself where it violates none, or failed.

        Args:
            first: the solution.
            anew: whether it begins anew where going on leads nowhere.
        """
        found = first
        for again in (anew, False):
            for _ in range(BUDGET.rounds):
                rows = self.violated(found) if self.is_solved(found) else None
                if rows is None:
                    break
                found = self.further(found, rows)
            else:
                found = self.unsettled(found) if self.is_solved(found) else found
            if not again or found is first or self.is_solved(found) or self.began_with_rows(first):
                break
            found = self.anew(first, found)
        return found

    def bettered(self, found: Solve, share: float, gain: float = 0.0) -> Solve:
        """A solution whose rows are kept in better ways, as long as it gains by them.

        Args:
            found: the solution.
            share: of its cost, that it must gain at least.
            gain: in the cost's unit, likewise; if infinite, no better ways are sought.
        """
        for _ in range(BUDGET.rounds):
            if gain == np.inf or not (self.is_solved(found) and self.has_rows(found)):
                break
            least = max(gain, share * abs(self.cost(found)))
            rows = self.better(found, least)
            if rows is None:
                break
            other = self.parted(self.further(found, rows, near=True), anew=False)
            if not (self.is_solved(other) and self.cost(other) < self.cost(found) - least):
                break
            found = other
        return found
