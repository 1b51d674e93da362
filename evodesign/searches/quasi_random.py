"""Quasi-random sampling: the honest baseline, and the first generation of every search.

Points are those of a Sobol sequence, scrambled by the seed: they fill the cube more evenly than random
ones. SciPy, which pymoo requires, computes them. The choices of a discrete coordinate get equally many.

Source: Sobol 1967; Owen, Scrambling Sobol and Niederreiter-Xing points, 1998 (as in `scipy.stats.qmc`).
"""

from __future__ import annotations

import functools
from collections.abc import Sequence

import numpy as np
from scipy.stats import qmc

from evodesign.records import Genome, SearchSettings
from evodesign.searches.base import Outcome
from evodesign.searches.discrete import snapped
from evodesign.searches.ranking import check_outcomes

BLOCK = 64
"""Points computed at a time; a power of two, as the sequence's balance asks for."""

KEPT_BLOCKS = 64
"""Blocks that are at hand without computing them again."""


class SobolPoints:
    """The points of a scrambled Sobol sequence by number.

    Args:
        counts: of choices by coordinate, 0 for a continuous one.
        seed: everything that determines the scrambling.
    """

    def __init__(self, counts: Sequence[int], seed: np.random.SeedSequence) -> None:
        self._block = functools.lru_cache(maxsize=KEPT_BLOCKS)(functools.partial(_block, counts, seed))

    def point(self, number: int) -> Genome:
        """A point; numbers that are near each other cost little."""
        block, place = divmod(number, BLOCK)
        return self._block(block)[place]


def _block(counts: Sequence[int], seed: np.random.SeedSequence, number: int) -> tuple[Genome, ...]:
    fresh = np.random.SeedSequence(seed.entropy, spawn_key=seed.spawn_key)  # SciPy counts its uses of a seed
    engine = qmc.Sobol(len(counts), scramble=True, rng=np.random.default_rng(fresh))
    if number > 0:  # SciPy cannot go forward by nothing
        engine.fast_forward(number * BLOCK)
    return tuple(tuple(row) for row in snapped(engine.random(BLOCK), counts).tolist())


class SobolStream:
    """The same points one after another, without an end; arguments as for `SobolPoints`."""

    def __init__(self, counts: Sequence[int], seed: np.random.SeedSequence) -> None:
        self._points = SobolPoints(counts, seed)
        self._taken = 0

    def take(self, count: int) -> tuple[Genome, ...]:
        """The next points of the sequence."""
        first, self._taken = self._taken, self._taken + count
        return tuple(self._points.point(number) for number in range(first, self._taken))


def first_generation(settings: SearchSettings, stream: SobolStream) -> tuple[Genome, ...]:
    """The start genomes, each once and at most a population of them, filled up from the stream."""
    start = tuple(dict.fromkeys(settings.start))[: settings.population]
    return start + stream.take(settings.population - len(start))


class Beginning:
    """The genomes with which a search begins: the start genomes, each once, then quasi-random points.

    Args:
        settings: start genomes, of which no more than the population count.
        seed: of the quasi-random sequence.
    """

    def __init__(self, settings: SearchSettings, seed: np.random.SeedSequence) -> None:
        self._start = tuple(dict.fromkeys(settings.start))[: settings.population]
        self._points = SobolPoints(settings.counts, seed)

    def genome(self, turn: int) -> Genome:
        """The genome of a turn."""
        count = len(self._start)
        return self._start[turn] if turn < count else self._points.point(turn - count)


def generator_of(seed: int, turn: int) -> np.random.Generator:
    """Random numbers of a turn's own."""
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(turn,)))


class QuasiRandom:
    """Asks for the points of a Sobol sequence, whatever it is told.

    Args:
        settings: dimension, population, seed and start genomes.
    """

    def __init__(self, settings: SearchSettings) -> None:
        (seed,) = np.random.SeedSequence(settings.seed).spawn(1)
        self._settings = settings
        self._stream = SobolStream(settings.counts, seed)
        self._asked = first_generation(settings, self._stream)

    def ask(self) -> tuple[Genome, ...]:
        """The next points; the same ones until their outcomes are told."""
        return self._asked

    def tell(self, outcomes: Sequence[Outcome]) -> None:
        """Take note that the points were evaluated.

        Raises:
            ValueError: outcomes that do not fit the genomes asked.
        """
        check_outcomes(self._asked, outcomes, self._settings.objectives)
        self._asked = self._stream.take(self._settings.population)


class AsynchronousRandom:
    """The same, one point at a time: it learns nothing, so asynchronous it is the same.

    Args:
        settings: dimension, population, seed and start genomes.
    """

    def __init__(self, settings: SearchSettings) -> None:
        (seed,) = np.random.SeedSequence(settings.seed).spawn(1)
        self._beginning = Beginning(settings, seed)

    def ask(self, turn: int) -> Genome:
        """The point of a turn."""
        return self._beginning.genome(turn)

    def tell(self, turn: int, outcome: Outcome) -> None:
        """Nothing is learnt."""
