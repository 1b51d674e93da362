"""Searches that learn must be better than random sampling on a constrained problem of our size.

DTLZ2 in 16 dimensions with the optimum off the centre and a half-space that cuts the cube near it:
f = (1 + g) times a point of the unit sphere's first orthant, g = squared distance to the optimum.
"""

import math

import moocore
import numpy as np
import pytest

from evodesign.records import SearchSettings
from evodesign.searches.base import Outcome
from evodesign.searches.registry import make_search

DIMENSION = 16
POPULATION = 48
GENERATIONS = 10
REFERENCE = 1.6
OPTIMUM = 0.2 + 0.6 * ((np.arange(DIMENSION) * 0.618034) % 1.0)


def assess(genome, objectives):
    angles, rest = np.array(genome[: objectives - 1]) * math.pi / 2.0, np.array(genome[objectives - 1 :])
    off = rest - OPTIMUM[objectives - 1 :]
    radius = 1.0 + float(off @ off)
    values = [radius * float(np.prod(np.cos(angles)))]
    for index in range(objectives - 1):
        head = angles[: objectives - 2 - index]
        values.append(radius * float(np.prod(np.cos(head)) * np.sin(angles[len(head)])))
    violation = max(0.0, float(np.sum(off)) - 0.3)
    return Outcome(tuple(values) if violation == 0.0 else None, violation)


def dominated(algorithm, objectives, seed):
    """Hypervolume after 480 evaluations."""
    search = make_search(
        SearchSettings(
            algorithm=algorithm,
            dimension=DIMENSION,
            objectives=objectives,
            population=POPULATION,
            seed=seed,
        )
    )
    feasible = []
    for _ in range(GENERATIONS):
        told = [assess(genome, objectives) for genome in search.ask()]
        search.tell(told)
        feasible += [outcome.objectives for outcome in told if outcome.feasible]
    return float(moocore.hypervolume(np.array(feasible), ref=[REFERENCE] * objectives))


def test_the_problem_has_its_front_on_the_unit_sphere():
    for objectives in (2, 3):
        on_front = (0.3,) * (objectives - 1) + tuple(OPTIMUM[objectives - 1 :])
        outcome = assess(on_front, objectives)
        assert outcome.feasible
        assert math.hypot(*outcome.objectives) == pytest.approx(1.0, rel=1e-12)
    assert not assess((1.0,) * DIMENSION, 2).feasible


@pytest.mark.parametrize("seed", [1, 2, 3])
@pytest.mark.parametrize("objectives", [2, 3])
@pytest.mark.parametrize(("algorithm", "times"), [("nsga2", 1.5), ("cma-es", 2.2)])
def test_beats_random_by_a_wide_margin(algorithm, times, objectives, seed):
    assert dominated(algorithm, objectives, seed) > times * dominated("random", objectives, seed)
