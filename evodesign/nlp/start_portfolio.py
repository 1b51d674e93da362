"""A portfolio of starts: a few from which nearly every design converges to its best known optimum.

The optima of quasi-random training designs are the candidates. A start serves a design if it converges to
within 1 % of the best that is known of it; the one that serves most comes first, and starts are added until
all training designs are served. Then the portfolio is examined on fresh designs; it is trained with those
that it fails, and examined again on others. The same landscape always gets the same portfolio.

Source: greedy cover: Johnson 1974; Halton's points: scipy.stats.qmc.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from typing import Any

import numpy as np
from numpy.typing import NDArray

from evodesign.nlp.program import Start
from evodesign.nlp.solver import RawSolution, Solver
from evodesign.records import Status

__all__ = [
    "NEAR",
    "Coverage",
    "Landscape",
    "StartPortfolio",
    "Training",
    "random_start",
    "spread_designs",
    "start_portfolio",
]

NEAR = (0.01, 1e-4)
"""How far above the best optimum of a posture another one is still good: 1 %; near zero 0.1 N m."""

Costs = NDArray[np.float64]
Design = tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Training:
    """How much work goes into a portfolio.

    Args:
        designs: for training, and as many fresh ones in each round.
        starts: random ones per design, beside the fixed ones, to find its best optimum.
        candidates: tried for each start.
        portfolio: the most starts that a portfolio holds.
        rounds: of fresh designs, at most.
        share: of fresh designs served, with which a portfolio is good enough.
    """

    designs: int = 64
    starts: int = 10
    candidates: int = 8
    portfolio: int = 6
    rounds: int = 3
    share: float = 0.99


@dataclass(frozen=True, slots=True)
class Landscape:
    """A cost to be minimised, whatever the design.

    Args:
        solver: of a program with a parameter `design`.
        beside: its other parameters, by name.
        starts: fixed ones, for any design.
        relative, absolute: how far above the best optimum another one is still good, as a share of its cost
            and in the cost's unit.
    """

    solver: Solver
    beside: Mapping[str, Any]
    starts: tuple[Start, ...]
    relative: float
    absolute: float

    def solve(self, design: Design, start: Start) -> RawSolution:
        """Where a start leads."""
        return self.solver.solve({"design": design, **self.beside}, start)

    def good(self, costs: Costs, best: Costs) -> NDArray[np.bool_]:
        """Which costs are close enough to the best ones."""
        return costs <= best + self.relative * np.abs(best) + self.absolute


@dataclass(frozen=True, slots=True)
class Coverage:
    """How well a portfolio serves designs that it was not made from.

    Args:
        designs: how many were tried.
        good: how many of them converge close to their best known optimum.
        worst: largest distance from the best known optimum, in the cost's unit.
    """

    designs: int
    good: int
    worst: float

    @property
    def share(self) -> float:
        """Share of the designs that are served; 1 where none could be tried."""
        return self.good / self.designs if self.designs else 1.0


@dataclass(frozen=True, slots=True)
class StartPortfolio:
    """Starts, the one that serves most first, and how good they are; none where nothing could be trained."""

    starts: tuple[Start, ...]
    coverage: Coverage


def start_portfolio(landscape: Landscape, designs: Iterator[Design], training: Training) -> StartPortfolio:
    """The portfolio of a landscape.

    Args:
        landscape: whose optima are sought.
        designs: to train and examine with; the portfolio makes do with those that there are.
        training: how much work to do.
    """
    rng = np.random.default_rng(0)

    def studies(known: Sequence[Start]) -> list[_Study]:
        batch = islice(designs, training.designs)
        found = (_study(landscape, design, known, training.starts, rng) for design in batch)
        return [study for study in found if study is not None]

    learned = studies(landscape.starts)
    chosen = _grown(landscape, (), learned, training)
    coverage = Coverage(0, 0, 0.0)
    for _ in range(training.rounds):
        fresh = studies(chosen)
        least = _least_costs(landscape, chosen, fresh)
        good = landscape.good(least, _best(fresh))
        coverage = Coverage(len(fresh), int(good.sum()), float(np.max(least - _best(fresh), initial=0.0)))
        if coverage.share >= training.share or len(chosen) == training.portfolio:
            break
        learned = [study for study, well in zip(fresh, good, strict=True) if not well]
        chosen = _grown(landscape, chosen, learned, training)
    return StartPortfolio(chosen, coverage)


def random_start(landscape: Landscape, rng: np.random.Generator) -> Start:
    """One of the fixed starts, with all that is drawn anywhere between its bounds."""
    start = dict(landscape.starts[int(rng.integers(len(landscape.starts)))])
    for variable in landscape.solver.program.variables:
        if variable.drawn:
            start[variable.name] = rng.uniform(variable.lower, variable.upper)
    return start


def spread_designs(
    dimension: int, values: Callable[[tuple[float, ...]], Design], keep: Callable[[Design], bool], most: int
) -> Iterator[Design]:
    """Designs spread evenly over the unit cube: those that are to be kept among the first `most`.

    Args:
        dimension: of the cube.
        values: the design at a point of the cube.
        keep: which designs to give.
        most: how many to look at.
    """
    from scipy.stats import qmc  # takes half a second to load, which workers need not wait for

    points = qmc.Halton(dimension, scramble=True, rng=np.random.default_rng(0)).random(most)
    return (design for design in (values(tuple(point)) for point in points.tolist()) if keep(design))


@dataclass(frozen=True, slots=True)
class _Study:
    """A design with the best optimum that is known of it, as starting values."""

    design: Design
    cost: float
    optimum: Start


def _study(
    landscape: Landscape, design: Design, known: Sequence[Start], count: int, rng: np.random.Generator
) -> _Study | None:
    """The best of some known and some random starts; None where none converges."""
    starts = [*known, *(random_start(landscape, rng) for _ in range(count))]
    ends = [landscape.solve(design, start) for start in starts]
    solved = [end for end in ends if end.status is Status.SOLVED]
    if not solved:
        return None
    best = min(solved, key=lambda end: end.cost)
    return _Study(design, best.cost, best.values)


def _best(studies: Sequence[_Study]) -> Costs:
    return np.array([study.cost for study in studies])


def _least_costs(landscape: Landscape, chosen: Sequence[Start], studies: Sequence[_Study]) -> Costs:
    """The least cost to which some starts lead each design; infinite where they lead to none."""
    costs = np.full((len(studies), 1 + len(chosen)), np.inf)
    for row, study in enumerate(studies):
        for column, start in enumerate(chosen):
            end = landscape.solve(study.design, start)
            if end.status is Status.SOLVED:
                costs[row, column] = end.cost
    least: Costs = costs.min(axis=1)
    return least


def _grown(
    landscape: Landscape, chosen: tuple[Start, ...], studies: Sequence[_Study], training: Training
) -> tuple[Start, ...]:
    """The starts with others added until every study is served, or there are as many as there may be."""
    best, least = _best(studies), np.full(len(studies), np.inf)
    while len(chosen) < training.portfolio:
        open_ones = np.flatnonzero(~landscape.good(least, best)).tolist()
        if not open_ones:
            break
        left = [studies[index] for index in open_ones]
        tried = [left[index] for index in _spread(len(left), training.candidates)]
        costs = np.array([_least_costs(landscape, [study.optimum], left) for study in tried])
        best[open_ones] = np.minimum(best[open_ones], costs.min(axis=0))
        winner = int(np.argmax(landscape.good(costs, best[open_ones]).sum(axis=1)))
        least[open_ones] = np.minimum(least[open_ones], costs[winner])
        chosen = (*chosen, tried[winner].optimum)
    return chosen


def _spread(count: int, wanted: int) -> list[int]:
    """At most `wanted` of the indices below `count`, evenly spread."""
    return sorted({round(place) for place in np.linspace(0, count - 1, min(count, wanted)).tolist()})
