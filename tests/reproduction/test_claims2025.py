"""Verdicts on the robots of 2025, on figures of which the answer is known."""

from __future__ import annotations

from dataclasses import replace

import pytest

from evodesign.reproduction.claims2022 import TorqueNorms
from evodesign.reproduction.claims2025 import (
    BY_COST,
    BY_FRONT,
    ErgonomicRobot,
    change,
    cost_claim,
    front_claim,
    human_claim,
    reach_claim,
    robot_claim,
)

HEIGHTS = (0.8, 1.0, 1.2, 1.5)


def robot(
    human: float, own: float, held: int = 4, highest: float = 1.6, cost: float = 100.0
) -> ErgonomicRobot:
    norms = {height: TorqueNorms(own, human, 10.0 * human) for height in HEIGHTS[:held]}
    return ErgonomicRobot(58.6, highest, cost, {"somebody": norms})


def robots(b: ErgonomicRobot, c: ErgonomicRobot) -> dict[str, ErgonomicRobot]:
    """With A and the iCub, beside which a person needs 100 and 80 N m."""
    return {"iCub": robot(80.0, 5.0, 3, 1.38), "A": robot(100.0, 10.0, 3, 1.4), "B": b, "C": c}


def test_a_change_is_of_the_means_over_the_heights_that_both_hold() -> None:
    before = {0.8: TorqueNorms(1.0, 10.0), 1.0: TorqueNorms(1.0, 30.0), 1.2: TorqueNorms(1.0, 500.0)}
    after = {0.8: TorqueNorms(1.0, 20.0), 1.0: TorqueNorms(1.0, 10.0), 1.5: TorqueNorms(1.0, 7.0)}
    assert change(before, after, "human") == pytest.approx(30.0 / 40.0 - 1.0)
    assert change(before, {1.5: after[1.5]}, "human") is None


def test_torques_count_as_lower_from_two_hundredths_beside_both_robots() -> None:
    lower = robots(robot(97.0, 9.0), robot(90.0, 9.7))
    assert human_claim(lower, "somebody").reproduced
    assert human_claim(lower, "somebody").found == "-3.0%, -10.0% against A"
    assert "+21.2%, +12.5% against the iCub" in human_claim(lower, "somebody").reason
    assert "L5/S1 -3.0%, -10.0%" in human_claim(lower, "somebody").reason
    assert robot_claim(lower, "somebody").found == "-10.0%, -3.0% against A"
    assert robot_claim(lower, "somebody").reproduced
    assert not human_claim(robots(robot(99.0, 9.0), robot(90.0, 9.0)), "somebody").reproduced
    none = human_claim(robots(robot(90.0, 9.0, held=0), robot(90.0, 9.0)), "somebody")
    assert (none.reproduced, none.found) == (False, "-, -10.0% against A")


def test_a_reach_is_reproduced_with_all_heights_and_above_the_robots_before() -> None:
    whole = robots(robot(90.0, 9.0, highest=1.55), robot(90.0, 9.0, highest=1.7))
    claim = reach_claim(whole, HEIGHTS)
    assert claim.reproduced
    assert claim.found == "A 1.400, iCub 1.380, B 1.550, C 1.700 m"
    assert claim.reason == "A and iCub cannot hold the load at 1.5 m"
    assert not reach_claim({**whole, "C": robot(90.0, 9.0, highest=1.39)}, HEIGHTS).reproduced
    assert reach_claim({**whole, "C": robot(90.0, 9.0, held=3)}, HEIGHTS).reason == "C lack a height"


def test_a_cost_is_least_where_no_design_of_the_search_is_lower_by_two_hundredths() -> None:
    both = robots(robot(90.0, 9.0, cost=100.0), replace(robot(90.0, 9.0), cost=None))
    both[BY_COST] = robot(90.0, 9.0, cost=98.5)
    claim = cost_claim(both, [98.5, 140.0])
    assert claim.reproduced
    assert (claim.found, claim.reason) == (
        "B 100.00, C -, by_cost 98.50",
        "2 feasible designs of our search cost 98.50 to 140.00 (N m)^2",
    )
    assert not cost_claim(both, [97.0, 98.5]).reproduced
    assert not cost_claim(robots(robot(90.0, 9.0), robot(90.0, 9.0)), []).reproduced


def test_a_robot_is_not_dominated_where_no_design_of_the_front_dominates_it() -> None:
    whole = {**robots(robot(90.0, 9.0), robot(80.0, 10.0)), BY_FRONT: robot(90.0, 8.1)}
    claim = front_claim(whole, {"B": 0, "C": 0}, 40)
    assert claim.reproduced
    assert claim.found == "B by 0, C by 0 of 40 designs"
    assert "robot torque of its shown robot -10.0%, -19.0%" in claim.reason
    assert claim.reason.endswith("human torque +0.0%, +12.5%")
    assert not front_claim(whole, {"B": 3, "C": 0}, 40).reproduced
    assert not front_claim(robots(robot(90.0, 9.0), robot(80.0, 9.0)), {"B": 0, "C": 0}, 0).reproduced
