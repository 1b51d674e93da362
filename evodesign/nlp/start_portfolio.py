"""Start portfolios: a few starts from which a solver finds nearly every design's best known optimum.

The optima of quasi-random training designs are the candidates. The value of a candidate is the number of
designs for which the solver converges from it to within a tolerance of the best known optimum. The candidate
of greatest value comes first, and others are added until every training design has a good start. Then the
portfolio is tested on fresh designs; those for which it fails join the training, and the next test takes
others. The same landscape always gets the same portfolio.

Source: docs/model.md, section 5 (start portfolios); greedy cover: Johnson 1974; Halton's points:
scipy.stats.qmc.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from evodesign.nlp.program import RawSolution, Solver, Start
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
        candidates: tried for each start that is added.
        seeds: the most starts that a portfolio holds.
        rounds: of fresh designs, at most.
        share: of fresh designs with a good start, from which a portfolio is good enough.
    """

    designs: int = 64
    starts: int = 10
    candidates: int = 8
    seeds: int = 6
    rounds: int = 3
    share: float = 0.99


@dataclass(frozen=True, slots=True)
class Landscape:
    """A cost to be minimised, whatever the design.

    Args:
        solver: of a program whose first parameters are the design's.
        beside: its other parameters.
        starts: fixed ones, for any design.
        relative, absolute: how far above the best optimum another one is still good, as a share of its cost
            and in the cost's unit.
    """

    solver: Solver
    beside: tuple[float, ...]
    starts: tuple[Start, ...]
    relative: float
    absolute: float

    def solve(self, design: Design, start: Start) -> RawSolution:
        """The optimum that the solver finds from a start."""
        return self.solver.solve([*design, *self.beside], start)

    def good(self, costs: Costs, best: Costs) -> NDArray[np.bool_]:
        """Which costs are close enough to the best ones."""
        return costs <= best + self.relative * np.abs(best) + self.absolute


@dataclass(frozen=True, slots=True)
class Coverage:
    """How good a portfolio is for designs that it was not computed from.

    Args:
        designs: how many were tried.
        good: for how many of them the solver converged close to the best known optimum.
        worst: largest distance from the best known optimum, in the cost's unit.
    """

    designs: int
    good: int
    worst: float

    @property
    def share(self) -> float:
        """Share of the designs with a good start; 1 where none could be tried."""
        return self.good / self.designs if self.designs else 1.0


@dataclass(frozen=True, slots=True)
class StartPortfolio:
    """Starts, the best one first, and how good they are; none where no training design has an optimum."""

    seeds: tuple[Start, ...]
    coverage: Coverage


def start_portfolio(landscape: Landscape, designs: Iterator[Design], training: Training) -> StartPortfolio:
    """The start portfolio of a landscape.

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
    seeds = _grown(landscape, (), learned, training)
    coverage = Coverage(0, 0, 0.0)
    for _ in range(training.rounds):
        fresh = studies(seeds)
        reached = _least_costs(landscape, seeds, fresh)
        good = landscape.good(reached, _best(fresh))
        coverage = Coverage(len(fresh), int(good.sum()), float(np.max(reached - _best(fresh), initial=0.0)))
        if coverage.share >= training.share or len(seeds) == training.seeds:
            break
        learned = [study for study, well in zip(fresh, good, strict=True) if not well]
        seeds = _grown(landscape, seeds, learned, training)
    return StartPortfolio(seeds, coverage)


def random_start(landscape: Landscape, rng: np.random.Generator) -> Start:
    """One of the fixed starts, with all joints anywhere in their ranges."""
    start = dict(landscape.starts[int(rng.integers(len(landscape.starts)))])
    for variable in landscape.solver.program.variables:
        if variable.name.endswith(".joints"):
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


def _least_costs(landscape: Landscape, seeds: Sequence[Start], studies: Sequence[_Study]) -> Costs:
    """The least cost of each design from some starts; infinite where none converges."""
    costs = np.full((len(studies), 1 + len(seeds)), np.inf)
    for row, study in enumerate(studies):
        for column, seed in enumerate(seeds):
            end = landscape.solve(study.design, seed)
            if end.status is Status.SOLVED:
                costs[row, column] = end.cost
    least: Costs = costs.min(axis=1)
    return least


def _grown(
    landscape: Landscape, seeds: tuple[Start, ...], studies: Sequence[_Study], training: Training
) -> tuple[Start, ...]:
    """The starts with others added until every study has a good one, or there are as many as there may be."""
    best, reached = _best(studies), np.full(len(studies), np.inf)
    while len(seeds) < training.seeds:
        open_ones = np.flatnonzero(~landscape.good(reached, best)).tolist()
        if not open_ones:
            break
        left = [studies[index] for index in open_ones]
        tried = [left[index] for index in _spread(len(left), training.candidates)]
        costs = np.array([_least_costs(landscape, [study.optimum], left) for study in tried])
        best[open_ones] = np.minimum(best[open_ones], costs.min(axis=0))
        winner = int(np.argmax(landscape.good(costs, best[open_ones]).sum(axis=1)))
        reached[open_ones] = np.minimum(reached[open_ones], costs[winner])
        seeds = (*seeds, tried[winner].optimum)
    return seeds


def _spread(count: int, wanted: int) -> list[int]:
    """At most `wanted` of the indices below `count`, evenly spread."""
    return sorted({round(place) for place in np.linspace(0, count - 1, min(count, wanted)).tolist()})
