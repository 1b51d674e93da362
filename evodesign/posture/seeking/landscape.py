"""A cost to be minimised from one start or another, whatever the design."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from evodesign.nlp.program import Start
from evodesign.nlp.solver import RawSolution, has_any
from evodesign.posture.seeking.seeker import Seeker
from evodesign.records import Status

REFUSED = "the check refuses it"

Costs = NDArray[np.float64]
Design = tuple[float, ...]


class StartResult(Protocol):
    """Where a solve from a start ended."""

    @property
    def cost(self) -> float:
        """Of the last iterate."""
        ...

    @property
    def status(self) -> Status:
        """Solved, or why not."""
        ...

    @property
    def iterations(self) -> int:
        """What it took."""
        ...


End = TypeVar("End", bound=StartResult)


class Searched(Protocol[End]):
    """A cost to be minimised, whatever the design, from one start or another."""

    @property
    def universal(self) -> tuple[Start, ...]:
        """From which optima are sought, for any design."""
        ...

    def random_start(self, rng: np.random.Generator) -> Start:
        """Another start, drawn."""
        ...

    def free(self, design: Design, start: Start) -> End:
        """The optimum from a start, without what comes in where it is violated: a cheaper one."""
        ...

    def settled(self, design: Design, end: End) -> End:
        """The same with all that it violates."""
        ...

    def finished(self, design: Design, end: End) -> End:
        """A settled one as good as it gets; one that does not count has failed."""
        ...

    def needed(self, end: End) -> Start:
        """Where solves begin that are to end near a result."""
        ...

    def size(self, start: Start) -> float:
        """Work of an iteration from a start, against others."""
        ...

    def good(self, costs: Costs, best: Costs) -> NDArray[np.bool_]:
        """Which costs are close enough to the best ones."""
        ...


@dataclass(frozen=True, slots=True)
class Landscape:
    """A cost to be minimised, whatever the design.

    Args:
        seeker: of a program with a parameter `design`.
        beside: its other parameters, by name.
        starts: fixed ones, for any design.
        relative, absolute: how far above the best optimum another one is still good, as a share of its cost
            and in the cost's unit.
        begun: where a solve begins for a start and the parameters; left out, at the start as it is.
        cleared: what a solution of a design leads to that counts, or one that failed; left out, each does.
        universal: starts all over the program's variables, from which optima are sought.
        known: parts of starts that are known beforehand; each drawn start has one of them.
    """

    seeker: Seeker
    beside: Mapping[str, Any]
    starts: tuple[Start, ...]
    relative: float
    absolute: float
    begun: Callable[[Start, Mapping[str, Any]], Start] | None = None
    cleared: Callable[[Design, RawSolution], RawSolution] | None = None
    universal: tuple[Start, ...] = ()
    known: tuple[Start, ...] = ()

    def solve(self, design: Design, start: Start) -> RawSolution:
        """The optimum that the solver finds from a start."""
        return self.finished(design, self.settled(design, self.free(design, start)))

    def free(self, design: Design, start: Start) -> RawSolution:
        """The optimum from a start; bodies pass through each other, but for those that it parts."""
        parameters = {"design": design, **self.beside}
        if self.begun is not None:
            start = self.begun(start, parameters)
        return self.seeker.solver.solve(parameters, start)

    def settled(self, design: Design, end: RawSolution) -> RawSolution:
        """What it leads to with bodies parted somehow, whether that counts or not."""
        return self.seeker.settled({"design": design, **self.beside}, end, gain=np.inf)

    def finished(self, design: Design, end: RawSolution) -> RawSolution:
        """The same with bodies parted in better ways; one that does not count has failed."""
        found = self.seeker.bettered({"design": design, **self.beside}, end, 0.0)
        if found.status is not Status.SOLVED or self.cleared is None:
            return found
        return self.cleared(design, found)

    def good(self, costs: Costs, best: Costs) -> NDArray[np.bool_]:
        """Which costs are close enough to the best ones."""
        return costs <= best + self.relative * np.abs(best) + self.absolute

    def needed(self, end: RawSolution) -> Start:
        """Its values without the rows on that do not hold it."""
        return self.seeker.needed(end)

    def size(self, start: Start) -> float:
        """Variables and rows of the program that is solved from a start."""
        program = self.seeker.program
        switches = program.switches
        if switches is not None and has_any(switches.names, start):
            program = switches.program
        return float(program.symbols.numel() + program.rows.numel())

    def random_start(self, rng: np.random.Generator) -> Start:
        """A free start, but for what is known."""
        start = self.free_start(rng)
        return {**start, **self.known[int(rng.integers(len(self.known)))]} if self.known else start

    def free_start(self, rng: np.random.Generator) -> Start:
        """One of the fixed starts, with all that is drawn anywhere between its bounds."""
        start = dict(self.starts[int(rng.integers(len(self.starts)))])
        for variable in self.seeker.program.variables:
            if variable.drawn:
                start[variable.name] = rng.uniform(variable.lower, variable.upper)
        return start


def cost_of(end: StartResult) -> float:
    """Cost of a solve that converged; infinite for one that did not."""
    return end.cost if end.status is Status.SOLVED else np.inf
