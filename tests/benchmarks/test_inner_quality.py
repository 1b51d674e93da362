"""Costs hardly depend on the starting point: twenty designs at four heights against 25 random starts each."""

from __future__ import annotations

import joblib
import pytest

from benchmarks.inner_problem import (
    DEFAULT,
    HEIGHTS,
    VARIANTS,
    Design,
    known_at,
    problem_at,
    problem_named,
    random_designs,
)
from benchmarks.inner_quality import Ends, Judge, Row, judge_of, reach_summary, summary
from evodesign.posture.postures import Symmetry
from evodesign.posture.precompute.precomputed import Precomputed

DESIGNS = 20


def held(first: int, designs: list[Design]) -> list[Row]:
    """The heights that some designs reach, numbered from `first`."""
    judge = judge_of(DEFAULT, 25)
    return [row for number, design in enumerate(designs, first) for row in judge.held(number, design)]


@pytest.mark.slow
@pytest.mark.usefixtures("known")
def test_reachable_heights_are_solved_and_about_as_good_as_the_best_of_many_starts() -> None:
    problem = problem_at(HEIGHTS)
    known_at(problem, 2)
    designs = random_designs(problem, DESIGNS)
    halves = (joblib.delayed(held)(first, designs[first : first + 10]) for first in (0, 10))
    figures = summary([row for part in joblib.Parallel(2)(halves) for row in part])
    assert figures["reachable_heights"] > 2.5 * DESIGNS
    assert figures["solved_share"] >= 0.995
    assert figures["within_1_percent_share"] >= 0.99


def test_random_starts_are_solved_with_the_bodies_apart_that_the_problem_keeps_apart() -> None:
    problem = problem_named("problems/icub_lifting.toml")
    near = {("robot", ""): (("chest", "l_upper_arm"),), ("human", ""): (("T8", "LeftUpperArm"),)}
    judge = Judge(problem, Precomputed(meetings=near), 1)
    assert len(judge.scenes) == 2
    for scene in judge.scenes:
        assert all(agent.collisions and agent.collisions.parted for agent in scene.agents)


@pytest.mark.parametrize("variant", [name for name in VARIANTS if name != DEFAULT])
def test_variants_of_the_default_problem_are_solved_whole(variant: str) -> None:
    assert problem_at(HEIGHTS, variant).symmetry is Symmetry.OFF


def test_a_posture_counts_as_good_within_1_percent_of_the_best_start() -> None:
    costs = (1.009, 1.011, 0.5)
    rows = [Row(1.0, "solved", cost, cost, 1.0, float("nan")) for cost in costs]
    figures = summary([*rows, Row(1.0, "infeasible", float("inf"), float("inf"), 1.0, float("nan"))])
    assert figures["solved_share"] == 0.75
    assert figures["within_1_percent_share"] == pytest.approx(2.0 / 3.0)
    assert figures["worst_excess_over_best"] == pytest.approx(0.011)


def test_reach_falls_short_where_a_random_start_holds_the_load_higher_or_lower() -> None:
    figures = reach_summary([Ends(0.5, 1.5, 0.499, 1.52), Ends(0.5, 1.5, 0.6, 1.4)])
    assert figures["lowest_within_5_mm_share"] == 1.0
    assert figures["highest_within_5_mm_share"] == 0.5
    assert figures["worst_lowest_short_m"] == pytest.approx(0.001)
    assert figures["worst_highest_short_m"] == pytest.approx(0.02)
