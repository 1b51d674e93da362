"""A portfolio that holds the optima of many designs, of which each design is solved from a few.

Where a landscape has dozens of optima, as that of bodies that keep clear of each other, no few starts serve
all designs, and from most of them a solve takes long or leads nowhere. The optima of similar designs serve
better, in fewer iterations. How alike two designs are is told by a linear fit of the optima's joints over
designs: by how far apart it puts them.

Each of some quasi-random designs is solved from random starts, or from the optima of those before that are
most like it, and from those of similar landscapes; then, round after round, from the optima of its
neighbours, until hardly any gets better. How many neighbours a design is solved from, and how well that does,
is told by leaving each design out. The same landscape always gets the same portfolio.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from evodesign.nlp.landscape import Design, Landscape, cost_of
from evodesign.nlp.program import Start
from evodesign.nlp.solver import RawSolution
from evodesign.nlp.start_portfolio import Coverage, Neighbourhood, StartPortfolio

__all__ = ["Gathering", "start_library"]

RIDGE = 10.0
"""Weight of the fit's coefficients, per standard deviation of a parameter, beside squares of joints."""

BETTER = 1e-6
"""Share of its cost by which an optimum must be better to take another one's place."""

DIGITS = 7
"""Significant ones of the numbers of a start."""


@dataclass(frozen=True, slots=True)
class Gathering:
    """How much work goes into a library.

    Args:
        designs: whose optima are kept.
        begun: how many of them begin at random starts; the others at the optima of those before.
        random: starts of each of these; the others have one.
        neighbours: that a design is solved from in each round.
        rounds: at most.
        enough: share of the designs; where fewer get better in a round, it was the last.
        tried: most neighbours that other designs are solved from.
        spared: share of the designs left out that need not be served, for fewer neighbours to do.
    """

    designs: int = 64
    begun: int = 16
    random: int = 8
    neighbours: int = 5
    rounds: int = 5
    enough: float = 0.02
    tried: int = 8
    spared: float = 0.03


def start_library(
    landscape: Landscape,
    designs: Iterable[Design],
    gathering: Gathering,
    similar: Sequence[StartPortfolio] = (),
) -> StartPortfolio:
    """The library of a landscape.

    Args:
        landscape: whose optima are sought.
        designs: to be solved; the library makes do with those that there are.
        gathering: how much work to do.
        similar: portfolios of similar landscapes, whose starts nearest to a design it is solved from.
    """
    work = _Library(landscape, [*islice(designs, gathering.designs)])
    rng = np.random.default_rng(0)
    for place, design in enumerate(work.designs):
        starts = [start for other in similar for start in other.near(design)[:1]]
        if place < gathering.begun:
            starts += [*landscape.starts, *(landscape.random_start(rng) for _ in range(gathering.random))]
        else:
            starts += [*work.beside(place, gathering.neighbours), landscape.random_start(rng)]
        work.solve(place, starts)
    for _ in range(gathering.rounds):
        before = work.costs
        for place in range(len(work.designs)):
            work.solve(place, work.beside(place, gathering.neighbours))
        if np.mean(~landscape.good(before, work.costs)) <= gathering.enough:
            break
    return work.portfolio(gathering)


class _Library:
    """The best optimum of each design so far."""

    def __init__(self, landscape: Landscape, designs: Sequence[Design]) -> None:
        self.designs, self._landscape = designs, landscape
        self._optima: dict[int, RawSolution] = {}
        self._joints = [each.name for each in landscape.solver.program.variables if each.drawn]

    @property
    def costs(self) -> NDArray[np.float64]:
        """Of each design; infinite where none is known."""
        return np.array([self._cost(place) for place in range(len(self.designs))])

    def _cost(self, place: int) -> float:
        return cost_of(self._optima[place]) if place in self._optima else np.inf

    def solve(self, place: int, starts: Sequence[Start]) -> None:
        """Solve a design from some starts, and keep the best optimum."""
        for start in starts:
            end = self._landscape.rough(self.designs[place], start)
            if cost_of(end) < self._cost(place) * (1.0 - np.sign(self._cost(place)) * BETTER):
                end = self._landscape.finished(self.designs[place], end)
                if cost_of(end) < self._cost(place):
                    self._optima[place] = end

    def beside(self, place: int, count: int) -> list[Start]:
        """Optima of the designs most like one."""
        places = [other for other in sorted(self._optima) if other != place]
        if not places:
            return []
        own, others = np.array(self.designs[place]), np.array([self.designs[other] for other in places])
        apart = (others - own) @ self._metric()
        order = np.argsort(np.square(apart).sum(axis=1), kind="stable")[:count]
        return [self._start(places[number]) for number in order.tolist()]

    def _start(self, place: int) -> Start:
        return self._landscape.solver.needed(self._optima[place])

    def _metric(self) -> NDArray[np.float64]:
        """One row per design parameter: what it does to joints."""
        places = sorted(self._optima)
        designs = np.array([self.designs[place] for place in places])
        values = [self._optima[place].values for place in places]
        joints = np.array([np.concatenate([each[name] for name in self._joints]) for each in values])
        spread = designs.std(axis=0)
        spread[spread == 0.0] = np.inf
        scaled = (designs - designs.mean(axis=0)) / spread
        fit = np.linalg.solve(
            scaled.T @ scaled + RIDGE * np.eye(len(spread)), scaled.T @ (joints - joints.mean(axis=0))
        )
        turned, sizes, _ = np.linalg.svd(fit, full_matrices=False)
        return np.asarray(turned * sizes / spread[:, None])

    def portfolio(self, gathering: Gathering) -> StartPortfolio:
        """All optima as starts, and how many neighbours do for a design that is left out."""
        if len(self._optima) < 2:
            starts = tuple(_rounded(self._start(place)) for place in self._optima)
            return StartPortfolio(starts, Coverage(0, 0, 0.0))
        ranks, short = np.array([self._rank(place, gathering.tried) for place in sorted(self._optima)]).T
        shares = [float(np.mean(ranks <= many)) for many in range(1, gathering.tried + 1)]
        enough = (many for many, share in enumerate(shares, 1) if share >= shares[-1] - gathering.spared)
        tried = min(next(enough), len(ranks) - 1)
        good = int(np.sum(ranks <= tried))
        metric, places = self._metric(), sorted(self._optima)
        return StartPortfolio(
            tuple(_rounded(self._start(place)) for place in places),
            Coverage(len(ranks), good, float(np.max(short[np.isfinite(short)], initial=0.0))),
            Neighbourhood(
                _tuples(metric), _tuples(np.array([self.designs[place] for place in places]) @ metric), tried
            ),
        )

    def _rank(self, place: int, most: int) -> tuple[float, float]:
        """How many neighbours lead close to a design's best optimum, and how far from it all of them end."""
        best, rough, least = self._cost(place), np.inf, np.inf
        for rank, start in enumerate(self.beside(place, most), 1):
            end = self._landscape.rough(self.designs[place], start)
            if cost_of(end) < rough:
                rough = end.cost
                least = min(least, cost_of(self._landscape.finished(self.designs[place], end)))
                if self._landscape.good(np.array(least), np.array(best)):
                    return rank, 0.0
        return np.inf, least - best


def _rounded(start: Start) -> Start:
    """A start with numbers that are quickly written, without rows that are off."""
    return {
        name: np.array([float(f"{number:.{DIGITS}g}") for number in values])
        for name, values in start.items()
        if np.any(values)
    }


def _tuples(rows: NDArray[np.float64]) -> tuple[tuple[float, ...], ...]:
    return tuple(tuple(float(f"{number:.{DIGITS}g}") for number in row) for row in rows.tolist())
