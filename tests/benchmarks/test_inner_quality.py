"""Costs hardly depend on the starting point: twenty designs at four heights against 25 random starts each."""

from __future__ import annotations

import joblib
import pytest

from benchmarks.inner_problem import HEIGHTS, known_at, problem_at, random_designs
from benchmarks.inner_quality import judge, summary

DESIGNS = 20


@pytest.mark.slow
@pytest.mark.usefixtures("known")
def test_reachable_heights_are_solved_and_about_as_good_as_the_best_of_many_starts() -> None:
    problem = problem_at(HEIGHTS)
    known_at(problem, 2)
    designs = random_designs(problem, DESIGNS)
    halves = (joblib.delayed(judge)(first, designs[first : first + 10], 0, 25) for first in (0, 10))
    figures = summary([row for part in joblib.Parallel(2)(halves) for row in part])
    assert figures["reachable_heights"] > 2.5 * DESIGNS
    assert figures["solved_share"] >= 0.995
    assert figures["within_1_percent_share"] >= 0.99
