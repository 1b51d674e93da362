"""Surrogate search by ask and tell, by generations and without.

It begins with start genomes and quasi-random points, as many as one and a half times the dimension at
least, and goes on with them while nothing can be learnt. By generations, a population is proposed at once;
small ones learn sooner.

Without generations, eight genomes are proposed whenever eight outcomes more are known. Turns go round them,
and each is moved by about 1e-4, so that no two are the same. What was proposed and is not told yet is on its
way. So a proposal follows from the outcomes told before it, whatever was asked.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence

import numpy as np

from evodesign.records import Genome, SearchSettings
from evodesign.searches.base import Outcome
from evodesign.searches.discrete import snapped
from evodesign.searches.quasi_random import Beginning, SobolStream, first_generation, generator_of
from evodesign.searches.ranking import check_outcomes
from evodesign.searches.surrogate.approximation import FEWEST_FIRST, FIRST_PER_DIMENSION
from evodesign.searches.surrogate.knowledge import Knowledge
from evodesign.searches.surrogate.proposal import proposals
from evodesign.searches.surrogate.threads import one_thread

BATCH = 8
"""Genomes proposed at once where there are no generations."""

REMEMBERED = 8
"""Batches whose genomes may be on their way."""

MOVED = 1e-4
NEAR = 1e-2
"""Distance within which a genome was told that was proposed."""


def _first(settings: SearchSettings) -> int:
    return max(FEWEST_FIRST, int(FIRST_PER_DIMENSION * settings.dimension))


class Surrogate:
    """Surrogate search in the unit cube, for one objective or more.

    Args:
        settings: dimension, objectives, population, seed and start genomes.
    """

    def __init__(self, settings: SearchSettings) -> None:
        (seed,) = np.random.SeedSequence(settings.seed).spawn(1)
        self._settings = settings
        self._stream = SobolStream(settings.counts, seed)
        self._knowledge = Knowledge(settings)
        self._asked = first_generation(settings, self._stream)

    def ask(self) -> tuple[Genome, ...]:
        """The next generation; the same one until its outcomes are told."""
        return self._asked

    def tell(self, outcomes: Sequence[Outcome]) -> None:
        """Learn from the outcomes.

        Raises:
            ValueError: outcomes that do not fit the genomes asked.
        """
        check_outcomes(self._asked, outcomes, self._settings.objectives)
        with one_thread():
            self._learn(outcomes)

    def _learn(self, outcomes: Sequence[Outcome]) -> None:
        for genome, outcome in zip(self._asked, outcomes, strict=True):
            self._knowledge.add(genome, outcome)
        proposed: tuple[Genome, ...] = ()
        if len(self._knowledge) >= _first(self._settings):
            generator = generator_of(self._settings.seed, len(self._knowledge))
            proposed = proposals(self._knowledge, self._settings, self._settings.population, generator)
        self._asked = proposed + self._stream.take(self._settings.population - len(proposed))


class AsynchronousSurrogate:
    """The same, one genome at a time.

    Args:
        settings: dimension, objectives, population, seed and start genomes.
    """

    def __init__(self, settings: SearchSettings) -> None:
        (seed,) = np.random.SeedSequence(settings.seed).spawn(1)
        self._settings = settings
        self._beginning = Beginning(settings, seed)
        self._knowledge = Knowledge(settings)
        self._asked: dict[int, Genome] = {}
        self._batch: tuple[Genome, ...] = ()
        self._proposed: deque[tuple[Genome, ...]] = deque(maxlen=REMEMBERED)

    def ask(self, turn: int) -> Genome:
        """A genome of the latest batch; at first a start genome or a quasi-random point."""
        early = turn < self._settings.population or not self._batch
        genome = self._beginning.genome(turn) if early else self._moved(turn)
        self._asked[turn] = genome
        return genome

    def _moved(self, turn: int) -> Genome:
        point = np.array(self._batch[turn % len(self._batch)])
        step = MOVED * generator_of(self._settings.seed, turn).standard_normal(len(point))
        inside = np.clip(point + np.where(np.array(self._settings.counts) > 0, 0.0, step), 0.0, 1.0)
        return tuple(snapped(inside[None], self._settings.counts)[0].tolist())

    def tell(self, turn: int, outcome: Outcome) -> None:
        """Learn, and propose anew when enough have come."""
        with one_thread():
            self._learn(turn, outcome)

    def _learn(self, turn: int, outcome: Outcome) -> None:
        self._knowledge.add(self._asked.pop(turn), outcome)
        known = len(self._knowledge)
        if known < _first(self._settings) or known % BATCH:
            return
        generator = generator_of(self._settings.seed, 2**32 + known)  # no turn's
        self._batch = proposals(self._knowledge, self._settings, BATCH, generator, self._on_their_way())
        if self._batch:
            self._proposed.append(self._batch)

    def _on_their_way(self) -> tuple[Genome, ...]:
        """Genomes proposed of late of which none near was told."""
        told = self._knowledge.points
        genomes = [genome for batch in self._proposed for genome in batch]
        return tuple(
            genome for genome in genomes if ((told - np.array(genome)) ** 2).sum(axis=1).min() > NEAR**2
        )
