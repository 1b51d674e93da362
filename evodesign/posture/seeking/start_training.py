"""A portfolio of starts: a few from which nearly every design converges to its best known optimum.

Random starts hardly ever lead to the best of dozens of optima; optima of other designs do. Some quasi-random
designs are solved from the landscape's universal starts and from a few random ones. Then the best optimum of
a design that no start serves is offered to all designs, until each is served: a start serves a design if the
solver converges from it to within 1 % of the best optimum that any start led to. Of the offers those are kept
that serve all together with little work. The same landscape always gets the same portfolio.

Source: greedy cover: Johnson 1974.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import islice
from typing import Generic

import numpy as np
from numpy.typing import NDArray

from evodesign.nlp.program import Start
from evodesign.posture.seeking.landscape import Costs, Design, End, Searched, cost_of
from evodesign.posture.seeking.start_portfolio import Coverage, StartPortfolio

SAME = 1e-3
"""Share of their costs by which two optima of one design differ at most that are one."""


@dataclass(frozen=True, slots=True)
class Training:
    """How much work goes into a portfolio.

    Args:
        designs: to learn from.
        begun: how many of them are solved from the universal starts and random ones.
        random: starts of each of these.
        offers: optima that are offered at most.
        portfolio: the most starts that a portfolio holds.
    """

    designs: int = 48
    begun: int = 24
    random: int = 3
    offers: int = 24
    portfolio: int = 8


USUAL = Training()


def start_portfolio(
    landscape: Searched[End],
    designs: Iterable[Design],
    training: Training = USUAL,
) -> StartPortfolio:
    """The portfolio of a landscape.

    Args:
        landscape: whose optima are sought.
        designs: to learn from; the portfolio makes do with those that there are.
        training: how much work to do.
    """
    learned = [*islice(designs, training.designs)]
    work = _Ends(landscape, learned)
    rng = np.random.default_rng(0)
    for place in range(min(training.begun, len(learned))):
        drawn = [landscape.random_start(rng) for _ in range(training.random)]
        work.begun(place, [*landscape.universal, *drawn])
    for _ in range(training.offers):
        wanted = work.wanted()
        if wanted is None:
            break
        work.offered(wanted)
    return work.portfolio(training.portfolio)


@dataclass(frozen=True, slots=True)
class _Tried:
    """Where a start led a design: the cost, infinite where it led nowhere, and what that took."""

    cost: float
    iterations: int


class _Ends(Generic[End]):
    """Where offers lead designs. Optima of a design with one cost are one: it is settled once."""

    def __init__(self, landscape: Searched[End], designs: Sequence[Design]) -> None:
        self._landscape, self._designs = landscape, designs
        self._best: list[End | None] = [None] * len(designs)
        self._refused: set[int] = set()
        self._offers: list[Start] = []
        self._ends: list[list[_Tried]] = []
        self._settled: list[list[tuple[float, int, End]]] = [[] for _ in designs]

    def begun(self, place: int, starts: Sequence[Start]) -> None:
        """Solve a design from some starts; the cheapest end is settled while another one may cost less."""
        free = self._landscape.free
        for end in sorted((free(self._designs[place], start) for start in starts), key=cost_of):
            if cost_of(end) < self._cost(place):
                self._settle(place, end)

    def offered(self, start: Start) -> None:
        """Offer a start to all designs; ends that cost too much although bodies pass are not settled."""
        self._offers.append(start)
        self._ends.append([self._tried(place, start) for place in range(len(self._designs))])

    def _tried(self, place: int, start: Start) -> _Tried:
        end = self._landscape.free(self._designs[place], start)
        best, cost = self._cost(place), cost_of(end)
        if np.isfinite(best) and not self._landscape.good(np.array([cost]), np.array([best]))[0]:
            return _Tried(cost, end.iterations)
        return self._settle(place, end)

    def _settle(self, place: int, end: End) -> _Tried:
        """An end settled, finished where it may be the best of its design, and remembered."""
        cost = cost_of(end)
        for other, iterations, settled in self._settled[place]:
            if abs(cost - other) <= SAME * abs(other):
                return _Tried(cost_of(settled), end.iterations + settled.iterations - iterations)
        settled = self._landscape.settled(self._designs[place], end)
        found = self._learned(place, settled)
        self._settled[place].append((cost, end.iterations, found))
        return _Tried(cost_of(found), found.iterations)

    def wanted(self) -> Start | None:
        """The best optimum of the first design that no offer serves, once each; None where there is none."""
        for place in np.flatnonzero(~self._good.any(axis=1)).tolist():
            best = self._best[place]
            if best is not None and place not in self._refused:
                self._refused.add(place)
                return self._landscape.needed(best)
        return None

    def _learned(self, place: int, end: End) -> End:
        """An end; as one that failed where it would be the best of a design and does not count."""
        if not cost_of(end) < self._cost(place):
            return end
        found = self._landscape.finished(self._designs[place], end)
        if cost_of(found) < self._cost(place):
            self._best[place] = found
            self._refused.discard(place)
        return end if np.isfinite(cost_of(found)) else found

    def _cost(self, place: int) -> float:
        best = self._best[place]
        return np.inf if best is None else cost_of(best)

    @property
    def _costs(self) -> Costs:
        """Of each design (row) from each offer (column)."""
        shape = len(self._offers), len(self._designs)
        return np.array([[end.cost for end in row] for row in self._ends]).reshape(shape).T

    @property
    def _good(self) -> NDArray[np.bool_]:
        """Whether an offer (column) serves a design (row)."""
        costs, best = self._costs, np.array([self._cost(place) for place in range(len(self._designs))])
        held = np.isfinite(best)
        good = np.zeros(costs.shape, bool)
        good[held] = np.isfinite(costs[held]) & self._landscape.good(costs[held], best[held, None])
        return good

    def portfolio(self, most: int) -> StartPortfolio:
        """The offers that are chosen; how well they do is told of a choice made with half of the designs."""
        best = np.array([self._cost(place) for place in range(len(self._designs))])
        held = np.isfinite(best)
        good, costs, best = self._good[held], self._costs[held], best[held]
        work = np.array([sum(end.iterations for end in row) for row in self._ends], dtype=float)
        work *= [self._landscape.size(start) for start in self._offers]
        half = len(good) // 2
        few = _cover(good[:half], work, most)
        kept = good[half:][:, few].any(axis=1)
        short = costs[half:][:, few].min(axis=1, initial=np.inf) - best[half:]
        worst = float(np.max(short[np.isfinite(short)], initial=0.0))
        every = _cover(good, work, most)
        coverage = Coverage(len(kept), int(kept.sum()), worst)
        return StartPortfolio(tuple(self._offers[place] for place in every), coverage)


def _cover(good: NDArray[np.bool_], work: Costs, most: int) -> list[int]:
    """Starts that together serve all designs that any serves: those that serve most first, of little work."""
    found: list[int] = []
    wanted = good.any(axis=1).sum()
    while len(found) < most and good[:, found].any(axis=1).sum() < wanted:
        new = good[~good[:, found].any(axis=1)].sum(axis=0)
        place = int(np.argmax(new / np.maximum(work, 1.0)))
        if not new[place]:
            break
        found.append(place)
    for place in sorted(found, key=lambda each: -work[each]):
        others = [each for each in found if each != place]
        if good[:, others].any(axis=1).sum() == good[:, found].any(axis=1).sum():
            found = others
    return sorted(found, key=lambda each: -int(good[:, each].sum()))
