"""Quasi-random sampling, one point at a time: it learns nothing, so asynchronous it is the same."""

from __future__ import annotations

import numpy as np

from evodesign.records import Genome, SearchSettings
from evodesign.search.asynchronous import Beginning
from evodesign.search.base import Outcome
from evodesign.search.quasi_random import SobolPoints

__all__ = ["AsynchronousRandom"]


class AsynchronousRandom:
    """Asks for the start genomes and the points of a Sobol sequence, whatever it is told.

    Args:
        settings: dimension, population, seed and start genomes.
    """

    def __init__(self, settings: SearchSettings) -> None:
        (seed,) = np.random.SeedSequence(settings.seed).spawn(1)
        points = SobolPoints(settings.counts, seed)
        self._beginning = Beginning(settings.start, settings.population, points)

    def ask(self, turn: int) -> Genome:
        """The point of a turn."""
        return self._beginning.genome(turn)

    def tell(self, turn: int, outcome: Outcome) -> None:
        """Nothing is learnt."""
