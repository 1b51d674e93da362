"""What an asynchronous search is: it is asked for one genome at a time, and told outcomes as they come.

Turns number the genomes in the order of asking. The genome of a turn follows from the settings, the turn and
the outcomes told before it was asked, and from nothing else: asking leaves no trace. So a genome that was
asked and never evaluated, because a session ended, needs no record, and a log that says which outcomes were
known at each turn rebuilds everything. It does not matter how many workers there were.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np

from evodesign.records import Genome
from evodesign.search.base import Outcome
from evodesign.search.quasi_random import SobolPoints

__all__ = ["AsynchronousSearch", "Beginning", "generator_of"]


class AsynchronousSearch(Protocol):
    """An asynchronous search, ready when constructed."""

    def ask(self, turn: int) -> Genome:
        """The genome of a turn, in the unit cube."""

    def tell(self, turn: int, outcome: Outcome) -> None:
        """The outcome of a turn's genome; every turn that was asked may be told, once, in any order."""


class Beginning:
    """The genomes with which a search begins: the start genomes, each once, then quasi-random points.

    Args:
        start: genomes of the settings.
        population: of the start genomes, no more count.
        points: the quasi-random sequence.
    """

    def __init__(self, start: tuple[Genome, ...], population: int, points: SobolPoints) -> None:
        self._start = tuple(dict.fromkeys(start))[:population]
        self._points = points

    def genome(self, turn: int) -> Genome:
        """The genome of a turn."""
        count = len(self._start)
        return self._start[turn] if turn < count else self._points.point(turn - count)


def generator_of(seed: int, turn: int) -> np.random.Generator:
    """Random numbers of a turn's own."""
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(turn,)))
