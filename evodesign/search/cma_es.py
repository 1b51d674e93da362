"""CMA-ES, one instance per weight vector, told ranks only (pycma).

Several objectives are scalarised by the augmented Chebyshev function of the objectives z, normalised so
that the front of all feasible outcomes told so far fills the unit cube:

    cost(f) = max_i w_i z_i + rho sum_i z_i        z_i = (f_i - ideal_i) / (nadir_i - ideal_i)

The weight vectors w are a simplex lattice, drawn towards its centre because the ends of a front are of
little use; there are as many as leave each instance pycma's default population. All instances ask together,
so that one generation has exactly the settings' population. Costs are compared within one instance and
generation only, as ranks, feasible first, so no cost is ever made up for an infeasible design.

Generation 0 holds the start genomes and quasi-random points. Each instance begins where CMA-ES would have
moved from it: at the weighted mean of the points that are best for its weights. An instance that pycma
declares finished (converged, ill-conditioned, flat) starts again from the next quasi-random point.

pycma draws from a generator of ours (`randn`), one per instance. With `seed` NaN it does not seed NumPy's
global state; mirrored samples, which would read that state, are off; nothing else on the paths taken uses it.

Source: Hansen, The CMA evolution strategy: a tutorial, 2016 (Eq. 6, 49 for the weighted mean); Steuer and
Choo, An interactive weighted Tchebycheff procedure, 1983; Das and Dennis 1998 for the lattice.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from itertools import combinations_with_replacement

import cma
import moocore
import numpy as np
from numpy.typing import NDArray

from evodesign.errors import InputError
from evodesign.records import Genome, SearchSettings
from evodesign.search.base import Outcome
from evodesign.search.quasi_random import SobolStream, first_generation
from evodesign.search.ranking import check_outcomes, ranks, usable

__all__ = ["CmaEs", "chebyshev", "default_population", "simplex_weights"]

AUGMENTATION = 0.05
"""rho: slope that keeps weakly dominated points from tying with the front."""

CENTRING = 0.3
"""Share by which weight vectors are drawn towards equal weights."""

SMALLEST_POPULATION = 3
"""Fewest samples from which pycma can adapt."""

STEP = 0.15
"""First standard deviation per coordinate of the unit cube: half that of uniform points."""

Array = NDArray[np.float64]


class CmaEs:
    """Scalarised CMA-ES by ask and tell, in the unit cube.

    Args:
        settings: dimension, objectives, population, seed and start genomes.
    Raises:
        InputError: a population too small to adapt from.
    """

    def __init__(self, settings: SearchSettings) -> None:
        if settings.population < SMALLEST_POPULATION:
            wanted = f"at least {SMALLEST_POPULATION} for cma-es"
            raise InputError("search", "population", wanted, str(settings.population))
        count = max(1, settings.population // default_population(settings.dimension))
        weights = simplex_weights(settings.objectives, count)
        stream_seed, *seeds = np.random.SeedSequence(settings.seed).spawn(1 + len(weights))
        self._settings = settings
        self._stream = SobolStream(settings.dimension, stream_seed)
        self._weights = weights
        self._generators = tuple(np.random.default_rng(seed) for seed in seeds)
        self._front: Array = np.empty((0, settings.objectives))
        self._strategies: tuple[cma.CMAEvolutionStrategy, ...] = ()
        self._samples: tuple[list[Array], ...] = ()
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
        self._remember(outcomes)
        if self._strategies:
            self._adapt(outcomes)
        else:
            self._start(outcomes)
        self._samples = tuple(strategy.ask() for strategy in self._strategies)
        together = np.clip(np.concatenate(self._samples), 0.0, 1.0)
        self._asked = tuple(tuple(row) for row in together.tolist())

    def _remember(self, outcomes: Sequence[Outcome]) -> None:
        feasible = [values for outcome in outcomes if (values := usable(outcome)) is not None]
        if feasible:
            self._front = moocore.filter_dominated(np.vstack([self._front, feasible]))

    def _start(self, outcomes: Sequence[Outcome]) -> None:
        points = np.array(self._asked)
        share, rest = divmod(len(points), len(self._weights))
        strategies = []
        for index, (weights, generator) in enumerate(zip(self._weights, self._generators, strict=True)):
            size = share + (index < rest)
            order = np.argsort(ranks(outcomes, chebyshev(weights, self._front)), kind="stable")
            strategies.append(_strategy(_weighted_mean(points[order[: size // 2]]), size, generator))
        self._strategies = tuple(strategies)

    def _adapt(self, outcomes: Sequence[Outcome]) -> None:
        told = 0
        strategies = []
        for index, (strategy, samples) in enumerate(zip(self._strategies, self._samples, strict=True)):
            own = outcomes[told : told + len(samples)]
            told += len(samples)
            strategy.tell(samples, ranks(own, chebyshev(self._weights[index], self._front)))
            if strategy.stop():
                (mean,) = self._stream.take(1)
                strategy = _strategy(np.array(mean), len(samples), self._generators[index])
            strategies.append(strategy)
        self._strategies = tuple(strategies)


def default_population(dimension: int) -> int:
    """The population that suits CMA-ES: 4 + 3 ln n (Hansen 2016, Eq. 48)."""
    return int(4.0 + 3.0 * math.log(dimension))


def simplex_weights(objectives: int, count: int) -> tuple[Array, ...]:
    """At most `count` weight vectors, each positive and of sum one, spread over the objectives.

    The finest lattice of weights i/h that has no more than `count` points, and the centre if it is not a
    point of the lattice and there is room; the centre alone when not even the corners fit.
    """
    centre = np.full(objectives, 1.0 / objectives)
    if objectives == 1 or count < objectives:
        return (centre,)
    divisions = 1
    while math.comb(divisions + objectives, objectives - 1) <= count:
        divisions += 1
    corners = np.eye(objectives)
    lattice = [
        np.mean([corners[index] for index in chosen], axis=0)
        for chosen in combinations_with_replacement(range(objectives), divisions)
    ]
    if divisions % objectives != 0 and len(lattice) < count:
        lattice.append(centre)
    return tuple((1.0 - CENTRING) * weights + CENTRING * centre for weights in lattice)


def chebyshev(weights: Array, front: Array) -> Callable[[tuple[float, ...]], float]:
    """The augmented Chebyshev cost of objectives, normalised by the ideal and nadir of a front.

    Args:
        weights: one per objective.
        front: non-dominated points [points x objectives]; an objective in which all agree keeps its unit,
            and without points nothing is normalised.
    """
    ideal, nadir = (front.min(axis=0), front.max(axis=0)) if len(front) else (0.0, 1.0)
    extent = np.where(np.greater(nadir, ideal), np.subtract(nadir, ideal), 1.0)

    def cost(objectives: tuple[float, ...]) -> float:
        normalised = (np.array(objectives) - ideal) / extent
        return float(np.max(weights * normalised) + AUGMENTATION * np.sum(normalised))

    return cost


def _weighted_mean(points: Array) -> Array:
    """Mean of points in order of merit, with the weights ln(mu + 1/2) - ln i of CMA-ES (Eq. 6, 49)."""
    weights = math.log(len(points) + 0.5) - np.log(np.arange(1, len(points) + 1))
    mean: Array = np.clip(weights @ points / weights.sum(), 0.0, 1.0)
    return mean


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
