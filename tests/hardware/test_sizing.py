"""Sizes that meet their demand: the fixed point against a root found by bisection."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
import pytest

from evodesign.hardware.actuators import actuator_law
from evodesign.hardware.sizing import ROUNDS, Sizes, Sizing, SizingRounds
from evodesign.records import Status


def sized(
    demand: Callable[[Sizes], Sizes | None],
    start: Sizes,
    margins: Sizes,
    bounds: dict[str, tuple[float, float]],
) -> Sizing:
    rounds = SizingRounds(start, margins, bounds)
    while True:
        found = rounds.ended_by(demand(rounds.sizes))
        if found is not None:
            return found


WIDE = {"elbow": (0.1, 500.0), "shoulder": (0.1, 500.0)}


def arm(sizes: Mapping[str, float]) -> dict[str, float]:
    """Torques of a straight arm that holds 5 kg, each actuator with its mass where it is [N m]."""
    elbow = float(actuator_law().at(sizes["elbow"]).mass)
    return {"elbow": 9.81 * 0.3 * 5.0, "shoulder": 9.81 * (0.6 * 5.0 + 0.3 * elbow)}


def test_the_sizes_are_their_margin_times_the_demand() -> None:
    margins = {"elbow": 2.0, "shoulder": 3.0}
    found = sized(arm, {"elbow": 5.0, "shoulder": 5.0}, margins, WIDE)
    assert found.status is Status.SOLVED
    asked = arm(found.sizes)
    for name, size in found.sizes.items():
        assert size == pytest.approx(margins[name] * asked[name], rel=1e-4)
    assert found.rounds <= 4
    assert found.change <= 1e-4


def test_a_demand_that_grows_with_the_size_is_met_within_four_rounds() -> None:
    """Random demands a + b size^0.62 of slopes up to 0.1, whose fixed points bisection finds."""
    generator = np.random.default_rng(18)
    for _ in range(200):
        a, b, margin = generator.uniform(2, 60), generator.uniform(0.05, 1.5), generator.uniform(1, 4)
        low, high = 1e-3, 1e6
        for _ in range(200):
            middle = np.sqrt(low * high)
            low, high = (middle, high) if margin * (a + b * middle**0.62) > middle else (low, middle)
        if b * margin * 0.62 * low**-0.38 > 0.1:
            continue
        found = sized(
            lambda s, a=a, b=b: {"x": a + b * s["x"] ** 0.62}, {"x": 20.0}, {"x": margin}, {"x": (1e-3, 1e6)}
        )
        assert found.status is Status.SOLVED
        assert found.sizes["x"] == pytest.approx(low, rel=2e-4)


def test_a_demand_that_follows_its_size_closely_is_met_in_more_rounds() -> None:
    """size = 8 size^0.62 is met at 8^(1 / 0.38); each round leaves 0.62 of the error, which is not mixed."""
    found = sized(lambda s: {"x": 8.0 * s["x"] ** 0.62}, {"x": 200.0}, {"x": 1.0}, {"x": (0.1, 1e4)})
    assert found.status is Status.SOLVED
    assert found.rounds > 10
    assert found.sizes["x"] == pytest.approx(8.0 ** (1.0 / 0.38), rel=3e-4)


def test_a_demand_that_never_settles_says_so() -> None:
    found = sized(lambda s: {"x": 1.9 * s["x"]}, {"x": 1.0}, {"x": 1.0}, {"x": (0.1, 1e9)})
    assert found.status is Status.ITERATION_LIMIT
    assert f"{ROUNDS} rounds" in found.reason
    assert found.change > 0.1


def test_a_demand_that_is_not_known_ends_the_rounds() -> None:
    found = sized(lambda s: None, {"x": 1.0}, {"x": 1.0}, {"x": (0.1, 10.0)})
    assert (found.status, found.rounds) == (Status.INFEASIBLE, 1)


def test_sizes_stay_between_the_smallest_and_the_largest() -> None:
    found = sized(
        lambda s: {"x": 0.001, "y": 1e5},
        {"x": 1.0, "y": 1.0},
        {"x": 1.0, "y": 1.0},
        {"x": (0.5, 10.0), "y": (0.5, 10.0)},
    )
    assert found.sizes == {"x": 0.5, "y": 10.0}
    assert found.status is Status.SOLVED
