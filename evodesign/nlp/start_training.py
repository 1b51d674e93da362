"""A portfolio of starts: a few from which nearly every design converges to its best known optimum.

The optima of quasi-random training designs are the candidates. A start serves a design if the solver
converges from it to within 1 % of the best known optimum; the one that serves most comes first, and starts
are added until all training designs are served. Then the portfolio is examined on fresh designs; it is
trained with those that it fails, and examined again on others. The same landscape always gets the same
portfolio.

Source: greedy cover: Johnson 1974; Halton's points: scipy.stats.qmc.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from evodesign.nlp.landscape import Costs, Design, Landscape, Searched, cost_of
from evodesign.nlp.program import Start
from evodesign.nlp.start_portfolio import Coverage, StartPortfolio

__all__ = ["Training", "chosen", "start_portfolio"]

GOOD_ENOUGH = 0.99
"""Share of designs served with which a portfolio is good enough."""


@dataclass(frozen=True, slots=True)
class Training:
    """How much work goes into a portfolio.

    Args:
        designs: for training, and as many fresh ones in each round.
        starts: random ones per design, beside the fixed ones, to find its best optimum.
        crossed: optima of other designs that each design is tried from as well, to find its best one.
        candidates: tried for each start.
        portfolio: the most starts that a portfolio holds.
        rounds: of fresh designs, at most.
        share: of fresh designs served, with which a portfolio is good enough.
    """

    designs: int = 64
    starts: int = 10
    crossed: int = 0
    candidates: int = 8
    portfolio: int = 6
    rounds: int = 3
    share: float = GOOD_ENOUGH


def start_portfolio(landscape: Searched, designs: Iterator[Design], training: Training) -> StartPortfolio:
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
        made = [study for study in found if study is not None]
        offered = [made[place] for place in _spread(len(made), training.crossed)]
        return [_crossed(landscape, study, offered) for study in made]

    learned = studies(landscape.starts)
    chosen = _grown(landscape, (), learned, training)
    coverage = Coverage(0, 0, 0.0)
    for _ in range(training.rounds):
        fresh = studies(chosen)
        least = np.array([study.known for study in fresh])
        good = landscape.good(least, _best(fresh))
        short = (least - _best(fresh))[np.isfinite(least)]
        coverage = Coverage(len(fresh), int(good.sum()), float(np.max(short, initial=0.0)))
        if coverage.share >= training.share or len(chosen) == training.portfolio:
            break
        learned = [study for study, well in zip(fresh, good, strict=True) if not well]
        chosen = _grown(landscape, chosen, learned, training)
    return StartPortfolio(chosen, coverage)


def chosen(
    landscape: Landscape,
    offers: Sequence[Start],
    designs: Sequence[Design],
    most: int,
    enough: float = 1.0,
    *,
    roughly: bool = False,
) -> StartPortfolio:
    """Those of some starts that serve designs as well as all of them do, with little work.

    How well they do is told of a choice made with half of the designs, examined with the others.

    Args:
        landscape: in which they are to serve.
        offers: starts of this landscape and of similar ones.
        designs: to choose and examine with.
        most: starts that the portfolio may hold.
        enough: share of the designs that all of them serve, for the portfolio to serve.
        roughly: whether ends count as they are, as `Landscape.rough` has them, and solves are given up early,
            as evaluations do.
    """
    solve = landscape.briefly.rough if roughly else landscape.solve
    ends = [[solve(design, start) for start in offers] for design in designs]
    shape = len(designs), len(offers)
    costs = np.array([[cost_of(end) for end in row] for row in ends]).reshape(shape)
    iterations = np.array([[end.iterations for end in row] for row in ends]).reshape(shape)
    work = iterations.sum(axis=0) * [landscape.size(start) for start in offers]
    best = costs.min(axis=1, initial=np.inf)
    held = np.isfinite(best)
    costs, best = costs[held], best[held]
    good = np.isfinite(costs) & landscape.good(costs, best[:, None])
    half = len(good) // 2
    few = _cover(good[:half], work, most, enough)
    served = good[half:][:, few].any(axis=1)
    short = costs[half:][:, few].min(axis=1, initial=np.inf) - best[half:]
    coverage = Coverage(len(served), int(served.sum()), float(np.max(short[np.isfinite(short)], initial=0.0)))
    every = _cover(good, work, most, enough)
    return StartPortfolio(tuple(offers[place] for place in every), coverage)


def _cover(good: NDArray[np.bool_], work: Costs, most: int, enough: float) -> list[int]:
    """Starts that together serve the designs that any serves, with little work: those that serve most first.

    Args:
        good: whether a start (column) serves a design (row).
        work: of each start.
        most: starts at most.
        enough: share of these designs that are to be served.
    """
    found: list[int] = []
    wanted = enough * good.any(axis=1).sum()
    while len(found) < most and good[:, found].any(axis=1).sum() < wanted:
        served = good[~good[:, found].any(axis=1)].sum(axis=0)
        place = int(np.argmax(served / np.maximum(work, 1.0)))
        if not served[place]:
            break
        found.append(place)
    for place in sorted(found, key=lambda each: -work[each]):
        others = [each for each in found if each != place]
        if good[:, others].any(axis=1).sum() == good[:, found].any(axis=1).sum():
            found = others
    return sorted(found, key=lambda each: -int(good[:, each].sum()))


@dataclass(frozen=True, slots=True)
class _Study:
    """What is known of a design.

    Args:
        design: it.
        cost: of its best optimum.
        optimum: as starting values.
        start: that led to it.
        known: least cost that the known starts lead to; infinite if none converges.
    """

    design: Design
    cost: float
    optimum: Start
    start: Start
    known: float


def _study(
    landscape: Searched, design: Design, known: Sequence[Start], count: int, rng: np.random.Generator
) -> _Study | None:
    """The best of some known and some random starts; None where none converges."""
    starts = [*known, *(landscape.random_start(rng) for _ in range(count))]
    ends = [landscape.solve(design, start) for start in starts]
    costs = [cost_of(end) for end in ends]
    best = int(np.argmin(costs))
    if costs[best] == np.inf:
        return None
    return _Study(
        design, costs[best], ends[best].values, starts[best], min(costs[: len(known)], default=np.inf)
    )


def _crossed(landscape: Searched, study: _Study, others: Sequence[_Study]) -> _Study:
    """The study with a better optimum, if those of others lead to one, or parts of its own and of others."""
    for other in others:
        for start in _crossings(landscape, study.optimum, other.optimum):
            end = landscape.solve(study.design, start)
            if cost_of(end) < study.cost:
                study = replace(study, cost=end.cost, optimum=end.values, start=start)
    return study


def _crossings(landscape: Searched, own: Start, other: Start) -> Iterator[Start]:
    """Another optimum, and where it can be told apart one party of it beside the other one of an own."""
    yield other
    party = landscape.party if isinstance(landscape, Landscape) else ()
    if party and own is not other:
        for one, two in ((own, other), (other, own)):
            yield {**one, **{name: values for name, values in two.items() if name in party}}


def _best(studies: Sequence[_Study]) -> Costs:
    return np.array([study.cost for study in studies])


def _least_costs(landscape: Searched, chosen: Sequence[Start], studies: Sequence[_Study]) -> Costs:
    """The least cost of each design from some starts; infinite where none converges."""
    costs = np.full((len(studies), 1 + len(chosen)), np.inf)
    for row, study in enumerate(studies):
        for column, start in enumerate(chosen):
            costs[row, column] = cost_of(landscape.solve(study.design, start))
    least: Costs = costs.min(axis=1)
    return least


def _grown(
    landscape: Searched, chosen: tuple[Start, ...], studies: Sequence[_Study], training: Training
) -> tuple[Start, ...]:
    """The starts with others added until every study is served, or there are as many as there may be.

    A study offers its optimum, and then the start that led to it: a solver begun at an optimum may leave it
    for another. An offer that serves no study is not tried again.
    """
    best, least = _best(studies), np.full(len(studies), np.inf)
    offers = [[study.optimum, study.start] for study in studies]
    while len(chosen) < training.portfolio:
        open_ones = np.flatnonzero(~landscape.good(least, best)).tolist()
        offering = [index for index in open_ones if offers[index]]
        if not offering:
            break
        left = [studies[index] for index in open_ones]
        tried = [offering[place] for place in _spread(len(offering), training.candidates)]
        costs = np.array([_least_costs(landscape, [offers[index][0]], left) for index in tried])
        best[open_ones] = np.minimum(best[open_ones], costs.min(axis=0))
        served = landscape.good(costs, best[open_ones]).sum(axis=1)
        winner = int(np.argmax(served))
        if served[winner]:
            least[open_ones] = np.minimum(least[open_ones], costs[winner])
            chosen = (*chosen, offers[tried[winner]].pop(0))
        for index, many in zip(tried, served.tolist(), strict=True):
            if not many:
                offers[index].pop(0)
    return chosen


def _spread(count: int, wanted: int) -> list[int]:
    """At most `wanted` of the indices below `count`, evenly spread."""
    return sorted({round(place) for place in np.linspace(0, count - 1, min(count, wanted)).tolist()})
