from __future__ import annotations

import itertools
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import chi2

from evodesign.analysis.front import front
from evodesign.analysis.seed_statistics import attainment_surfaces, rank_tests
from tests.analysis.designs import MASS, REACH, TORQUE, designs_at

whole = st.integers(0, 6).map(float)
runs = st.lists(st.lists(st.tuples(whole, whole), max_size=5), min_size=1, max_size=5)
PAIR = (TORQUE, REACH)

different = st.lists(st.integers(-1000, 1000).map(float), min_size=8, max_size=11, unique=True)


def attains(corners, place):
    """Whether some corner is nowhere worse than a place: less torque, more reach."""
    return any(torque <= place[0] and reach >= place[1] for torque, reach in corners)


@given(runs)
def test_a_surface_bounds_what_its_share_of_the_runs_attains(places):
    designs = [designs_at(PAIR, points) for points in places]
    surfaces = attainment_surfaces(PAIR, [front(PAIR, run) for run in designs])
    shares = [surface.share for surface in surfaces]
    assert shares == sorted(set(shares))
    for surface in surfaces:
        for torque in range(8):
            for reach in range(-1, 7):
                count = sum(attains(points, (torque, reach)) for points in places)
                expected = count >= surface.share * len(places) - 1e-9
                assert attains(surface.corners, (torque, reach)) == expected


def test_levels_are_one_run_half_of_them_and_all():
    run = designs_at(PAIR, [(1.0, 1.0)])
    assert [surface.share for surface in attainment_surfaces(PAIR, [run] * 4)] == [0.25, 0.5, 1.0]
    assert [surface.share for surface in attainment_surfaces(PAIR, [run])] == [1.0]
    assert [surface.share for surface in attainment_surfaces(PAIR, [run, run, []])] == [1 / 3, 2 / 3]
    assert attainment_surfaces(PAIR, [[], []]) == ()


def test_the_front_of_all_objectives_is_enough_for_two_of_them():
    three = (TORQUE, REACH, MASS)
    points = [(1.0, 1.0, 9.0), (2.0, 1.0, 1.0), (3.0, 2.0, 5.0), (3.0, 1.5, 5.0), (0.5, 0.2, 9.5)]
    run = designs_at(three, points)
    assert attainment_surfaces(PAIR, [front(three, run)]) == attainment_surfaces(PAIR, [run])


def exact_p(first, second):
    """Two-sided p by going through every way to deal the ranks out."""
    everything = [*first, *second]

    def u(chosen):
        others = [value for value in everything if value not in chosen]
        return sum(a > b for a in chosen for b in others)

    middle = len(first) * len(second) / 2.0
    far = abs(u(list(first)) - middle)
    ways = list(itertools.combinations(everything, len(first)))
    return sum(abs(u(list(way)) - middle) >= far for way in ways) / len(ways)


@given(different)
def test_p_of_two_searches_is_that_of_all_permutations(figures):
    first, second = figures[:4], figures[4:]
    (found,) = rank_tests({"a": first, "b": second})
    assert found.name == "Mann-Whitney U, two-sided, exact"
    assert found.p == pytest.approx(exact_p(first, second))
    pairs = list(itertools.product(first, second))
    assert found.effect == pytest.approx(sum(a > b for a, b in pairs) / len(pairs))


def test_a_clear_difference_is_found_and_named():
    (found,) = rank_tests({"a": [1.0, 2.0, 3.0, 4.0], "b": [5.0, 6.0, 7.0, 8.0]})
    assert found.p == pytest.approx(2.0 / 70.0)
    assert found.finding == "b is better"
    (unclear,) = rank_tests({"a": [1.0, 3.0, 5.0, 7.0], "b": [2.0, 4.0, 6.0, 8.0]})
    assert unclear.finding == "no difference is shown"


@pytest.mark.parametrize(("first", "second", "needed"), [(1, 1, 4), (3, 3, 4), (1, 9, 4), (2, 4, 4)])
def test_too_few_seeds_are_not_tested_and_the_reason_says_how_many_it_takes(first, second, needed):
    figures = [float(number) for number in range(first + second)]
    (found,) = rank_tests({"a": figures[:first], "b": figures[first:]})
    assert found.p is None
    least = 2.0 / math.comb(first + second, first)
    assert f"p cannot fall below {min(least, 1.0):.2g}" in found.reason
    assert f"{needed} seeds each are needed" in found.finding


def test_with_three_searches_it_takes_more_seeds():
    samples = {name: [float(10 * place + seed) for seed in range(4)] for place, name in enumerate("abc")}
    assert all(found.p is None for found in rank_tests(samples))
    samples = {name: [float(10 * place + seed) for seed in range(5)] for place, name in enumerate("abc")}
    overall, *pairs = rank_tests(samples)
    assert overall.samples == ("a", "b", "c")
    assert overall.finding == "they differ"
    assert [pair.p for pair in pairs] == pytest.approx([3 * 2.0 / 252.0] * 3)
    assert all("Holm" in pair.name for pair in pairs)


def test_kruskal_and_wallis_by_their_formula():
    samples = {
        "a": [1.0, 2.0, 9.0, 4.0, 5.0],
        "b": [6.0, 7.0, 8.0, 3.0, 10.0],
        "c": [11.0, 12.0, 13.0, 14.0, 15.0],
    }
    ranks = {name: sum(figures) for name, figures in samples.items()}
    h = 12.0 / (15 * 16) * sum(total**2 / 5 for total in ranks.values()) - 3 * 16
    assert rank_tests(samples)[0].p == pytest.approx(chi2.sf(h, 2))


def test_holm_raises_the_least_p_most_and_never_falls():
    samples = {
        "a": [float(number) for number in range(6)],
        "b": [number + 2.5 for number in range(6)],
        "c": [number + 30.0 for number in range(6)],
    }
    alone = [
        rank_tests({one: samples[one], two: samples[two]})[0].p
        for one, two in itertools.combinations(samples, 2)
    ]
    order = sorted(range(3), key=alone.__getitem__)
    expected, highest = [0.0] * 3, 0.0
    for rank, place in enumerate(order):
        highest = max(highest, alone[place] * (3 - rank))
        expected[place] = min(highest, 1.0)
    assert [found.p for found in rank_tests(samples)[1:]] == pytest.approx(expected)


def test_equal_figures_use_the_approximation_or_nothing():
    tied, equal = [1.0, 1.0, 2.0, 3.0, 4.0], [1.0] * 5
    assert "normal approximation" in rank_tests({"a": tied, "b": [5.0, 6.0, 7.0, 8.0, 9.0]})[0].name
    assert rank_tests({"a": equal, "b": equal})[0].finding == "not tested: all figures are equal"
    assert rank_tests({"a": equal, "b": equal, "c": equal})[0].p is None


def test_one_search_has_nothing_to_be_tested_against():
    assert rank_tests({"a": [1.0, 2.0]}) == ()
