"""How far a search is: what its last doubling gained, and what experience says of the next one."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from benchmarks.growth import doublings, factors
from evodesign.analysis.growth import HIGH, LOW, MOST, USUAL, growth
from evodesign.records import Generation


def generations(volumes: Sequence[float | None], population: int = 10) -> list[Generation]:
    return [
        Generation(
            number=number,
            evaluations=population * (number + 1),
            feasible_share=1.0,
            hypervolume=volume,
            reference=None if volume is None else {"torque": 1.0},
            best={},
            seconds=1.0,
        )
        for number, volume in enumerate(volumes)
    ]


def test_growth_is_that_of_the_latter_half() -> None:
    found = growth(generations([8.0, 10.0, 10.5, 11.0]))
    assert found is not None
    assert (found.evaluations, found.last) == (40, pytest.approx(0.1))
    assert (found.low, found.expected, found.high) == pytest.approx((0.1 * LOW, 0.1 * USUAL, 0.1 * HIGH))
    assert found.sentence.startswith("the latter half of 40 evaluations made the hypervolume grow by 10.0%")


def test_between_generations_half_is_found_on_the_scale_of_doublings() -> None:
    """At 30 evaluations of 60, half way in logarithms between 20 and 45 evaluations."""
    some = generations([8.0, 10.0, 12.0])
    records = [some[1], *generations([12.0], population=45), *generations([13.2], population=60)]
    found = growth(records)
    assert found is not None
    assert found.last == pytest.approx(13.2 / 11.0 - 1.0)


@pytest.mark.parametrize("volumes", [[], [1.0], [None, None, None], [None, None, None, 1.0, 2.0], [0.0, 0.0]])
def test_without_half_of_the_evaluations_nothing_is_said(volumes: list[float | None]) -> None:
    assert growth(generations(volumes)) is None


def test_of_a_search_that_has_hardly_begun_nothing_is_said() -> None:
    assert growth(generations([2.0, 2.0, 2.9, 2.9])) is not None
    assert growth(generations([2.0, 2.0, 3.1, 3.1])) is None


def test_a_search_that_stands_still_is_expected_to_go_on_so() -> None:
    found = growth(generations([2.0, 2.0, 2.0, 2.0]))
    assert found is not None
    assert (found.last, found.expected, found.high) == (0.0, 0.0, 0.0)


def test_the_factors_are_those_of_the_stored_searches() -> None:
    measured = np.quantile(factors(), (0.1, 0.5, 0.9))
    assert measured == pytest.approx([LOW, USUAL, HIGH], abs=0.05)
    assert max(before for before, _ in doublings()) == pytest.approx(MOST, abs=0.05)
