"""NSGA-II: non-dominated sorting, crowding, simulated binary crossover and polynomial mutation (pymoo).

pymoo's operators draw from the algorithm's own random state (since 0.6.1.5). Every outcome enters with its
infeasibility as the one constraint. pymoo splits by feasibility before it sorts, orders infeasible designs
by that constraint alone and compares objectives of feasible designs only; the others carry NaN there, so
that no number stands for a value that does not exist. `mixed_operators` varies discrete coordinates.

Source: Deb, Pratap, Agarwal and Meyarivan, A fast and elitist multiobjective genetic algorithm, 2002.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.config import Config
from pymoo.core.population import Population
from pymoo.core.problem import Problem
from pymoo.core.termination import NoTermination
from pymoo.operators.crossover.sbx import SBX
from pymoo.operators.mutation.pm import PM

from evodesign.records import Genome, SearchSettings
from evodesign.search.base import Outcome
from evodesign.search.mixed_operators import MixedCrossover, MixedMutation
from evodesign.search.quasi_random import SobolStream, first_generation
from evodesign.search.ranking import check_outcomes, infeasibility, usable

__all__ = ["Nsga2", "nsga2_algorithm", "with_outcomes"]

CROSSOVER_SHARE = 0.9
CROSSOVER_INDEX = 15
MUTATION_INDEX = 20
"""pymoo's defaults, given to operators of our own: its default operators are shared by every instance."""


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


def nsga2_algorithm(
    settings: SearchSettings,
    start: NDArray[np.float64],
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
        crossover=_crossover(settings),
        mutation=_mutation(settings),
        seed=seed,
        eliminate_duplicates=eliminate_duplicates,
        output=None,
    )
    algorithm.setup(problem, termination=NoTermination())
    return algorithm


def _crossover(settings: SearchSettings) -> SBX:
    if settings.discrete:
        return MixedCrossover(settings.counts, CROSSOVER_SHARE, CROSSOVER_INDEX)
    return SBX(prob=CROSSOVER_SHARE, eta=CROSSOVER_INDEX)


def _mutation(settings: SearchSettings) -> PM:
    if settings.discrete:
        return MixedMutation(settings.counts, MUTATION_INDEX)
    return PM(eta=MUTATION_INDEX)


def with_outcomes(population: Population, outcomes: Sequence[Outcome], objectives: int) -> None:
    """Give members their outcomes: infeasibility as the one constraint, NaN where there are no objectives."""
    absent = (math.nan,) * objectives
    population.set("F", np.array([usable(outcome) or absent for outcome in outcomes]))
    population.set("G", np.array([[infeasibility(outcome)] for outcome in outcomes]))
