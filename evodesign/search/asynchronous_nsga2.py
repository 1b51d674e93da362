"""NSGA-II in steady state (pymoo): every genome has parents from the population as it is at that moment.

Newcomers join the population, then the fittest survive as in NSGA-II: one by one up to 31 designs, a few at a
time in larger populations, of which sorting costs more (a population divided by 32, and one). The
first genomes are the start genomes and quasi-random points, until half a population is known.

Source: Deb, Pratap, Agarwal and Meyarivan, A fast and elitist multiobjective genetic algorithm, 2002;
Durillo, Nebro, Luna and Alba, On the effect of the steady-state selection scheme in multi-objective genetic
algorithms, 2009.
"""

from __future__ import annotations

import numpy as np
from pymoo.core.individual import Individual
from pymoo.core.population import Population

from evodesign.records import Genome, SearchSettings
from evodesign.search.asynchronous import Beginning, generator_of
from evodesign.search.base import Outcome
from evodesign.search.discrete import snapped
from evodesign.search.nsga2 import nsga2_algorithm, with_outcomes
from evodesign.search.quasi_random import SobolPoints

__all__ = ["AsynchronousNsga2"]

JOINING = 32
"""The population divided by this, and one, is how many newcomers join at a time."""

TRIES = 100
"""How often a child that equals a member is replaced, before a random point is."""


class AsynchronousNsga2:
    """NSGA-II, one genome at a time, with simulated binary crossover and polynomial mutation.

    Args:
        settings: dimension, objectives, population, seed and start genomes.
    """

    def __init__(self, settings: SearchSettings) -> None:
        stream_seed, algorithm_seed = np.random.SeedSequence(settings.seed).spawn(2)
        self._settings = settings
        points = SobolPoints(settings.counts, stream_seed)
        self._beginning = Beginning(settings.start, settings.population, points)
        nobody = np.empty((0, settings.dimension))
        self._algorithm = nsga2_algorithm(settings, nobody, algorithm_seed, eliminate_duplicates=False)
        self._population = Population.new()
        self._members: frozenset[Genome] = frozenset()
        self._newcomers: list[Individual] = []
        self._asked: dict[int, Genome] = {}
        self._told = 0

    def ask(self, turn: int) -> Genome:
        """A child of two members of the population; at first a start genome or a quasi-random point."""
        early = turn < self._settings.population or self._told < self._settings.population // 2
        grown = len(self._population) >= 2
        genome = self._child(turn) if grown and not early else self._beginning.genome(turn)
        self._asked[turn] = genome
        return genome

    def tell(self, turn: int, outcome: Outcome) -> None:
        """Let a design join, and the fittest survive once enough have."""
        genome = self._asked.pop(turn)
        newcomer = Population.new(X=np.array([genome]))
        with_outcomes(newcomer, [outcome], self._settings.objectives)
        self._newcomers.append(newcomer[0])
        self._told += 1
        if len(self._newcomers) > self._settings.population // JOINING:
            self._survive()

    def _survive(self) -> None:
        together = Population.merge(self._population, Population.create(*self._newcomers))
        self._newcomers.clear()
        algorithm = self._algorithm
        algorithm.random_state = generator_of(self._settings.seed, self._told)
        self._population = algorithm.survival.do(
            algorithm.problem,
            together,
            n_survive=min(self._settings.population, len(together)),
            algorithm=algorithm,
            random_state=algorithm.random_state,
        )
        self._members = frozenset(tuple(row) for row in self._population.get("X").tolist())

    def _child(self, turn: int) -> Genome:
        algorithm = self._algorithm
        algorithm.random_state = generator_of(self._settings.seed, turn)
        for _ in range(TRIES):
            children = algorithm.mating.do(
                algorithm.problem,
                self._population,
                1,
                algorithm=algorithm,
                random_state=algorithm.random_state,
            )
            genome = tuple(children[0].X.tolist())
            if genome not in self._members:
                return genome
        anywhere = algorithm.random_state.random((1, self._settings.dimension))
        return tuple(snapped(anywhere, self._settings.counts)[0].tolist())
