"""CMA-ES, several instances that share a front between them, told ranks only (pycma).

For one objective there is one instance, which ranks its samples by the objective. For several, every
instance looks for one point of the front. It ranks its samples by the uncrowded hypervolume improvement over
the incumbents of all others, so that a sample is good where it adds to what the others hold already, and
needs no weights. An instance's incumbent is the best outcome that it has been told. Objectives are scaled to
the range of all feasible outcomes told so far, and the reference point lies a tenth of the range beyond the
worst. Improvements are compared within one instance and generation only, as ranks, feasible first, so no cost
is ever made up for an infeasible design.

All instances ask together, so that one generation has exactly the settings' population; there are as many as
leave each pycma's default population, but two at least, since one alone finds one point. Generation 0 holds
the start genomes and quasi-random points, and the instances begin at those that together conquer most,
chosen one after another. One that pycma declares finished (converged, ill-conditioned, flat) leaves its
incumbent behind for the others to reckon with and starts again from the next quasi-random point.

pycma draws from a generator of ours (`randn`), one per instance. With `seed` NaN it does not seed NumPy's
global state; mirrored samples, which would read that state, are off; nothing else on the paths taken uses it.

Source: Hansen, The CMA evolution strategy: a tutorial, 2016; Toure, Hansen, Auger and Brockhoff, Uncrowded
hypervolume improvement: COMO-CMA-ES and the Sofomore framework, 2019. There an incumbent is the outcome of an
instance's mean, evaluated for the purpose, and instances sample one after another.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import cma
import numpy as np
from numpy.typing import NDArray

from evodesign.errors import InputError
from evodesign.records import Genome, SearchSettings
from evodesign.search.base import Outcome
from evodesign.search.quasi_random import SobolStream, first_generation
from evodesign.search.ranking import check_outcomes, ranks, usable
from evodesign.search.uncrowded import UncrowdedGain

__all__ = ["CmaEs", "default_population", "uncrowded_cost"]

MARGIN = 0.1
"""Share of the range by which the reference point is worse than the worst outcome, so that the ends count."""

FEWEST_INSTANCES = 2
"""With several objectives, as far as the population allows."""

SMALLEST_POPULATION = 3
"""Fewest samples from which pycma can adapt."""

STEP = 0.15
"""First standard deviation per coordinate of the unit cube: half that of uniform points."""

Array = NDArray[np.float64]
Cost = Callable[[tuple[float, ...]], float]


class CmaEs:
    """CMA-ES by ask and tell, in the unit cube, for one objective or more.

    Args:
        settings: dimension, objectives, population, seed and start genomes.
    Raises:
        InputError: a population too small to adapt from.
    """

    def __init__(self, settings: SearchSettings) -> None:
        if settings.population < SMALLEST_POPULATION:
            wanted = f"at least {SMALLEST_POPULATION} for cma-es"
            raise InputError("search", "population", wanted, str(settings.population))
        count = _instances(settings)
        stream_seed, *seeds = np.random.SeedSequence(settings.seed).spawn(1 + count)
        self._settings = settings
        self._stream = SobolStream(settings.dimension, stream_seed)
        self._generators = tuple(np.random.default_rng(seed) for seed in seeds)
        self._extent: Array = np.empty((0, settings.objectives))
        self._incumbents: list[tuple[float, ...] | None] = [None] * count
        self._left_behind: list[tuple[float, ...]] = []
        self._strategies: list[cma.CMAEvolutionStrategy] = []
        self._samples: list[list[Array]] = []
        self._asked = first_generation(settings, self._stream)

    def ask(self) -> tuple[Genome, ...]:
        """The samples of all instances, one after another; the same ones until their outcomes are told."""
        return self._asked

    def tell(self, outcomes: Sequence[Outcome]) -> None:
        """Let every instance learn the ranks of its own samples.

        Raises:
            ValueError: outcomes that do not fit the genomes asked.
        """
        check_outcomes(self._asked, outcomes, self._settings.objectives)
        self._measure(outcomes)
        if self._strategies:
            self._adapt(outcomes)
        else:
            self._start(outcomes)
        self._samples = [strategy.ask() for strategy in self._strategies]
        together = np.clip(np.concatenate(self._samples), 0.0, 1.0)
        self._asked = tuple(tuple(row) for row in together.tolist())

    def _measure(self, outcomes: Sequence[Outcome]) -> None:
        """Widen the range, best and worst value by objective, of the feasible outcomes."""
        feasible = [values for outcome in outcomes if (values := usable(outcome)) is not None]
        if feasible:
            known = np.vstack([self._extent, feasible])
            self._extent = np.array([known.min(axis=0), known.max(axis=0)])

    def _start(self, outcomes: Sequence[Outcome]) -> None:
        """Begin every instance at the outcome that adds most to those chosen before."""
        waiting = list(range(len(outcomes)))
        share, rest = divmod(len(outcomes), len(self._generators))
        for index, generator in enumerate(self._generators):
            order = ranks([outcomes[place] for place in waiting], self._cost(index))
            chosen = waiting.pop(order.index(0))
            self._incumbents[index] = usable(outcomes[chosen])
            self._strategies.append(
                _strategy(np.array(self._asked[chosen]), share + (index < rest), generator)
            )

    def _adapt(self, outcomes: Sequence[Outcome]) -> None:
        told = 0
        for index, (strategy, samples) in enumerate(zip(self._strategies, self._samples, strict=True)):
            own = outcomes[told : told + len(samples)]
            told += len(samples)
            cost = self._cost(index)
            strategy.tell(samples, ranks(own, cost))
            held = self._incumbents[index]
            found = [values for values in (held, *map(usable, own)) if values is not None]
            self._incumbents[index] = min(found, key=cost, default=None)
            if strategy.stop():
                self._restart(index)

    def _restart(self, index: int) -> None:
        held = self._incumbents[index]
        if held is not None:
            self._left_behind.append(held)
        self._incumbents[index] = None
        (mean,) = self._stream.take(1)
        size = len(self._samples[index])
        self._strategies[index] = _strategy(np.array(mean), size, self._generators[index])

    def _cost(self, index: int) -> Cost:
        """What one instance minimises, given what all others hold."""
        if self._settings.objectives == 1:
            return lambda objectives: objectives[0]
        held = [*self._incumbents[:index], *self._incumbents[index + 1 :], *self._left_behind]
        others = np.array([values for values in held if values is not None])
        return uncrowded_cost(others.reshape(-1, self._settings.objectives), self._extent)


def default_population(dimension: int) -> int:
    """The population that suits CMA-ES: 4 + 3 ln n (Hansen 2016, Eq. 48)."""
    return int(4.0 + 3.0 * math.log(dimension))


def uncrowded_cost(others: Array, extent: Array) -> Cost:
    """Minus the uncrowded hypervolume improvement, in units of the extent.

    Args:
        others: what the other instances hold [points x objectives].
        extent: best and worst value of every objective [2 x objectives]; an objective in which both agree
            keeps its unit, and without any feasible outcome there is nothing to compare [0 x objectives].
    """
    if not len(extent):
        return lambda objectives: 0.0
    best, worst = extent
    scale = np.where(worst > best, worst - best, 1.0)
    gain = UncrowdedGain((others - best) / scale, np.full(len(best), 1.0 + MARGIN))
    return lambda objectives: -gain((np.array(objectives) - best) / scale)


def _instances(settings: SearchSettings) -> int:
    """One for one objective; for several as many as leave each the default population, or at least two."""
    if settings.objectives == 1:
        return 1
    fewest = min(FEWEST_INSTANCES, settings.population // SMALLEST_POPULATION)
    return max(fewest, settings.population // default_population(settings.dimension))


def _strategy(mean: Array, size: int, generator: np.random.Generator) -> cma.CMAEvolutionStrategy:
    """A pycma instance without output, files and clocks, told ranks.

    The criteria on function values are off, since the best rank is always the same.
    """
    options = {
        "bounds": [0.0, 1.0],
        "popsize": size,
        "randn": lambda *shape: generator.standard_normal(shape),
        "seed": math.nan,
        "CMA_mirrors": 0,
        "tolfun": 0.0,
        "tolfunhist": 0.0,
        "tolstagnation": 0,
        "signals_filename": "",
        "verbose": -9,
    }
    return cma.CMAEvolutionStrategy(mean, STEP, options)
