"""NSGA-II: non-dominated sorting, crowding, simulated binary crossover and polynomial mutation (pymoo).

pymoo's operators draw from the algorithm's own random state (since 0.6.1.5). Every outcome enters with its
infeasibility as the one constraint. pymoo splits by feasibility before it sorts, orders infeasible designs
by that constraint alone and compares objectives of feasible designs only; the others carry NaN there, so
that no number stands for a value that does not exist.

In steady state every genome has parents from the population as it is at that moment. Newcomers join the
population, then the fittest survive: one by one up to 31 designs, a few at a time in larger populations, of
which sorting costs more (a population divided by 32, and one). The first genomes are the start genomes and
quasi-random points, until half a population is known.

Coordinates that are discrete are varied in their own way; where there are none, no random number is drawn:

    crossover   a child has either parent's choice: two children exchange theirs with a chance of one half
    mutation    another choice, each other one with the same chance; as often as a continuous one is changed

Source: Deb, Pratap, Agarwal and Meyarivan, A fast and elitist multiobjective genetic algorithm, 2002;
Durillo, Nebro, Luna and Alba, On the effect of the steady-state selection scheme in multi-objective genetic
algorithms, 2009; Deb and Goyal, A combined genetic adaptive search (GeneAS) for engineering design, 1996.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.config import Config
from pymoo.core.individual import Individual
from pymoo.core.population import Population
from pymoo.core.problem import Problem
from pymoo.core.termination import NoTermination
from pymoo.operators.crossover.sbx import SBX
from pymoo.operators.mutation.pm import PM

from evodesign.records import Genome, SearchSettings
from evodesign.searches.base import Outcome
from evodesign.searches.discrete import Array, snapped
from evodesign.searches.quasi_random import Beginning, SobolStream, first_generation, generator_of
from evodesign.searches.ranking import check_outcomes, with_outcomes

CROSSOVER_SHARE = 0.9
CROSSOVER_INDEX = 15
MUTATION_INDEX = 20
"""pymoo's defaults, given to operators of our own: its default operators are shared by every instance."""

EXCHANGE = 0.5
"""Chance that two children exchange a choice."""

JOINING = 32
"""The population divided by this, and one, is how many newcomers join at a time."""

TRIES = 100
"""How often a child that equals a member is replaced, before a random point is."""


class Nsga2:
    """NSGA-II by ask and tell, with simulated binary crossover and polynomial mutation.

    Args:
        settings: dimension, objectives, population, seed and start genomes.
    """

    def __init__(self, settings: SearchSettings) -> None:
        stream_seed, algorithm_seed = np.random.SeedSequence(settings.seed).spawn(2)
        self._settings = settings
        self._stream = SobolStream(settings.counts, stream_seed)
        start = first_generation(settings, self._stream)
        self._algorithm = nsga2_algorithm(settings, np.array(start, dtype=float), algorithm_seed)
        self._asked = self._next_generation()

    def ask(self) -> tuple[Genome, ...]:
        """The next offspring; the same ones until their outcomes are told."""
        return tuple(tuple(row) for row in self._asked.get("X").tolist())

    def tell(self, outcomes: Sequence[Outcome]) -> None:
        """Let the fittest of parents and offspring survive.

        Raises:
            ValueError: outcomes that do not fit the genomes asked.
        """
        check_outcomes(self.ask(), outcomes, self._settings.objectives)
        with_outcomes(self._asked, outcomes, self._settings.objectives)
        self._algorithm.tell(infills=self._asked)
        self._asked = self._next_generation()

    def _next_generation(self) -> Population:
        """Offspring, topped up with quasi-random points where duplicates were eliminated."""
        offspring = self._algorithm.ask()
        found = 0 if offspring is None else len(offspring)
        if found == self._settings.population:
            return offspring
        extra = Population.new(X=np.array(self._stream.take(self._settings.population - found)))
        return extra if offspring is None else Population.merge(offspring, extra)


class AsynchronousNsga2:
    """NSGA-II, one genome at a time, with simulated binary crossover and polynomial mutation.

    Args:
        settings: dimension, objectives, population, seed and start genomes.
    """

    def __init__(self, settings: SearchSettings) -> None:
        stream_seed, algorithm_seed = np.random.SeedSequence(settings.seed).spawn(2)
        self._settings = settings
        self._beginning = Beginning(settings, stream_seed)
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


def nsga2_algorithm(
    settings: SearchSettings,
    start: Array,
    seed: np.random.SeedSequence,
    *,
    eliminate_duplicates: bool = True,
) -> NSGA2:
    """NSGA-II of pymoo over the unit cube, ready to ask.

    Args:
        settings: dimension, objectives and population.
        start: the first generation [genomes x dimension].
        seed: of its random state.
        eliminate_duplicates: whether children that equal members are left out.
    """
    Config.warnings["not_compiled"] = False  # pymoo would print a hint on standard output
    problem = Problem(n_var=settings.dimension, n_obj=settings.objectives, n_ieq_constr=1, xl=0.0, xu=1.0)
    algorithm = NSGA2(
        pop_size=settings.population,
        sampling=start,
        crossover=MixedCrossover(settings.counts, CROSSOVER_SHARE, CROSSOVER_INDEX),
        mutation=MixedMutation(settings.counts, MUTATION_INDEX),
        seed=seed,
        eliminate_duplicates=eliminate_duplicates,
        output=None,
    )
    algorithm.setup(problem, termination=NoTermination())
    return algorithm


class MixedCrossover(SBX):  # type: ignore[misc]
    """Simulated binary crossover of continuous coordinates, exchange of discrete ones.

    Args:
        counts: of choices by coordinate.
        prob: chance that two parents are crossed at all.
        eta: distribution index.
    """

    def __init__(self, counts: Sequence[int], prob: float, eta: float) -> None:
        super().__init__(prob=prob, eta=eta)
        self._discrete = np.array(counts) > 0

    def _do(
        self, problem: Any, parents: Array, *_: Any, random_state: np.random.Generator, **__: Any
    ) -> Array:
        children: Array = super()._do(problem, parents, random_state=random_state)
        first, second = parents[:, :, self._discrete]
        exchanged = random_state.random(first.shape) < EXCHANGE
        children[0][:, self._discrete] = np.where(exchanged, second, first)
        children[1][:, self._discrete] = np.where(exchanged, first, second)
        return children


class MixedMutation(PM):  # type: ignore[misc]
    """Polynomial mutation of continuous coordinates, another choice for discrete ones.

    Args:
        counts: of choices by coordinate.
        eta: distribution index.
    """

    def __init__(self, counts: Sequence[int], eta: float) -> None:
        super().__init__(eta=eta)
        self._counts = np.array(counts)

    def _do(
        self, problem: Any, points: Array, *_: Any, random_state: np.random.Generator, **__: Any
    ) -> Array:
        mutated: Array = super()._do(problem, points, random_state=random_state)
        discrete = self._counts > 0
        parts, before = self._counts[discrete], points[:, discrete]
        further = random_state.integers(1, np.maximum(parts, 2), size=before.shape)
        changed = (
            random_state.random(before.shape) < self.get_prob_var(problem, size=len(points))[:, np.newaxis]
        )
        after = (np.floor(before * parts) + changed * further) % parts
        mutated[:, discrete] = (after + 0.5) / parts
        return mutated
