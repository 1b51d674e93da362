"""CMA-ES by ask and tell, one generation at a time.

All instances ask together, so that one generation has exactly the settings' population. Generation 0 holds
the start genomes and quasi-random points. What the instances are stands in `cma_instances`.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np

from evodesign.records import Genome, SearchSettings
from evodesign.search.base import Outcome
from evodesign.search.cma_instances import Array, Instances, check_settings, instance_count
from evodesign.search.discrete import snapped
from evodesign.search.quasi_random import SobolStream, first_generation
from evodesign.search.ranking import check_outcomes

__all__ = ["CmaEs"]


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
