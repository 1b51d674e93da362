"""Verdicts on the paper's claims, on robots of which the answer is known."""

from __future__ import annotations

import pytest

from evodesign.reproduction.claims2022 import (
    PAPER_OPTIMISED,
    PAPER_ORIGINAL,
    TorqueNorms,
    human_claim,
    reach_claim,
    reduction_claim,
    table_claim,
)


def test_the_papers_own_figures_confirm_all_its_claims() -> None:
    """Its 33 % is the ratio of 90.4 to 144.3, which is 37 % less."""
    own = (PAPER_ORIGINAL, PAPER_OPTIMISED)
    assert reach_claim("paper", *own).reproduced
    assert human_claim("paper", *own).reproduced
    assert table_claim("paper", *own, "").reproduced
    reduction = reduction_claim("paper", *own, 90.4088, 1)
    assert reduction.reproduced
    assert reduction.found == "144.27 to 90.41 N m: -37%"


def test_torques_far_below_the_table_are_not_the_tables() -> None:
    low = {height: TorqueNorms(0.1, 0.2) for height in PAPER_OPTIMISED}
    claim = table_claim("ours", {h: low[h] for h in PAPER_ORIGINAL}, low, "joint limits by up to 2 rad")
    assert not claim.reproduced
    assert claim.found == "human 0.2 to 0.2 N m"
    assert "joint limits by up to 2 rad" in claim.reason
    assert table_claim("ours", {}, {}, "").found == "no posture"


@pytest.mark.parametrize(
    ("original", "optimised", "reason"),
    [
        (
            (0.8, 1.0, 1.2, 1.5),
            (0.8, 1.0, 1.2, 1.5),
            "the original robot holds the load at 0.8, 1, 1.2, 1.5 m",
        ),
        ((0.8, 1.0, 1.2), (0.8, 1.0, 1.2), "no posture was found at 1.5 m"),
        ((), (0.8,), "the original robot holds the load at no height"),
    ],
)
def test_reach_is_not_reproduced_when_a_height_is_missing_or_too_many(
    original: tuple[float, ...], optimised: tuple[float, ...], reason: str
) -> None:
    still = TorqueNorms(1.0, 1.0)
    claim = reach_claim("ours", dict.fromkeys(original, still), dict.fromkeys(optimised, still))
    assert not claim.reproduced
    assert claim.reason == reason


def test_a_smaller_fall_is_not_the_third_and_the_best_of_all_is_named() -> None:
    claim = reduction_claim("ours", {1.0: TorqueNorms(10.0, 1.0)}, {1.0: TorqueNorms(8.0, 1.0)}, 5.0, 70)
    assert not claim.reproduced
    assert claim.found == "10.00 to 8.00 N m: -20%"
    assert claim.reason.endswith("the largest fall of all 70 robots that were found is 50%")
    assert reduction_claim(
        "ours", {1.0: TorqueNorms(10.0, 1.0)}, {1.0: TorqueNorms(6.6, 1.0)}, 6.6, 1
    ).reproduced
    assert reduction_claim("ours", {}, {}, 1.0, 0).reason == "the original robot has no posture at 1 m"


def test_higher_human_torque_is_not_preserved() -> None:
    before = {0.8: TorqueNorms(1.0, 10.0), 1.0: TorqueNorms(1.0, 10.0)}
    assert human_claim("ours", before, {0.8: TorqueNorms(1.0, 5.0), 1.0: TorqueNorms(1.0, 10.9)}).reproduced
    claim = human_claim("ours", before, {0.8: TorqueNorms(1.0, 5.0), 1.0: TorqueNorms(1.0, 11.1)})
    assert not claim.reproduced
    assert claim.found == "-50% to +11%"
    assert not human_claim("ours", before, {}).reproduced
