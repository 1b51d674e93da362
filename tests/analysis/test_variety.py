import itertools
import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from evodesign.analysis import decision_making
from evodesign.analysis.decision_making import most_different, spread_out
from tests.analysis.designs import design, numbers

coordinate = st.integers(0, 10).map(lambda step: step / 10.0)
points = st.lists(st.tuples(coordinate, coordinate), min_size=2, max_size=9, unique=True)


def least_distance(rows):
    return min(math.dist(a, b) for a, b in itertools.combinations(rows, 2))


@given(points, st.integers(2, 5))
def test_the_least_distance_is_at_least_half_of_the_best_possible(rows, count):
    count = min(count, len(rows))
    chosen = [rows[row] for row in spread_out(np.array(rows), count)]
    best = max(least_distance(choice) for choice in itertools.combinations(rows, count))
    assert len(chosen) == count
    assert least_distance(chosen) >= best / 2.0 - 1e-12


@given(points)
def test_two_are_the_two_furthest_apart(rows):
    chosen = [rows[row] for row in spread_out(np.array(rows), 2)]
    assert math.isclose(math.dist(*chosen), max(math.dist(a, b) for a, b in itertools.combinations(rows, 2)))


def test_the_order_is_worked_by_hand():
    line = [(0.0,), (0.1,), (0.45,), (0.7,), (1.0,)]
    assert spread_out(np.array(line), 5) == [0, 4, 2, 3, 1]


def test_copies_are_not_chosen():
    designs = [design(number, {}, genome=genome) for number, genome in enumerate([(0.0,), (1.0,), (0.0,)])]
    assert numbers(most_different(designs, 3)) == [0, 1]
    assert numbers(most_different([designs[0], designs[2]], 2)) == [0]


def test_few_designs_or_none_are_all_there_is():
    one = design(7, {}, genome=(0.5, 0.5))
    assert numbers(most_different([one], 5)) == [7]
    assert numbers(most_different([one, design(8, {}, genome=(0.0, 0.5))], 1)) == [7]
    assert most_different([], 5) == ()


def test_the_furthest_pair_does_not_depend_on_how_many_rows_are_held(monkeypatch):
    rows = np.random.default_rng(1).random((50, 3))
    whole = spread_out(rows, 8)
    monkeypatch.setattr(decision_making, "ROWS_AT_ONCE", 7)
    assert spread_out(rows, 8) == whole
