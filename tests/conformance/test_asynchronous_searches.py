"""What every asynchronous search of the registry promises, whatever its algorithm."""

import random
from functools import cache

import moocore
import msgspec
import numpy as np
import pytest

from evodesign.errors import InputError
from evodesign.searches.base import JOINT_STARTS, Outcome
from evodesign.searches.registry import ASYNCHRONOUS_SEARCHES, SEARCHES, make_asynchronous_search, make_search
from tests.conformance.test_searches import FAILED, settings

ALGORITHMS = sorted(ASYNCHRONOUS_SEARCHES)
LEARNING = sorted(set(ASYNCHRONOUS_SEARCHES) - {"random"})


def bowls(genome, objectives):
    """One bowl per objective; a corner of the cube is forbidden, and a small first coordinate fails."""
    if genome[0] < 0.15:
        return FAILED
    values = tuple(
        sum((coordinate - 0.2 - 0.3 * index) ** 2 for coordinate in genome) for index in range(objectives)
    )
    violation = max(0.0, sum(genome) / len(genome) - 0.6)
    return Outcome(values if violation == 0.0 else None, violation)


def run(search, turns, *, workers=4, order=1, objectives=2, outcome=bowls):
    """Ask and tell with some workers of random speed; gives (turn, outcomes told before, genome) in order."""
    pick = random.Random(order)
    flying, log, asked = {}, [], 0
    while asked < turns or flying:
        while asked < turns and len(flying) < workers:
            flying[asked] = (len(log), search.ask(asked))
            asked += 1
        turn = pick.choice(sorted(flying))
        told, genome = flying.pop(turn)
        log.append((turn, told, genome))
        search.tell(turn, outcome(genome, objectives))
    return log


@cache
def whole_run(algorithm):
    """What a search asks for in 120 turns: what others of the same seed are compared with."""
    return run(make_asynchronous_search(settings(algorithm)), 120)


def replay(search, log, objectives=2):
    """Tell a log again, asking for each genome when it was asked; asserts that it is the same one."""
    for position, (turn, _, genome) in enumerate(log):
        for asked, told, expected in log:
            if told == position:
                assert search.ask(asked) == expected
        search.tell(turn, bowls(genome, objectives))


def test_every_search_can_go_without_generations():
    assert set(ASYNCHRONOUS_SEARCHES) == set(SEARCHES) - {JOINT_STARTS}, (
        "starts of a baseline follow from nothing"
    )


@pytest.mark.parametrize("algorithm", ALGORITHMS)
class TestEveryAsynchronousSearch:
    @pytest.mark.slow
    @pytest.mark.parametrize(("population", "workers"), [(3, 40), (4, 1), (12, 5), (70, 1), (70, 40)])
    def test_asks_for_points_of_the_unit_cube(self, algorithm, population, workers):
        log = run(make_asynchronous_search(settings(algorithm, population=population)), 150, workers=workers)
        assert len({genome for _, _, genome in log}) == 150
        for _, _, genome in log:
            assert isinstance(genome, tuple)
            assert len(genome) == 5
            assert all(type(coordinate) is float and 0.0 <= coordinate <= 1.0 for coordinate in genome)

    @pytest.mark.parametrize(("dimension", "objectives"), [(1, 1), (1, 2), (2, 1), (3, 4), (24, 3)])
    def test_takes_any_number_of_dimensions_and_objectives(self, algorithm, dimension, objectives):
        search = make_asynchronous_search(settings(algorithm, dimension=dimension, objectives=objectives))
        assert len(run(search, 60, objectives=objectives)) == 60

    def test_the_order_of_arrival_rebuilds_the_search(self, algorithm):
        search = make_asynchronous_search(settings(algorithm))
        log = run(search, 120, workers=7)
        rebuilt = make_asynchronous_search(settings(algorithm))
        replay(rebuilt, log)
        assert [search.ask(turn) for turn in range(200, 230)] == [
            rebuilt.ask(turn) for turn in range(200, 230)
        ]

    @pytest.mark.slow
    def test_what_was_asked_and_never_told_leaves_no_trace(self, algorithm):
        wasteful, careful = (make_asynchronous_search(settings(algorithm, dimension=24)) for _ in range(2))
        for turn in range(80):  # a surrogate learns from the 36th on
            lost = [wasteful.ask(1000 + 3 * turn + extra) for extra in range(turn % 4)]
            genome = wasteful.ask(turn)
            assert careful.ask(turn) == genome
            assert genome not in lost
            for search in (wasteful, careful):
                search.tell(turn, bowls(genome, 2))

    def test_the_same_turn_asked_again_has_the_same_genome(self, algorithm):
        search = make_asynchronous_search(settings(algorithm))
        run(search, 60)
        assert search.ask(60) == search.ask(60)

    @pytest.mark.slow
    def test_a_genome_depends_on_the_order_of_arrival_where_the_search_learns(self, algorithm):
        one = whole_run(algorithm)
        other = run(make_asynchronous_search(settings(algorithm)), 120, order=2)
        genomes = [{turn: genome for turn, _, genome in log} for log in (one, other)]
        assert (genomes[0] == genomes[1]) is (algorithm not in LEARNING)

    def test_seeds_differ(self, algorithm):
        other = run(make_asynchronous_search(settings(algorithm, seed=2)), 60)
        assert {genome for *_, genome in whole_run(algorithm)}.isdisjoint(genome for *_, genome in other)

    def test_it_begins_as_with_generations(self, algorithm):
        start = ((0.5,) * 5, (0.0,) * 5, (0.5,) * 5, (0.1, 0.2, 0.3, 0.4, 0.5))
        asynchronous = make_asynchronous_search(settings(algorithm, start=start))
        first = make_search(settings(algorithm, start=start)).ask()
        assert tuple(asynchronous.ask(turn) for turn in range(12)) == first

    def test_global_random_state_is_neither_read_nor_changed(self, algorithm):
        whole = whole_run(algorithm)
        np.random.seed(1)  # noqa: NPY002
        random.seed(1)
        before, python_before = np.random.get_state(), random.getstate()  # noqa: NPY002
        assert run(make_asynchronous_search(settings(algorithm)), 120) == whole
        after = np.random.get_state()  # noqa: NPY002
        assert (before[1] == after[1]).all()
        assert before[2:] == after[2:]
        assert random.getstate() == python_before

    def test_failures_of_all_are_survived(self, algorithm):
        search = make_asynchronous_search(settings(algorithm))
        lost = run(search, 80, outcome=lambda genome, _: FAILED)
        assert len({genome for *_, genome in lost}) == 80

    def test_an_unknown_algorithm_names_the_nearest(self, algorithm):
        with pytest.raises(InputError, match=f"did you mean '{algorithm}'"):
            make_asynchronous_search(settings(algorithm[:-1]))


@pytest.mark.parametrize("algorithm", ALGORITHMS)
class TestEveryAsynchronousSearchOfChoices:
    CHOICES = (0, 3, 0, 5, 2)

    def discrete(self, algorithm):
        return msgspec.structs.replace(settings(algorithm), choices=self.CHOICES)

    @pytest.mark.slow
    def test_asks_only_for_the_middles_of_choices_and_for_each_of_them(self, algorithm):
        log = run(make_asynchronous_search(self.discrete(algorithm)), 360)
        for position, count in enumerate(self.CHOICES):
            seen = {genome[position] for *_, genome in log}
            expected = {(choice + 0.5) / count for choice in range(count)}
            assert seen == expected if count else len(seen) > 100

    @pytest.mark.slow
    def test_the_order_of_arrival_rebuilds_the_search(self, algorithm):
        search = make_asynchronous_search(self.discrete(algorithm))
        log = run(search, 120, workers=7)
        rebuilt = make_asynchronous_search(self.discrete(algorithm))
        replay(rebuilt, log)
        assert [search.ask(turn) for turn in range(200, 230)] == [
            rebuilt.ask(turn) for turn in range(200, 230)
        ]

    def test_few_designs_are_all_asked_for(self, algorithm):
        few = msgspec.structs.replace(settings(algorithm, dimension=2), choices=(2, 3))
        log = run(make_asynchronous_search(few), 240, outcome=lambda genome, _: Outcome(genome, 0.0))
        assert len({genome for *_, genome in log}) == 6


@pytest.mark.parametrize("algorithm", LEARNING)
class TestEveryAsynchronousSearchThatLearns:
    @pytest.mark.slow
    def test_one_objective_is_minimised(self, algorithm):
        log = run(make_asynchronous_search(settings(algorithm, objectives=1)), 400, workers=6, objectives=1)
        values = [bowls(genome, 1).objectives for *_, genome in log]
        found = [value[0] for value in values if value is not None]
        assert min(found) < 0.05 * min(found[:12])

    @pytest.mark.parametrize("workers", [1, 12])
    @pytest.mark.slow
    def test_finds_about_as_much_as_with_generations(self, algorithm, workers):
        asynchronous = run(make_asynchronous_search(settings(algorithm, population=24)), 600, workers=workers)
        ratio = dominated([genome for *_, genome in asynchronous]) / with_generations(algorithm)
        assert ratio > 0.97


@cache
def with_generations(algorithm):
    """Hypervolume of 600 genomes in generations of 24."""
    search, asked = make_search(settings(algorithm, population=24)), []
    for _ in range(25):
        genomes = search.ask()
        asked += genomes
        search.tell([bowls(genome, 2) for genome in genomes])
    return dominated(asked)


def dominated(genomes):
    """Hypervolume of the feasible ones."""
    values = [bowls(genome, 2).objectives for genome in genomes]
    return moocore.hypervolume(np.array([each for each in values if each is not None]), ref=(2.0, 2.0))
