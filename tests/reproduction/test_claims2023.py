"""Verdicts on the sequel's claims, on figures of which the answer is known."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evodesign.reproduction.claims2023 import (
    FAILED,
    LOGGED,
    RobotFigures,
    SearchFigures,
    failure_claim,
    gain_claim,
    log_claim,
    order_claim,
    rank_correlation,
    robot_claim,
    search_claim,
)

SEARCH = SearchFigures(480, 4, 1.1, 1, 5, 17, 40.0, 48.0)


def robot(name: str, cost: float | None, robot_torque: float = 10.0, held: int = 27) -> RobotFigures:
    return RobotFigures(name, cost, robot_torque, 10.0, 58.0, 1.4, held, 27)


def test_its_own_figures_confirm_its_log_and_its_order() -> None:
    own = {name: robot(name, 100.0 / fitness) for name, fitness in LOGGED.items()}
    assert log_claim(own).reproduced
    assert order_claim(own).reproduced
    assert order_claim(own).found == "rank correlation +1.00"
    assert log_claim(own).found == "535.0 to 591.5 N m"


def test_low_torques_in_another_order_are_not_its_own() -> None:
    other = {name: robot(name, fitness) for name, fitness in LOGGED.items()}
    assert not log_claim(other).reproduced
    assert order_claim(other).found == "rank correlation -1.00"
    assert not order_claim(other).reproduced
    assert "11% less fit" in order_claim(other).reason
    none = {name: robot(name, None, held=3) for name in LOGGED}
    assert (log_claim(none).found, order_claim(none).found) == ("no posture", "too few postures")
    one_lost = {
        **{name: robot(name, 100.0 / fitness) for name, fitness in LOGGED.items()},
        "log_1": none["log_1"],
    }
    assert not log_claim(one_lost).reproduced


@given(st.lists(st.tuples(st.floats(-1e3, 1e3), st.floats(-1e3, 1e3)), min_size=3, max_size=12))
def test_rank_correlation_is_the_classical_formula_of_squared_differences_of_ranks(
    pairs: list[tuple[float, float]],
) -> None:
    one, other = ([*column] for column in zip(*pairs, strict=True))
    if len(set(one)) < len(one) or len(set(other)) < len(other):
        return
    squares = sum(
        (sorted(one).index(a) - sorted(other).index(b)) ** 2 for a, b in zip(one, other, strict=True)
    )
    count = len(one)
    assert rank_correlation(one, other) == pytest.approx(1.0 - 6.0 * squares / (count * (count**2 - 1)))


def test_ga_improves_on_nl_only_with_less_of_both() -> None:
    nl = robot("nl", 50.0, 12.0)
    assert robot_claim({"nl": nl, "ga": robot("ga", 49.0, 12.0)}).reproduced
    assert not robot_claim({"nl": nl, "ga": robot("ga", 49.0, 13.0)}).reproduced
    worse = robot_claim({"nl": nl, "ga": robot("ga", 51.0, 9.0)})
    assert not worse.reproduced
    assert worse.found == "its sum of torques +2.0%, robot torque -25%"
    assert robot_claim({"nl": nl, "ga": robot("ga", None)}).found == "-"


def test_a_gain_is_that_of_the_fitness_over_the_unscaled_robots() -> None:
    claim = gain_claim({"unscaled": robot("unscaled", 42.08)}, SEARCH)
    assert (claim.found, claim.reproduced) == ("+5.2%", True)
    small = gain_claim({"unscaled": robot("unscaled", 41.0)}, SEARCH)
    assert (small.found, small.reproduced) == ("+2.5%", False)
    assert small.reason.endswith("40.0 to 48.0 N m")
    none = replace(SEARCH, least=None, most=None)
    assert gain_claim({"unscaled": robot("unscaled", 41.0)}, none).found == "-"


def test_designs_that_it_gave_up_are_counted_by_the_loads_that_they_hold() -> None:
    held = {name: robot(name, 45.0) for name in FAILED}
    claim = failure_claim(held, SEARCH)
    assert (claim.found, claim.reproduced) == ("0 of its 4, 4 of our 480", False)
    assert failure_claim({**held, FAILED[0]: robot(FAILED[0], None, held=26)}, SEARCH).reproduced


def test_a_search_is_as_good_when_it_reaches_ga_with_no_more_evaluations() -> None:
    claim = search_claim(SEARCH)
    assert claim.reproduced
    assert claim.found == "480 evaluations in 1.1 min with 1 worker"
    assert (
        claim.reason
        == "as good as GA by its fitness after 5 evaluations, with less robot torque, too, after 17"
    )
    assert not search_claim(replace(SEARCH, reached=None)).reproduced
    assert not search_claim(replace(SEARCH, evaluations=2885)).reproduced
    assert search_claim(replace(SEARCH, dominated=None)).reason.endswith("none with less robot torque, too")
