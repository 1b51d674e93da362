"""Discrete coordinates: where their middles lie, and how each search goes on varying them."""

import math

import moocore
import numpy as np
import pytest
from pymoo.core.population import Population
from pymoo.core.problem import Problem

from evodesign.errors import InputError
from evodesign.records import SearchSettings, choice_at, middle_of
from evodesign.searches.base import Outcome
from evodesign.searches.discrete import least_deviations, snapped
from evodesign.searches.nsga2 import MixedCrossover, MixedMutation
from evodesign.searches.quasi_random import SobolStream
from evodesign.searches.registry import make_asynchronous_search, make_search

COUNTS = (0, 4, 3, 7)


def test_every_choice_has_one_middle_and_holds_it():
    for count in range(2, 60):
        assert [choice_at(middle_of(choice, count), count) for choice in range(count)] == list(range(count))
        assert [choice_at(edge, count) for edge in (0.0, 1.0)] == [0, count - 1]


def test_points_move_to_the_middle_of_the_part_that_holds_them():
    points = np.random.default_rng(1).random((500, 4))
    points[0], points[1] = 0.0, 1.0
    moved = snapped(points, COUNTS)
    assert (moved[:, 0] == points[:, 0]).all()
    for column, count in ((1, 4), (2, 3), (3, 7)):
        expected = [middle_of(choice_at(each, count), count) for each in points[:, column].tolist()]
        assert moved[:, column].tolist() == expected
        assert np.abs(moved[:, column] - points[:, column]).max() <= 0.5 / count
    assert (snapped(moved, COUNTS) == moved).all()


def test_quasi_random_points_give_every_choice_as_many():
    points = np.array(SobolStream(COUNTS, np.random.SeedSequence(3)).take(420))
    for column, count in ((1, 4), (2, 3), (3, 7)):
        _, times = np.unique(points[:, column], return_counts=True)
        assert len(times) == count
        assert times.max() - times.min() <= 3


def test_deviations_are_bounded_by_a_fifth_of_a_part_or_less_in_many_dimensions():
    assert least_deviations((0, 4, 10), 3.0) == [0.0, 0.05, 0.02]
    assert least_deviations((5, *(0,) * 29), 3.0)[0] == pytest.approx(0.1 / 5)


def problem_of(dimension):
    return Problem(n_var=dimension, n_obj=1, xl=0.0, xu=1.0)


def test_children_have_choices_of_their_parents_only():
    generator = np.random.default_rng(2)
    points = snapped(generator.random((2, 4000, 4)).reshape(-1, 4), COUNTS).reshape(2, 4000, 4)
    crossover = MixedCrossover(COUNTS, 1.0, 15)
    children = crossover._do(problem_of(4), points, random_state=generator)
    for column in (1, 2, 3):
        own = children[:, :, column] == points[:, :, column]
        other = children[:, :, column] == points[::-1, :, column]
        assert (own | other).all()
        different = points[0, :, column] != points[1, :, column]
        assert other[0, different].mean() == pytest.approx(0.5, abs=0.04)
        assert children[:, :, column].sum(axis=0) == pytest.approx(points[:, :, column].sum(axis=0))
    assert (children[:, :, 0] != points[:, :, 0]).mean() > 0.3


def test_a_mutated_choice_is_another_one_and_each_other_one_as_often():
    generator = np.random.default_rng(5)
    points = np.tile([0.3, middle_of(1, 4), middle_of(2, 3), middle_of(6, 7)], (40_000, 1))
    mutated = MixedMutation(COUNTS, 20)._do(problem_of(4), points, random_state=generator)
    for column, count, own in ((1, 4, 1), (2, 3, 2), (3, 7, 6)):
        found = np.array([choice_at(each, count) for each in mutated[:, column]])
        shares = np.bincount(found, minlength=count) / len(found)
        assert mutated[:, column].tolist() == [middle_of(choice, count) for choice in found.tolist()]
        assert shares[own] == pytest.approx(0.75, abs=0.02), "one coordinate of four is changed"
        others = np.delete(shares, own)
        assert others == pytest.approx(np.full(count - 1, 0.25 / (count - 1)), abs=0.01)


def test_operators_work_as_pymoo_calls_them():
    points = snapped(np.random.default_rng(7).random((20, 4)), COUNTS)
    population = Population.new(X=points)
    parents = np.arange(20).reshape(10, 2)
    generator = np.random.default_rng(8)
    children = MixedCrossover(COUNTS, 0.9, 15).do(
        problem_of(4), population, parents, random_state=generator, algorithm=None
    )
    mutated = MixedMutation(COUNTS, 20).do(problem_of(4), children, random_state=generator, algorithm=None)
    found = mutated.get("X")
    assert found.shape == (20, 4)
    assert (snapped(found, COUNTS) == found).all()


DIMENSION, PARTS = 12, 6
"""Six continuous coordinates, then six choices of six."""

BEST = (4, 1, 3, 0, 5, 2)
"""The choice that is best in each discrete coordinate."""

OPTIMUM = 0.2 + 0.6 * ((np.arange(6) * 0.618034) % 1.0)


def assess(genome):
    """Two objectives, traded by the first coordinate; every other number adds to both until it is right.

    A wrong choice costs the more the farther it is off, and the continuous optimum moves with the first one,
    so that who has converged with a wrong choice is stuck unless choices go on being varied.
    """
    choices = [choice_at(each, PARTS) for each in genome[6:]]
    off = np.array(genome[1:6]) - (OPTIMUM[1:] + 0.02 * (choices[0] - BEST[0]))
    wrong = sum(0.15 * abs(choice - best) for choice, best in zip(choices, BEST, strict=True))
    radius = 1.0 + 4.0 * float(off @ off) + wrong
    angle = genome[0] * math.pi / 2.0
    return Outcome((radius * math.cos(angle), radius * math.sin(angle)), 0.0)


def mixed(algorithm, seed, start=()):
    return SearchSettings(
        algorithm=algorithm,
        dimension=DIMENSION,
        objectives=2,
        population=24,
        seed=seed,
        start=start,
        choices=(0,) * 6 + (PARTS,) * 6,
    )


def genomes_of(algorithm, seed, generations=40):
    search, asked = make_search(mixed(algorithm, seed)), []
    for _ in range(generations):
        genomes = search.ask()
        asked += genomes
        search.tell([assess(genome) for genome in genomes])
    return asked


def dominated(genomes):
    points = np.array([assess(genome).objectives for genome in genomes])
    return float(moocore.hypervolume(points, ref=(2.0, 2.0)))


def test_the_front_of_the_mixed_problem_is_the_unit_circle():
    right = (*OPTIMUM, *(middle_of(best, PARTS) for best in BEST))
    assert math.hypot(*assess(right).objectives) == pytest.approx(1.0)
    wrong = (*OPTIMUM, *(middle_of(best, PARTS) for best in (5, 1, 3, 0, 5, 2)))
    assert math.hypot(*assess(wrong).objectives) > 1.15


@pytest.mark.parametrize("seed", [1, 2, 3])
@pytest.mark.parametrize("algorithm", ["nsga2", "cma-es"])
def test_right_choices_are_found_where_random_sampling_finds_none(algorithm, seed):
    asked = genomes_of(algorithm, seed)
    best = min(asked, key=lambda genome: math.hypot(*assess(genome).objectives))
    assert [choice_at(each, PARTS) for each in best[6:]] == list(BEST)
    assert dominated(asked) > 1.5 * dominated(genomes_of("random", seed))


def stuck(monkeypatch):
    """Take from both searches what they do about choices beyond rounding and exchange."""
    monkeypatch.setattr(
        "evodesign.searches.cma_instances.least_deviations", lambda counts, _: [0.0] * len(counts)
    )
    monkeypatch.setattr(MixedMutation, "_do", lambda self, problem, points, *_, **__: points)


def test_right_choices_are_missed_without_mutation(monkeypatch):
    stuck(monkeypatch)
    best = min(genomes_of("nsga2", 1), key=lambda genome: math.hypot(*assess(genome).objectives))
    assert [choice_at(each, PARTS) for each in best[6:]] != list(BEST)


@pytest.mark.parametrize("algorithm", ["nsga2", "cma-es"])
def test_choices_go_on_being_varied_after_all_else_has_converged(algorithm, monkeypatch):
    """Without the bound on CMA-ES's deviations, and without mutation of choices in NSGA-II, they are not."""

    def rare(genomes):
        """Share of genomes of which some choice is not the commonest of its place."""
        choices = np.array([genome[6:] for genome in genomes])
        commonest = [max(set(column), key=list(column).count) for column in choices.T]
        return float((choices != commonest).any(axis=1).mean())

    late = genomes_of(algorithm, 1, 120)[-240:]
    assert rare(late) > 0.1
    stuck(monkeypatch)
    assert rare(genomes_of(algorithm, 1, 120)[-240:]) < 0.02


def test_one_discrete_coordinate_alone_is_not_for_cma_es():
    alone = SearchSettings(algorithm="cma-es", dimension=1, objectives=1, population=6, seed=1, choices=(4,))
    for make in (make_search, make_asynchronous_search):
        with pytest.raises(InputError, match="one discrete coordinate"):
            make(alone)
