"""Instances of CMA-ES that share a front between them, told ranks only (pycma).

For one objective there is one instance, which ranks its samples by the objective. For several, every
instance looks for one point of the front. It ranks its samples by the uncrowded hypervolume improvement over
the incumbents of all others, so that a sample is good where it adds to what the others hold already, and
needs no weights. An instance's incumbent is the best outcome that it has been told. Objectives are scaled to
the range of all feasible outcomes told so far, and the reference point lies a tenth of the range beyond the
worst. Improvements are compared within one instance and batch only, as ranks, feasible first, so no cost is
ever made up for an infeasible design.

There are as many instances as leave each pycma's default population, but two at least, since one alone finds
one point. They begin at those outcomes that together dominate most, chosen one after another. One that pycma
declares finished (converged, ill-conditioned, flat) leaves its incumbent behind for the others to reckon with
and starts again from the next quasi-random point.

pycma draws from generators of ours (`randn`). With `seed` NaN it does not seed NumPy's global state; mirrored
samples, which would read that state, are off; nothing else on the paths taken uses it.

Source: Hansen, The CMA evolution strategy: a tutorial, 2016; Toure, Hansen, Auger and Brockhoff, Uncrowded
hypervolume improvement: COMO-CMA-ES and the Sofomore framework, 2019. There an incumbent is the outcome of an
instance's mean, evaluated for the purpose, and instances sample one after another.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import cma
import numpy as np
from cma.recombination_weights import RecombinationWeights

from evodesign.errors import InputError
from evodesign.records import Genome, SearchSettings
from evodesign.searches.base import Outcome
from evodesign.searches.discrete import Array, least_deviations
from evodesign.searches.hypervolume_improvement import HypervolumeImprovement
from evodesign.searches.quasi_random import SobolStream
from evodesign.searches.ranking import ranks, usable

MARGIN = 0.1
"""Share of the range by which the reference point is worse than the worst outcome, so that the ends count."""

FEWEST_INSTANCES = 2
"""With several objectives, as far as the population allows."""

SMALLEST_POPULATION = 3
"""Fewest samples from which pycma can adapt."""

STEP = 0.15
"""First standard deviation per coordinate of the unit cube: half that of uniform points."""

Cost = Callable[[tuple[float, ...]], float]
Draw = Callable[..., Array]
"""Gives standard normal numbers of a shape."""


class Instances:
    """The instances of one search.

    Args:
        settings: dimension, objectives and population.
        draws: of each instance, its own normal numbers.
        stream: where instances start again.
    """

    def __init__(self, settings: SearchSettings, draws: Sequence[Draw], stream: SobolStream) -> None:
        self._settings = settings
        self._stream = stream
        self._draws = tuple(draws)
        self._extent: Array = np.empty((0, settings.objectives))
        self._incumbents: list[tuple[float, ...] | None] = [None] * len(draws)
        self._left_behind: list[tuple[float, ...]] = []
        self.strategies: list[cma.CMAEvolutionStrategy] = []

    def size(self, index: int) -> int:
        """Samples of a batch of one instance; together they are the population."""
        share, rest = divmod(self._settings.population, len(self._draws))
        return share + (index < rest)

    def measure(self, outcomes: Sequence[Outcome]) -> None:
        """Widen the range, best and worst value by objective, of the feasible outcomes."""
        feasible = [values for outcome in outcomes if (values := usable(outcome)) is not None]
        if feasible:
            known = np.vstack([self._extent, feasible])
            self._extent = np.array([known.min(axis=0), known.max(axis=0)])

    def start(self, genomes: Sequence[Genome], outcomes: Sequence[Outcome]) -> None:
        """Begin every instance at the outcome that adds most to those chosen before."""
        waiting = list(range(len(outcomes)))
        for index in range(len(self._draws)):
            order = ranks([outcomes[place] for place in waiting], self._cost(index))
            chosen = waiting.pop(order.index(0))
            self._incumbents[index] = usable(outcomes[chosen])
            self.strategies.append(self._strategy(index, genomes[chosen]))

    def learn(self, index: int, samples: Sequence[Array], outcomes: Sequence[Outcome]) -> bool:
        """Let an instance learn the ranks of its own samples; gives whether it then started again."""
        strategy, cost = self.strategies[index], self._cost(index)
        strategy.tell(samples, ranks(outcomes, cost))
        held = self._incumbents[index]
        found = [values for values in (held, *map(usable, outcomes)) if values is not None]
        self._incumbents[index] = min(found, key=cost, default=None)
        finished = bool(strategy.stop())
        if finished:
            self._restart(index)
        return finished

    def _restart(self, index: int) -> None:
        held = self._incumbents[index]
        if held is not None:
            self._left_behind.append(held)
        self._incumbents[index] = None
        (mean,) = self._stream.take(1)
        self.strategies[index] = self._strategy(index, mean)

    def _strategy(self, index: int, mean: Genome) -> cma.CMAEvolutionStrategy:
        return _strategy(np.array(mean), self.size(index), self._draws[index], self._settings.counts)

    def _cost(self, index: int) -> Cost:
        """What one instance minimises, given what all others hold."""
        if self._settings.objectives == 1:
            return lambda objectives: objectives[0]
        held = [*self._incumbents[:index], *self._incumbents[index + 1 :], *self._left_behind]
        others = np.array([values for values in held if values is not None])
        return improvement_cost(others.reshape(-1, self._settings.objectives), self._extent)


def default_population(dimension: int) -> int:
    """The population that suits CMA-ES: 4 + 3 ln n (Hansen 2016, Eq. 48)."""
    return int(4.0 + 3.0 * math.log(dimension))


def improvement_cost(others: Array, extent: Array) -> Cost:
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
    gain = HypervolumeImprovement((others - best) / scale, np.full(len(best), 1.0 + MARGIN))
    return lambda objectives: -gain((np.array(objectives) - best) / scale)


def check_settings(settings: SearchSettings) -> None:
    """Refuse a population too small to adapt from, and a choice that is all there is to find.

    Raises:
        InputError: it is one of them.
    """
    if settings.discrete and settings.dimension == 1:  # pycma bounds no deviation in one dimension
        wanted = "another one than 'cma-es' where one discrete coordinate is all there is"
        raise InputError("search", "algorithm", wanted, "'cma-es'")
    if settings.population < SMALLEST_POPULATION:
        wanted = f"at least {SMALLEST_POPULATION} for cma-es"
        raise InputError("search", "population", wanted, str(settings.population))


def instance_count(settings: SearchSettings) -> int:
    """One for one objective; for several as many as leave each the default population, or at least two."""
    if settings.objectives == 1:
        return 1
    fewest = min(FEWEST_INSTANCES, settings.population // SMALLEST_POPULATION)
    return max(fewest, settings.population // default_population(settings.dimension))


def _strategy(mean: Array, size: int, draw: Draw, counts: Sequence[int]) -> cma.CMAEvolutionStrategy:
    """A pycma instance without output, files and clocks, told ranks.

    The criteria on function values are off, since the best rank is always the same. It samples and learns as
    if all coordinates were continuous; those that are discrete it samples widely enough to leave a choice.
    """
    options = {
        **({"minstd": least_deviations(counts, RecombinationWeights(size).mueff)} if any(counts) else {}),
        "bounds": [0.0, 1.0],
        "popsize": size,
        "randn": draw,
        "seed": math.nan,
        "CMA_mirrors": 0,
        "tolfun": 0.0,
        "tolfunhist": 0.0,
        "tolstagnation": 0,
        "signals_filename": "",
        "verbose": -9,
    }
    return cma.CMAEvolutionStrategy(mean, STEP, options)
