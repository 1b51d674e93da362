"""What a solution leads to with the rows on that it violates: one way for holds, reach and lifts.

Rows that part bodies are left out of a program at first (`posture.parting`). Where a solution violates some,
the solve goes on with these on; where going on leads nowhere, it begins anew with them on. A solution that
rows hold is parted in other ways, as long as it gains by them.
"""

from __future__ import annotations

from typing import Protocol, TypeVar

import numpy as np

from evodesign.posture.seeking.budget import BUDGET

Solve = TypeVar("Solve")

UNSETTLED = "rows remain that are to be switched on"


class Switched(Protocol[Solve]):
    """Solves of a program with rows that can be switched on."""

    def is_solved(self, solve: Solve, /) -> bool:
        """Whether it succeeded."""
        ...

    def cost(self, solve: Solve, /) -> float:
        """Of its last iterate."""
        ...

    def has_rows(self, solve: Solve, /) -> bool:
        """Whether rows are on at its end."""
        ...

    def began_with_rows(self, solve: Solve, /) -> bool:
        """Whether rows were on where the first of the solves that led to it began."""
        ...

    def violated(self, solve: Solve, /) -> Solve | None:
        """The solve that goes on with the rows on that it violates; None if it violates none."""
        ...

    def anew(self, first: Solve, found: Solve, /) -> Solve:
        """The solve that begins where the first one began, with rows on: at least those of what it led to."""
        ...

    def better(self, solve: Solve, least: float, /) -> Solve | None:
        """The solve that goes on with bodies parted in other ways; None where it gains less than `least`."""
        ...

    def unsettled(self, solve: Solve, /) -> Solve:
        """A solve as one that failed, as rows remain that are to be switched on."""
        ...


def parted(program: Switched[Solve], first: Solve) -> Solve:
    """A solution with the rows on that it violates; itself where it violates none, or failed."""
    found = _without_violations(program, first)
    if found is first or program.is_solved(found) or program.began_with_rows(first):
        return found
    return _without_violations(program, program.anew(first, found))


def bettered(program: Switched[Solve], found: Solve, share: float, gain: float = 0.0) -> Solve:
    """A solution whose rows are kept in better ways, as long as it gains by them.

    Args:
        program: whose solution it is.
        found: the solution.
        share: of its cost, that it must gain at least.
        gain: in the cost's unit, likewise; if infinite, no better ways are sought.
    """
    for _ in range(BUDGET.rounds):
        if gain == np.inf or not (program.is_solved(found) and program.has_rows(found)):
            break
        least = max(gain, share * abs(program.cost(found)))
        other = program.better(found, least)
        if other is None:
            break
        other = _without_violations(program, other)
        if not (program.is_solved(other) and program.cost(other) < program.cost(found) - least):
            break
        found = other
    return found


def _without_violations(program: Switched[Solve], solve: Solve) -> Solve:
    """Rows are switched on until none is violated."""
    for _ in range(BUDGET.rounds):
        further = program.violated(solve) if program.is_solved(solve) else None
        if further is None:
            return solve
        solve = further
    return program.unsettled(solve) if program.is_solved(solve) else solve
