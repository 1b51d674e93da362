"""The best optima of many designs, of which a portfolio of starts is chosen.

Where a landscape has dozens of optima, as that of bodies that keep clear of each other, random starts hardly
ever lead to the best one; the optima of similar designs do. How alike two designs are is told by a linear fit
of the optima's joints over designs: by how far apart it puts them.

Some quasi-random designs are solved from random starts, and from starts that are known; each of the others
from the optima of those before that are most like it. Then, round after round, each is solved from the optima
of its neighbours, until hardly any gets better. The same landscape always gets the same optima.
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

__all__ = ["Gathering", "gathered"]

RIDGE = 10.0
"""Weight of the fit's coefficients, per standard deviation of a parameter, beside squares of joints."""

BETTER = 1e-6
"""Share of its cost by which an optimum must be better to take another one's place."""


@dataclass(frozen=True, slots=True)
class Gathering:
    """How much work is done.

    Args:
        designs: to be solved.
        begun: how many of them begin at all starts that are known, and at random ones.
        random: starts of each of these; the others have one.
        neighbours: that a design is solved from in each round.
        rounds: at most.
        enough: share of the designs; where fewer get better in a round, it was the last.
    """

    designs: int = 64
    begun: int = 16
    random: int = 8
    neighbours: int = 5
    rounds: int = 5
    enough: float = 0.02


def gathered(
    landscape: Landscape,
    designs: Iterable[Design],
    gathering: Gathering,
    own: Sequence[Start] = (),
    similar: Sequence[Start] = (),
) -> list[tuple[Design, Start]]:
    """Designs and their best known optima, as starts; none of those that cannot be solved.

    Args:
        landscape: whose optima are sought.
        designs: to be solved, if there are so many.
        gathering: how much work to do.
        own: starts that are known; each design is solved from them.
        similar: those of similar landscapes.
    """
    work = _Optima(landscape, [*islice(designs, gathering.designs)])
    rng = np.random.default_rng(0)
    for place in range(len(work.designs)):
        if place < gathering.begun:
            drawn = [landscape.random_start(rng) for _ in range(gathering.random)]
            starts = [*own, *similar, *landscape.starts, *drawn]
        else:
            starts = [*own, *work.beside(place, gathering.neighbours), landscape.random_start(rng)]
        work.solve(place, starts)
    for _ in range(gathering.rounds):
        before = work.costs
        for place in range(len(work.designs)):
            work.solve(place, work.beside(place, gathering.neighbours))
        if np.mean(~landscape.good(before, work.costs)) <= gathering.enough:
            break
    return work.found


class _Optima:
    """The best optimum of each design so far."""

    def __init__(self, landscape: Landscape, designs: Sequence[Design]) -> None:
        self.designs, self._landscape = designs, landscape
        self._optima: dict[int, RawSolution] = {}
        self._joints = [each.name for each in landscape.solver.program.variables if each.drawn]

    @property
    def found(self) -> list[tuple[Design, Start]]:
        """Designs and their optima."""
        return [(self.designs[place], self._start(place)) for place in sorted(self._optima)]

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
            if cost_of(end) < self._cost(place) - BETTER * abs(cost_of(end)):
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
        """What each design parameter does to joints: one row for each parameter."""
        places = sorted(self._optima)
        designs = np.array([self.designs[place] for place in places])
        values = [self._optima[place].values for place in places]
        joints = np.array([np.concatenate([each[name] for name in self._joints]) for each in values])
        spread = designs.std(axis=0)
        spread[spread == 0.0] = np.inf
        scaled = (designs - designs.mean(axis=0)) / spread
        squares = scaled.T @ scaled + RIDGE * np.eye(len(spread))
        fit = np.linalg.solve(squares, scaled.T @ (joints - joints.mean(axis=0)))
        return np.asarray(fit / spread[:, None])
