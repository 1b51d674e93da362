"""CMA-ES by ask and tell, by generations and without; what the instances are stands in `cma_instances`.

By generations, all instances ask together, so that one generation has exactly the settings' population.
Generation 0 holds the start genomes and quasi-random points.

Without generations, an instance learns whenever a batch of its own samples has come back. Turns go round the
instances. A sample may come back when its instance has learnt from others meanwhile; it is then a sample of
an older distribution, which CMA-ES takes as it takes solutions injected from outside. One whose instance has
started again in between only widens the range of known outcomes. The instances begin when a population of
start genomes and quasi-random points is known.

Source: as `cma_instances`; Hansen, Injecting external solutions into CMA-ES, 2011.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import cma
import numpy as np

from evodesign.records import Genome, SearchSettings
from evodesign.searches.base import Outcome
from evodesign.searches.cma_instances import Instances, check_settings, instance_count
from evodesign.searches.discrete import Array, snapped
from evodesign.searches.quasi_random import Beginning, SobolStream, first_generation, generator_of
from evodesign.searches.ranking import check_outcomes


class CmaEs:
    """CMA-ES by ask and tell, in the unit cube, for one objective or more.

    Args:
        settings: dimension, objectives, population, seed and start genomes.
    Raises:
        InputError: a population too small to adapt from, or one discrete coordinate alone.
    """

    def __init__(self, settings: SearchSettings) -> None:
        check_settings(settings)
        stream_seed, *seeds = np.random.SeedSequence(settings.seed).spawn(1 + instance_count(settings))
        self._settings = settings
        stream = SobolStream(settings.counts, stream_seed)
        draws = [partial(_normal, np.random.default_rng(seed)) for seed in seeds]
        self._instances = Instances(settings, draws, stream)
        self._samples: list[list[Array]] = []
        self._asked = first_generation(settings, stream)

    def ask(self) -> tuple[Genome, ...]:
        """The samples of all instances, one after another; the same ones until their outcomes are told."""
        return self._asked

    def tell(self, outcomes: Sequence[Outcome]) -> None:
        """Let every instance learn the ranks of its own samples.

        Raises:
            ValueError: outcomes that do not fit the genomes asked.
        """
        check_outcomes(self._asked, outcomes, self._settings.objectives)
        self._instances.measure(outcomes)
        if self._samples:
            self._learn(outcomes)
        else:
            self._instances.start(self._asked, outcomes)
        self._samples = [strategy.ask() for strategy in self._instances.strategies]
        inside = np.clip(np.concatenate(self._samples), 0.0, 1.0)
        together = snapped(inside, self._settings.counts)
        self._asked = tuple(tuple(row) for row in together.tolist())

    def _learn(self, outcomes: Sequence[Outcome]) -> None:
        told = 0
        for index, samples in enumerate(self._samples):
            self._instances.learn(index, samples, outcomes[told : told + len(samples)])
            told += len(samples)


def _normal(generator: np.random.Generator, *shape: int) -> Array:
    return generator.standard_normal(shape)


@dataclass(frozen=True, slots=True)
class _Sample:
    """A point asked from an instance, as that was when asked."""

    instance: int
    strategy: cma.CMAEvolutionStrategy
    point: Array


class AsynchronousCmaEs:
    """CMA-ES, one genome at a time, in the unit cube, for one objective or more.

    Args:
        settings: dimension, objectives, population, seed and start genomes.
    Raises:
        InputError: a population too small to adapt from, or one discrete coordinate alone.
    """

    def __init__(self, settings: SearchSettings) -> None:
        check_settings(settings)
        begin_seed, restart_seed = np.random.SeedSequence(settings.seed).spawn(2)
        self._settings = settings
        self._beginning = Beginning(settings, begin_seed)
        self._generator = generator_of(settings.seed, 0)
        draws = [self._normal] * instance_count(settings)
        self._instances = Instances(settings, draws, SobolStream(settings.counts, restart_seed))
        self._first: dict[int, Genome] = {}
        self._known: list[tuple[Genome, Outcome]] = []
        self._asked: dict[int, _Sample] = {}
        self._waiting: list[list[tuple[Array, Outcome]]] = [[] for _ in draws]

    def ask(self, turn: int) -> Genome:
        """A sample of the instance whose turn it is; at first a start genome or a quasi-random point."""
        if not self._instances.strategies:
            self._first[turn] = self._beginning.genome(turn)
            return self._first[turn]
        instance = turn % self._settings.population % len(self._waiting)
        strategy = self._instances.strategies[instance]
        point = self._sample(strategy, turn)
        self._asked[turn] = _Sample(instance, strategy, point)
        inside = np.clip(point[np.newaxis], 0.0, 1.0)
        return tuple(snapped(inside, self._settings.counts)[0].tolist())

    def tell(self, turn: int, outcome: Outcome) -> None:
        """Keep an outcome until its instance has a batch to learn from."""
        self._instances.measure([outcome])
        genome = self._first.pop(turn, None)
        if genome is None:
            self._learn(turn, outcome)
        elif not self._instances.strategies:
            self._known.append((genome, outcome))
            if len(self._known) == self._settings.population:
                self._instances.start(*zip(*self._known, strict=True))
                self._known.clear()

    def _learn(self, turn: int, outcome: Outcome) -> None:
        sample = self._asked.pop(turn)
        index, batch = sample.instance, self._waiting[sample.instance]
        if sample.strategy is not self._instances.strategies[index]:
            return
        batch.append((sample.point, outcome))
        if len(batch) < self._instances.size(index):
            return
        self._sample(sample.strategy, turn)  # pycma learns once per sampling, and updates its matrices there
        self._instances.learn(index, *zip(*batch, strict=True))
        batch.clear()

    def _sample(self, strategy: cma.CMAEvolutionStrategy, turn: int) -> Array:
        """A point of an instance, with the random numbers of a turn."""
        self._generator = generator_of(self._settings.seed, turn)
        (point,) = strategy.ask(1)
        return np.asarray(point)

    def _normal(self, *shape: int) -> Array:
        return self._generator.standard_normal(shape)
