"""What every search of the registry promises, whatever its algorithm."""

import json
import random
import subprocess
import sys
from functools import cache

import numpy as np
import pytest

from evodesign.errors import InputError
from evodesign.records import SearchSettings, SearchStage
from evodesign.searches.base import JOINT_STARTS, Outcome
from evodesign.searches.registry import SEARCHES, make_search

ALGORITHMS = sorted(SEARCHES)
LEARNING = sorted(set(SEARCHES) - {"random", JOINT_STARTS})
FAILED = Outcome(None, None)


def settings(algorithm, **changes):
    usual = {"dimension": 5, "objectives": 2, "population": 12, "seed": 1}
    return SearchSettings(algorithm=algorithm, **(usual | changes))


def bowls(genome, objectives):
    """One bowl per objective, each around its own centre; a corner of the cube is forbidden."""
    values = tuple(
        sum((coordinate - 0.2 - 0.3 * index) ** 2 for coordinate in genome) for index in range(objectives)
    )
    violation = max(0.0, sum(genome) / len(genome) - 0.6)
    return Outcome(values if violation == 0.0 else None, violation)


def mixed(genome, objectives):
    """The bowls, but designs with a small first coordinate fail."""
    return FAILED if genome[0] < 0.15 else bowls(genome, objectives)


def run(search, generations, objectives=2, outcome=mixed):
    asked = []
    for _ in range(generations):
        genomes = search.ask()
        asked.append(genomes)
        search.tell([outcome(genome, objectives) for genome in genomes])
    return asked


@cache
def whole_run(algorithm):
    """What a search asks for in 9 generations: what others of the same seed are compared with."""
    return run(make_search(settings(algorithm)), 9)


def asked_here(algorithm):
    """The bits of 6 generations of genomes with one objective."""
    search = make_search(settings(algorithm, objectives=1))
    asked = run(search, 6, 1, lambda genome, _: Outcome((genome[0] + genome[1] ** 2,), 0.0))
    return [[[x.hex() for x in genome] for genome in genomes] for genomes in asked]


@cache
def asked_elsewhere():
    """The same of every algorithm, in another process."""
    script = (
        "import importlib.util, json\n"
        f"spec = importlib.util.spec_from_file_location('there', {__file__!r})\n"
        "there = importlib.util.module_from_spec(spec)\n"
        "spec.loader.exec_module(there)\n"
        "print(json.dumps({name: there.asked_here(name) for name in there.ALGORITHMS}))\n"
    )
    done = subprocess.run([sys.executable, "-c", script], check=True, capture_output=True, text=True)
    return json.loads(done.stdout)


@pytest.mark.parametrize("algorithm", ALGORITHMS)
class TestEverySearch:
    @pytest.mark.slow
    @pytest.mark.parametrize("population", [3, 4, 7, 12, 70])
    def test_asks_for_a_population_of_points_of_the_unit_cube(self, algorithm, population):
        search = make_search(settings(algorithm, population=population))
        for genomes in run(search, 5):
            assert isinstance(genomes, tuple)
            assert len(genomes) == population
            for genome in genomes:
                assert isinstance(genome, tuple)
                assert len(genome) == 5
                assert all(type(coordinate) is float and 0.0 <= coordinate <= 1.0 for coordinate in genome)

    @pytest.mark.slow
    @pytest.mark.parametrize(("dimension", "objectives"), [(1, 1), (1, 2), (2, 1), (3, 4), (16, 3)])
    def test_takes_any_number_of_dimensions_and_objectives(self, algorithm, dimension, objectives):
        search = make_search(settings(algorithm, dimension=dimension, objectives=objectives))
        asked = run(search, 6, objectives)
        assert {len(genomes) for genomes in asked} == {12}
        assert len(set(asked)) == 6

    @pytest.mark.slow
    def test_asks_for_distinct_genomes_within_a_generation(self, algorithm):
        for genomes in run(make_search(settings(algorithm)), 10):
            assert len(set(genomes)) == len(genomes)

    def test_asks_for_the_same_genomes_until_told(self, algorithm):
        search = make_search(settings(algorithm))
        run(search, 2)
        assert search.ask() == search.ask()

    def test_same_seed_and_outcomes_give_the_same_genomes(self, algorithm):
        assert run(make_search(settings(algorithm)), 9) == whole_run(algorithm)

    def test_two_searches_side_by_side_do_not_disturb_each_other(self, algorithm):
        first, second = make_search(settings(algorithm)), make_search(settings(algorithm, seed=9))
        interleaved = []
        for _ in range(4):
            interleaved += run(first, 1)
            run(second, 1)
        assert interleaved == whole_run(algorithm)[:4]

    def test_different_seeds_give_different_genomes(self, algorithm):
        one = whole_run(algorithm)[:3]
        other = run(make_search(settings(algorithm, seed=2)), 3)
        assert all(set(a).isdisjoint(b) for a, b in zip(one, other, strict=True))

    def test_replay_of_remembered_outcomes_continues_the_run(self, algorithm):
        whole = whole_run(algorithm)
        resumed = make_search(settings(algorithm))
        for genomes in whole[:5]:
            assert resumed.ask() == genomes
            resumed.tell([mixed(genome, 2) for genome in genomes])
        assert run(resumed, 4) == whole[5:]

    @pytest.mark.slow
    def test_another_process_asks_for_the_same_genomes_bit_for_bit(self, algorithm):
        assert asked_elsewhere()[algorithm] == asked_here(algorithm)

    def test_start_genomes_come_first(self, algorithm):
        start = ((0.5,) * 5, (0.0,) * 5, (1.0,) * 5, (0.1, 0.2, 0.3, 0.4, 0.5))
        asked = run(make_search(settings(algorithm, start=start)), 6)
        assert asked[0][:4] == start
        assert len(asked[0]) == 12

    def test_a_repeated_start_genome_is_asked_once(self, algorithm):
        start = ((0.5,) * 5, (0.5,) * 5, (0.25,) * 5)
        (genomes,) = run(make_search(settings(algorithm, start=start)), 1)
        assert genomes[:2] == ((0.5,) * 5, (0.25,) * 5)
        assert len(set(genomes)) == 12

    def test_of_too_many_start_genomes_the_first_are_kept(self, algorithm):
        start = tuple((index / 20.0,) * 5 for index in range(20))
        asked = run(make_search(settings(algorithm, start=start)), 3)
        assert asked[0] == start[:12]

    def test_global_random_state_is_neither_read_nor_changed(self, algorithm):
        whole = whole_run(algorithm)
        np.random.seed(1)  # noqa: NPY002
        random.seed(1)
        before, python_before = np.random.get_state(), random.getstate()  # noqa: NPY002
        few = run(make_search(settings(algorithm, population=4)), 5)
        assert run(make_search(settings(algorithm)), 5) == whole[:5]
        after = np.random.get_state()  # noqa: NPY002
        assert (before[1] == after[1]).all()
        assert before[2:] == after[2:]
        assert random.getstate() == python_before
        np.random.seed(2)  # noqa: NPY002
        random.seed(2)
        assert run(make_search(settings(algorithm, population=4)), 5) == few

    def test_generations_in_which_all_fails_are_survived(self, algorithm):
        search = make_search(settings(algorithm))
        lost = run(search, 6, outcome=lambda genome, _: FAILED)
        found = run(search, 3)
        assert len(set(lost + found)) == 9

    def test_a_run_that_fails_after_a_good_start_is_survived(self, algorithm):
        search = make_search(settings(algorithm))
        found = run(search, 3)
        lost = run(search, 6, outcome=lambda genome, _: FAILED)
        assert len(set(found + lost)) == 9

    def test_an_objective_that_is_no_finite_number_counts_as_a_failure(self, algorithm):
        def broken(value):
            return lambda genome, objectives: (
                Outcome((value, 0.0), 0.0) if genome[1] < 0.3 else mixed(genome, objectives)
            )

        def failed(genome, objectives):
            return FAILED if genome[1] < 0.3 else mixed(genome, objectives)

        known = run(make_search(settings(algorithm)), 6, outcome=failed)
        for value in (float("nan"), float("inf")):
            assert run(make_search(settings(algorithm)), 6, outcome=broken(value)) == known

    def test_infeasible_objectives_are_never_looked_at(self, algorithm):
        def tempting(genome, objectives):
            outcome = mixed(genome, objectives)
            return outcome if outcome.feasible else Outcome((-1e9,) * objectives, outcome.violation)

        tempted = run(make_search(settings(algorithm)), 8, outcome=tempting)
        assert tempted == whole_run(algorithm)[:8]

    @pytest.mark.parametrize("count", [0, 11, 13])
    def test_refuses_a_wrong_number_of_outcomes(self, algorithm, count):
        search = make_search(settings(algorithm))
        search.ask()
        with pytest.raises(ValueError, match=f"12 genomes asked, found {count}"):
            search.tell([FAILED] * count)

    def test_refuses_a_wrong_number_of_objectives(self, algorithm):
        search = make_search(settings(algorithm))
        search.ask()
        with pytest.raises(ValueError, match="wanted 2 objectives, found 3 in outcome 11"):
            search.tell([FAILED] * 11 + [Outcome((1.0, 2.0, 3.0), 0.0)])


CHOICES = (0, 3, 0, 5, 2)


def discrete(algorithm, *, choices=CHOICES, **changes):
    """Settings of a search whose coordinates are discrete where there are choices."""
    return settings(algorithm, dimension=len(choices), choices=choices, **changes)


def middles(count):
    return {(choice + 0.5) / count for choice in range(count)}


@pytest.mark.parametrize("algorithm", ALGORITHMS)
class TestEverySearchOfChoices:
    @pytest.mark.slow
    def test_asks_only_for_the_middles_of_choices_and_for_each_of_them(self, algorithm):
        asked = [genome for genomes in run(make_search(discrete(algorithm)), 30) for genome in genomes]
        for position, count in enumerate(CHOICES):
            seen = {genome[position] for genome in asked}
            assert seen == middles(count) if count else len(seen) > 100

    def test_replay_of_remembered_outcomes_continues_the_run(self, algorithm):
        whole = run(make_search(discrete(algorithm)), 9)
        resumed = make_search(discrete(algorithm))
        for genomes in whole[:5]:
            assert resumed.ask() == genomes
            resumed.tell([mixed(genome, 2) for genome in genomes])
        assert run(resumed, 4) == whole[5:]

    def test_a_space_of_fewer_designs_than_a_population_is_searched_to_the_end(self, algorithm):
        asked = run(make_search(discrete(algorithm, choices=(2, 3))), 10)
        assert {len(genomes) for genomes in asked} == {12}
        assert len({genome for genomes in asked for genome in genomes}) == 6

    def test_a_start_genome_beside_the_middles_is_refused(self, algorithm):
        right = (0.3, 0.5, 0.3, 0.1, 0.75)
        assert make_search(discrete(algorithm, start=(right,))).ask()[0] == right
        with pytest.raises(InputError, match="middle of one of 5 parts"):
            make_search(discrete(algorithm, start=((0.3, 0.5, 0.3, 0.2, 0.75),)))

    @pytest.mark.parametrize(("choices", "words"), [((0, 1, 3), "at least 2"), ((0, -2, 3), "at least 2")])
    def test_a_choice_of_one_is_refused(self, algorithm, choices, words):
        with pytest.raises(InputError, match=words):
            make_search(discrete(algorithm, choices=choices))

    def test_zero_choices_everywhere_mean_a_continuous_search(self, algorithm):
        assert run(make_search(discrete(algorithm, choices=(0,) * 5)), 5) == whole_run(algorithm)[:5]

    def test_a_branch_goes_on_among_the_choices(self, algorithm):
        past = (SearchStage(algorithm="random", population=12, seed=3, generations=2),)
        search = make_search(discrete(algorithm, past=past))
        asked = [genome for genomes in run(search, 8) for genome in genomes]
        assert {genome[3] for genome in asked} == middles(5)


@pytest.mark.parametrize("algorithm", LEARNING)
class TestEverySearchThatLearns:
    def test_violation_shrinks_while_nothing_is_feasible(self, algorithm):
        def violated(genome, _):
            return Outcome(None, 0.01 + sum((coordinate - 0.7) ** 2 for coordinate in genome))

        asked = run(make_search(settings(algorithm)), 25, outcome=violated)
        least = [min(violated(genome, 2).violation for genome in genomes) - 0.01 for genomes in asked]
        assert least[-1] < 0.2 * least[0]

    def test_leaves_a_region_in_which_all_fails(self, algorithm):
        def half(genome, objectives):
            return FAILED if genome[0] < 0.5 else bowls(genome, objectives)

        asked = run(make_search(settings(algorithm)), 20, outcome=half)
        failures = [sum(half(genome, 2) is FAILED for genome in genomes) for genomes in asked]
        assert failures[0] >= 4
        assert sum(failures[-5:]) / 5 < 0.8 * failures[0]

    @pytest.mark.slow
    def test_one_objective_is_minimised(self, algorithm):
        asked = run(make_search(settings(algorithm, objectives=1)), 30, 1, bowls)
        least = [
            min(outcome.objectives[0] for genome in genomes if (outcome := bowls(genome, 1)).feasible)
            for genomes in asked
        ]
        assert least[-1] < 0.05 * least[0]
