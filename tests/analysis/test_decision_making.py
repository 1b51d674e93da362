"""Knees and aspirations: closed forms, and no dominated design before the one that dominates it."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from evodesign.analysis import decision_making
from evodesign.analysis.decision_making import (
    AUGMENTATION,
    aspiration_of,
    bulges,
    closest,
    knees,
    most_different,
    scaled,
    spread_out,
)
from evodesign.analysis.front import front
from evodesign.errors import InputError
from evodesign.records import Objective, Sense
from tests.analysis.designs import MASS, REACH, TORQUE, design, designs_at, numbers

SENSES = st.sampled_from([(TORQUE, MASS), (TORQUE, REACH), (REACH, TORQUE, MASS)])

grid = st.integers(0, 12).map(lambda step: step / 4.0)

BOTH = (TORQUE, REACH)

whole = st.integers(0, 8).map(float)

points = st.lists(st.tuples(whole, whole), min_size=1, max_size=10)

CURVE = designs_at(BOTH, [(5.0, 1.0), (6.0, 1.4), (8.0, 1.7), (12.0, 1.8)])

coordinate = st.integers(0, 10).map(lambda step: step / 10.0)
rows = st.lists(st.tuples(coordinate, coordinate), min_size=2, max_size=9, unique=True)


def trade_off(start, other):
    """What is lost for what is gained by exchanging a design, after Rachmawati and Srinivasan."""
    lost = sum(max(0.0, b - a) for a, b in zip(start, other, strict=True))
    gained = sum(max(0.0, a - b) for a, b in zip(start, other, strict=True))
    return math.inf if gained == 0.0 else lost / gained


@given(st.data(), SENSES, st.sampled_from([0.0, 0.26, 0.5, 1.0]))
def test_a_knee_loses_more_than_it_gains_in_every_exchange_near_by(data, objectives, neighbourhood):
    points = data.draw(st.lists(st.tuples(*[grid] * len(objectives)), min_size=1, max_size=16))
    designs = front(objectives, designs_at(objectives, points))
    shares = scaled(objectives, designs).shares.tolist()
    found = set(numbers(knees(objectives, designs, neighbourhood)))
    for own, one in zip(shares, designs, strict=True):
        near = [
            trade_off(own, other)
            for other in shares
            if other != own and max(abs(a - b) for a, b in zip(own, other, strict=True)) <= neighbourhood
        ]
        if any(ratio < 1.0 - 1e-9 for ratio in near):
            assert one.number not in found
        if all(ratio > 1.0 + 1e-9 for ratio in near):
            assert one.number in found


def test_the_bulge_of_two_objectives_is_the_distance_from_the_line_through_the_ends():
    shares = np.array([[0.0, 1.0], [0.2, 0.3], [1.0, 0.0], [0.9, 0.8]])
    first, last = shares[0], shares[2]
    along = (last - first) / np.linalg.norm(last - first)
    expected = [along[0] * (first - point)[1] - along[1] * (first - point)[0] for point in shares]
    assert bulges(shares) == pytest.approx(expected)


def test_a_front_with_two_corners_shows_both_and_the_sharper_one_first():
    """A staircase: steep to (1, 5), level to (5, 4), steep to (6, 0)... in minimised torque and mass."""
    corners = [(0.0, 10.0), (1.0, 5.0), (6.0, 4.0), (7.0, 0.5), (10.0, 0.0)]
    points = [
        (start[0] + share * (end[0] - start[0]), start[1] + share * (end[1] - start[1]))
        for start, end in itertools.pairwise(corners)
        for share in (0.0, 0.2, 0.4, 0.6, 0.8)
    ] + [corners[-1]]
    designs = designs_at((TORQUE, MASS), points)
    found = knees((TORQUE, MASS), designs, 0.2)
    assert [tuple(each.assessment.objectives.values()) for each in found][:2] == [(1.0, 5.0), (7.0, 0.5)]
    assert numbers(knees((TORQUE, MASS), designs, 1.0)) == [5]


def test_units_and_senses_do_not_change_the_knees():
    points = [(0.0, 10.0), (1.0, 4.0), (3.0, 3.0), (5.0, 1.0), (10.0, 0.0)]
    plain = designs_at((TORQUE, MASS), points)
    turned = designs_at((TORQUE, REACH), [(1000.0 + 7.0 * a, -0.01 * b) for a, b in points])
    assert numbers(knees((TORQUE, MASS), plain)) == numbers(knees((TORQUE, REACH), turned))


def test_one_objective_has_one_knee_and_no_design_has_none():
    assert numbers(knees((TORQUE,), designs_at((TORQUE,), [(3.0,)]))) == [0]
    assert knees((TORQUE, MASS), []) == ()
    assert knees((TORQUE, MASS), [design(0, {"torque": 1.0, "mass": 1.0}, violation=0.1)]) == ()


def test_an_objective_in_which_all_agree_does_not_count():
    objectives = (TORQUE, MASS, Objective(name="peak", sense=Sense.MINIMISE, unit="1"))
    points = [(0.0, 10.0, 5.0), (1.0, 1.0, 5.0), (10.0, 0.0, 5.0)]
    assert numbers(knees(objectives, designs_at(objectives, points), 1.0)) == [1]


def test_noise_in_an_objective_does_not_count():
    objectives = (TORQUE, MASS, Objective(name="peak", sense=Sense.MINIMISE, unit="1"))
    points = [(0.0, 10.0, 6.72), (1.0, 1.0, 6.720001), (10.0, 0.0, 6.719999), (9.0, 9.0, 6.719998)]
    assert numbers(knees(objectives, designs_at(objectives, points), 1.0)) == [1]


def achievement(designs, hoped, one):
    """The achievement function, written out for torque (less is better) and reach (more is better)."""
    torques = [each.assessment.objectives["torque"] for each in designs]
    reaches = [each.assessment.objectives["reach"] for each in designs]
    torque_range = (max(torques) - min(torques)) or float("inf")
    reach_range = (max(reaches) - min(reaches)) or float("inf")
    torque, reach = one.assessment.objectives["torque"], one.assessment.objectives["reach"]
    shortfall = [0.0]
    if "torque" in hoped:
        shortfall.append((torque - hoped["torque"]) / torque_range)
    if "reach" in hoped:
        shortfall.append((hoped["reach"] - reach) / reach_range)
    total = (torque - min(torques)) / torque_range + (max(reaches) - reach) / reach_range
    return max(shortfall) + AUGMENTATION * total


@given(points, st.dictionaries(st.sampled_from(["torque", "reach"]), whole, min_size=1))
def test_designs_come_in_the_order_of_their_achievement(places, hoped):
    designs = designs_at(BOTH, places)
    found = [achievement(designs, hoped, one) for one in closest(BOTH, designs, hoped)]
    assert len(found) == len(designs)
    assert all(a <= b + 1e-12 for a, b in itertools.pairwise(found))


@given(points, st.dictionaries(st.sampled_from(["torque", "reach"]), whole, min_size=1))
def test_the_closest_design_is_beaten_by_none(places, hoped):
    designs = designs_at(BOTH, places)
    first = closest(BOTH, designs, hoped)[0].assessment.objectives
    assert first in [one.assessment.objectives for one in front(BOTH, designs)]


def test_a_hope_that_is_a_design_of_the_front_finds_that_design():
    for one in CURVE:
        assert closest(BOTH, CURVE, one.assessment.objectives)[0] is one


def test_what_nobody_names_counts_among_designs_that_are_good_enough():
    assert numbers(closest(BOTH, CURVE, {"reach": 1.5}))[:2] == [2, 3]
    assert numbers(closest(BOTH, CURVE, {"reach": 1.75}))[0] == 3
    assert numbers(closest(BOTH, CURVE, {"torque": 5.5}))[0] == 0


def test_a_hope_that_no_design_meets_is_missed_by_as_little_as_possible():
    assert numbers(closest(BOTH, CURVE, {"reach": 9.0}))[0] == 3
    assert numbers(closest(BOTH, CURVE, {"reach": 1.8, "torque": 5.0}))[0] == 2


def test_a_written_aspiration_is_read():
    assert aspiration_of(BOTH, "torque=8, reach = 1.5", "--near") == {"torque": 8.0, "reach": 1.5}


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("torqe=1", "wanted objectives among torque, reach, found 'torqe'; did you mean 'torque'"),
        ("torque", "wanted NAME=NUMBER"),
        ("torque=low", "wanted NAME=NUMBER"),
        ("", "wanted NAME=NUMBER"),
        ("torque=nan", "torque: wanted a finite number"),
    ],
)
def test_a_wrong_aspiration_is_refused_in_one_sentence(text, words):
    with pytest.raises(InputError, match=f"^--near: {words}"):
        aspiration_of(BOTH, text, "--near")


def test_an_empty_aspiration_is_refused():
    with pytest.raises(InputError, match="values of some of torque, reach, found none"):
        closest(BOTH, [], {})


def test_without_feasible_designs_none_is_closest():
    assert closest(BOTH, [design(0, {"torque": 1.0, "reach": 1.0}, violation=1.0)], {"reach": 1.0}) == ()


def least_distance(rows):
    return min(math.dist(a, b) for a, b in itertools.combinations(rows, 2))


@given(rows, st.integers(2, 5))
def test_the_least_distance_is_at_least_half_of_the_best_possible(rows, count):
    count = min(count, len(rows))
    chosen = [rows[row] for row in spread_out(np.array(rows), count)]
    best = max(least_distance(choice) for choice in itertools.combinations(rows, count))
    assert len(chosen) == count
    assert least_distance(chosen) >= best / 2.0 - 1e-12


@given(rows)
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
