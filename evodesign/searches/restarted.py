"""A search that was another one for its first generations.

The past is rebuilt by asking and telling the earlier search, as ever. Then the next search begins with the
fittest of all that the past knew as its first generation, told at once, so that nothing is evaluated again
(unless the past knew too few different ones: then that generation is evaluated). The fittest are those that
NSGA-II would let survive: feasible ones first, then by rank of domination, then by crowding distance.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import msgspec
import numpy as np
from pymoo.core.population import Population
from pymoo.core.problem import Problem
from pymoo.operators.survival.rank_and_crowding import RankAndCrowding

from evodesign.errors import InputError
from evodesign.records import Genome, SearchSettings
from evodesign.searches.base import Outcome, Search
from evodesign.searches.ranking import with_outcomes

MakeSearch = Callable[[SearchSettings], Search]


class Restarted:
    """Searches one after another, each with what is known from those before.

    Args:
        settings: with one past stage or more.
        make: makes a search of settings without a past.
    Raises:
        InputError: a stage without generations, or a population that the past could not fill.
    """

    def __init__(self, settings: SearchSettings, make: MakeSearch) -> None:
        self._settings = settings
        self._make = make
        self._told: dict[Genome, Outcome] = {}
        self._stage = self._generation = 0
        _check(settings)
        self._search = make(_of_stage(settings, 0, settings.start))

    def ask(self) -> tuple[Genome, ...]:
        """The genomes of the next generation of the present stage."""
        return self._search.ask()

    def tell(self, outcomes: Sequence[Outcome]) -> None:
        """Outcomes of the genomes last asked for; at the end of a stage, the next search takes over."""
        self._told |= zip(self._search.ask(), outcomes, strict=True)
        self._search.tell(outcomes)
        self._generation += 1
        past = self._settings.past
        if self._stage < len(past) and self._generation == past[self._stage].generations:
            self._stage += 1
            self._generation = 0
            self._search = self._successor()

    def _successor(self) -> Search:
        settings = _of_stage(self._settings, self._stage, ())
        start = fittest(self._told, settings.population, settings.objectives)
        search = self._make(msgspec.structs.replace(settings, start=start))
        asked = search.ask()
        if all(genome in self._told for genome in asked):
            search.tell([self._told[genome] for genome in asked])
        return search


def fittest(known: dict[Genome, Outcome], count: int, objectives: int) -> tuple[Genome, ...]:
    """So many of the known genomes, the fittest first."""
    genomes, outcomes = list(known), list(known.values())
    population = Population.new(X=np.array(genomes))
    with_outcomes(population, outcomes, objectives)
    population.set("number", np.arange(len(genomes)))
    problem = Problem(n_var=len(genomes[0]), n_obj=objectives, n_ieq_constr=1, xl=0.0, xu=1.0)
    kept = RankAndCrowding().do(problem, population, n_survive=count, random_state=np.random.default_rng(0))
    return tuple(genomes[number] for number in kept.get("number").tolist())


def _of_stage(settings: SearchSettings, stage: int, start: tuple[Genome, ...]) -> SearchSettings:
    """Settings of one stage by itself; the last is what the settings say now."""
    now = settings if stage == len(settings.past) else settings.past[stage]
    return msgspec.structs.replace(
        settings, algorithm=now.algorithm, population=now.population, seed=now.seed, start=start, past=()
    )


def _check(settings: SearchSettings) -> None:
    known = 0
    for index, stage in enumerate(settings.past):
        if stage.generations < 1:
            raise InputError("search", f"past[{index}].generations", "at least 1", str(stage.generations))
        known += stage.generations * stage.population
    if settings.population > known:
        wanted = f"at most {known}, the evaluations of the past"
        raise InputError("search", "population", wanted, str(settings.population))
