"""A portfolio of starts: a few from which nearly every design converges to its best known optimum.

Random starts hardly ever lead to the best of dozens of optima; optima of other designs do. Some quasi-random
designs are solved from the landscape's universal starts. Their best optima are offered to all designs; where
one leads a design to something better than is known of it, that is offered as well. Of all offers those are
chosen that serve the designs together with little work: a start serves a design if the solver converges from
it to within 1 % of the best known optimum. The same landscape always gets the same portfolio.

Source: greedy cover: Johnson 1974; Halton's points: scipy.stats.qmc.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from evodesign.nlp.landscape import Costs, Design, Searched, StartResult, cost_of
from evodesign.nlp.program import Start
from evodesign.nlp.start_portfolio import Coverage, StartPortfolio

__all__ = ["Training", "chosen", "start_portfolio"]


@dataclass(frozen=True, slots=True)
class Training:
    """How much work goes into a portfolio.

    Args:
        designs: to learn from.
        begun: how many of them are solved from the universal starts.
        rounds: in which optima that are better than those known are offered.
        portfolio: the most starts that a portfolio holds.
        served: share of the designs that any offer serves, for the portfolio to serve.
    """

    designs: int = 20
    begun: int = 12
    rounds: int = 2
    portfolio: int = 6
    served: float = 1.0


def start_portfolio(
    landscape: Searched, designs: Iterable[Design], training: Training, similar: Sequence[Start] = ()
) -> StartPortfolio:
    """The portfolio of a landscape.

    Args:
        landscape: whose optima are sought.
        designs: to learn from; the portfolio makes do with those that there are.
        training: how much work to do.
        similar: starts of similar landscapes, offered as well.
    """
    learned = [*islice(designs, training.designs)]
    work = _Ends(landscape, learned)
    offers = [*similar]
    for place in range(min(training.begun, len(learned))):
        offers += work.begun(place)
    for _ in range(training.rounds):
        offers = work.offered(offers)
    return work.portfolio(training.portfolio, training.served)


def chosen(
    landscape: Searched, offers: Sequence[Start], designs: Sequence[Design], most: int, served: float = 1.0
) -> StartPortfolio:
    """Those of some starts that serve designs as well as all of them do, with little work.

    Args:
        landscape: in which they are to serve.
        offers: starts of this landscape and of similar ones.
        designs: to choose and examine with.
        most: starts that the portfolio may hold.
        served: share of the designs that all of them serve, for the portfolio to serve.
    """
    work = _Ends(landscape, designs)
    work.offered(offers)
    return work.portfolio(most, served)


class _Ends:
    """Where offers lead designs."""

    def __init__(self, landscape: Searched, designs: Sequence[Design]) -> None:
        self._landscape, self._designs = landscape, designs
        self._best = np.full(len(designs), np.inf)
        self._offers: list[Start] = []
        self._ends: list[list[StartResult]] = []

    def begun(self, place: int) -> list[Start]:
        """The best optimum that the universal starts lead a design to, if any."""
        design = self._designs[place]
        ends = [self._landscape.rough(design, start) for start in self._landscape.universal]
        return [self._landscape.needed(end) for end in self._better(place, ends)]

    def offered(self, offers: Sequence[Start]) -> list[Start]:
        """Offer starts to all designs; what they lead to where that is better than all that was known."""
        self._offers += offers
        ends = [[self._landscape.rough(design, start) for design in self._designs] for start in offers]
        self._ends += ends
        columns = zip(*ends, strict=True)
        better = [end for place, column in enumerate(columns) for end in self._better(place, column)]
        return [self._landscape.needed(end) for end in better]

    def _better(self, place: int, ends: Sequence[StartResult]) -> list[StartResult]:
        """The best of some ends of a design that is better than what is known of it and counts, if any."""
        for end in sorted(ends, key=cost_of):
            if not cost_of(end) < self._best[place]:
                break
            found = self._landscape.finished(self._designs[place], end)
            if cost_of(found) < self._best[place]:
                self._best[place] = cost_of(found)
                return [found]
        return []

    def portfolio(self, most: int, served: float) -> StartPortfolio:
        """The offers that are chosen; how well they do is told of a choice made with half of the designs."""
        held = np.isfinite(self._best)
        shape = len(self._offers), len(self._designs)
        costs = np.array([[cost_of(end) for end in row] for row in self._ends]).reshape(shape).T[held]
        iterations = np.array([[float(end.iterations) for end in row] for row in self._ends]).reshape(shape)
        best, work = self._best[held], iterations.sum(axis=1)
        work *= [self._landscape.size(start) for start in self._offers]
        good = np.isfinite(costs) & self._landscape.good(costs, best[:, None])
        half = len(good) // 2
        few = _cover(good[:half], work, most, served)
        kept = good[half:][:, few].any(axis=1)
        short = costs[half:][:, few].min(axis=1, initial=np.inf) - best[half:]
        worst = float(np.max(short[np.isfinite(short)], initial=0.0))
        every = _cover(good, work, most, served)
        coverage = Coverage(len(kept), int(kept.sum()), worst)
        return StartPortfolio(tuple(self._offers[place] for place in every), coverage)


def _cover(good: NDArray[np.bool_], work: Costs, most: int, served: float) -> list[int]:
    """Starts that together serve the designs that any serves, with little work: those that serve most first.

    Args:
        good: whether a start (column) serves a design (row).
        work: of each start.
        most: starts at most.
        served: share of these designs that are to be served.
    """
    found: list[int] = []
    wanted = served * good.any(axis=1).sum()
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
