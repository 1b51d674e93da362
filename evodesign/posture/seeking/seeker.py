"""Solutions of one program, sought from several starts: proposed, given up or gone on with, settled."""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np

from evodesign.nlp.program import Array, Program, Start, Switches
from evodesign.nlp.solver import RawSolution, Solver, has_any
from evodesign.posture.seeking.budget import BUDGET
from evodesign.posture.seeking.settling import UNSETTLED, Switched
from evodesign.records import Status

Parameters = Mapping[str, Any]


class Seeker:
    """Seeks solutions of a program.

    Args:
        solver: of the program.
    """

    def __init__(self, solver: Solver) -> None:
        self.solver = solver

    @property
    def program(self) -> Program:
        """What is solved."""
        return self.solver.program

    @cached_property
    def brief(self) -> Solver:
        """The same for solves that are given up early."""
        return self.solver.with_options(BUDGET.briefly(self.solver.options))

    @cached_property
    def by_ipopt(self) -> Seeker:
        """The same by IPOPT."""
        return Seeker(self.solver.by_ipopt)

    def ends(self, parameters: Parameters, starts: Sequence[Mapping[str, Array]]) -> list[RawSolution]:
        """Where starts lead to; solves that take long are given up unless all of them do."""
        solver = self.brief if len(starts) > 1 else self.solver
        ends = [*map(functools.partial(solver.solve, parameters), starts)]
        if len(starts) == 1 or any(raw.status is Status.SOLVED for raw in ends):
            return ends
        return [
            self.solver.solve(parameters, start) if raw.status is Status.ITERATION_LIMIT else raw
            for start, raw in zip(starts, ends, strict=True)
        ]

    def further(self, parameters: Parameters, raw: RawSolution, on: Start) -> RawSolution:
        """What a solution leads to with other rows on, and those that it then violates."""
        found = self.solver.solve(parameters, {**raw.values, **on})
        return self.settled(parameters, _after(raw, found), np.inf)

    def continued(self, parameters: Parameters, raw: RawSolution) -> RawSolution:
        """What a solve that was given up leads to when it has as long again."""
        return _after(raw, self.brief.solve(parameters, raw.values))

    def settled(
        self, parameters: Parameters, raw: RawSolution, gain: float = 0.0, *, patient: bool = True
    ) -> RawSolution:
        """A solution with the rows on that it violates; as it is where it violates none.

        Args:
            parameters: that it was found for.
            raw: the solution; one that failed stays as it is.
            gain: of its cost, below which rows are not kept in better ways; if infinite, none are sought.
            patient: whether solves that take long are not given up.
        """
        switches, solver = self.program.switches, self.solver if patient else self.brief
        if switches is None:
            return raw
        found = _RawSolves(solver, switches, parameters).parted(raw)
        return _RawSolves(self.solver, switches, parameters).bettered(found, BUDGET.part_better, gain)

    def bettered(self, parameters: Parameters, found: RawSolution, gain: float) -> RawSolution:
        """A solution whose rows are kept in better ways, as long as it gains more by them than `gain`."""
        switches = self.program.switches
        if switches is None:
            return found
        return _RawSolves(self.solver, switches, parameters).bettered(found, BUDGET.part_better, gain)

    def needed(self, raw: RawSolution) -> Start:
        """A solution's values without the rows on that do not hold it: for solves that begin close to it."""
        switches = self.program.switches
        if switches is None or raw.status is not Status.SOLVED or not has_any(switches.names, raw.values):
            return raw.values
        on = switches.needed(raw.values, raw.multipliers.constraints, BUDGET.free * abs(raw.cost))
        return {**raw.values, **on}


class _RawSolves(Switched[RawSolution, Start]):
    """Solves of a program with switches, for some parameters."""

    def __init__(self, solver: Solver, switches: Switches, parameters: Parameters) -> None:
        self.solver, self.switches, self.parameters = solver, switches, parameters

    def is_solved(self, solve: RawSolution) -> bool:
        return solve.status is Status.SOLVED

    def cost(self, solve: RawSolution) -> float:
        return solve.cost

    def has_rows(self, solve: RawSolution) -> bool:
        return has_any(self.switches.names, solve.values)

    def began_with_rows(self, solve: RawSolution) -> bool:
        return has_any(self.switches.names, solve.start)

    def violated(self, solve: RawSolution) -> Start | None:
        return self.switches.violated(solve.values, self.parameters) or None

    def better(self, solve: RawSolution, least: float) -> Start | None:
        return (
            self.switches.better(solve.values, self.parameters, solve.multipliers.constraints, least) or None
        )

    def further(self, solve: RawSolution, rows: Start, *, near: bool = False) -> RawSolution:
        solver = self.solver.near if near else self.solver
        return _after(solve, solver.solve(self.parameters, {**solve.values, **rows}))

    def anew(self, first: RawSolution, found: RawSolution) -> RawSolution:
        on = self.switches.begun(first.start, self.parameters, found.values)
        return self.solver.solve(self.parameters, {**first.start, **on})

    def unsettled(self, solve: RawSolution) -> RawSolution:
        return replace(solve, status=Status.NUMERICAL_FAILURE, reason=UNSETTLED)


def _after(first: RawSolution, then: RawSolution) -> RawSolution:
    """A solve that began where another one ended, with the start of that and the work of both."""
    iterations, seconds = first.iterations + then.iterations, first.seconds + then.seconds
    return replace(then, start=first.start, iterations=iterations, seconds=seconds)
