"""Shares of the load that its balance allows, against the lever rule."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evodesign.mechanics.agent import HUMAN, ROBOT
from evodesign.mechanics.balance import GRAVITY
from evodesign.mechanics.load_share import share_interval
from evodesign.mechanics.payload import Grasp, Payload
from evodesign.mechanics.scene import Scene
from evodesign.problem.build import DesignProblem

BOX = (0.5, 0.5, 0.1)


@pytest.fixture(scope="module")
def scene(problem: DesignProblem) -> Scene:
    return problem.scene


def lever_rule(scene: Scene, payload: Payload, moment: float) -> tuple[float, float]:
    """Moments about y of a load on two pairs of hands, whose moments and push take a little more or less.

    s x_r + (1 - s) x_h = c + (4 m + X (z_r - z_h)) / m g
    """
    points = {agent.name: payload.grasp_point(agent, agent.hands[0]) for agent in scene.agents}
    x_robot, x_human = points[ROBOT][0], -points[HUMAN][0]
    weight = payload.mass * GRAVITY
    spare = (4.0 * moment + scene.stance.push * abs(points[ROBOT][2] - points[HUMAN][2])) / weight
    middle, half = x_human - payload.center_of_mass[0], spare / (x_human - x_robot)
    return middle / (x_human - x_robot) - half, middle / (x_human - x_robot) + half


def test_point_grasps_leave_half_of_a_centred_load(scene: Scene) -> None:
    assert share_interval(replace(scene, payload=Payload(BOX, 5.0))) == pytest.approx((0.5, 0.5), abs=1e-9)


@given(
    offset=st.floats(-0.2, 0.2),
    moment=st.floats(0.0, 8.0),
    mass=st.floats(2.0, 20.0),
    lift=st.floats(-0.05, 0.05),
)
def test_shares_are_those_of_the_lever_rule(
    scene: Scene, offset: float, moment: float, mass: float, lift: float
) -> None:
    points = {
        (ROBOT, "left_hand"): (-0.25, 0.2, lift),
        (ROBOT, "right_hand"): (-0.25, -0.2, lift),
        (HUMAN, "left_hand"): (0.2, -0.2, 0.0),
        (HUMAN, "right_hand"): (0.2, 0.2, 0.0),
    }
    payload = Payload(BOX, mass, (offset, 0.0, 0.0), Grasp.RIGID, moment, points)
    found = share_interval(replace(scene, payload=payload))
    assert found == pytest.approx(lever_rule(scene, payload, moment), abs=1e-6)


def test_hands_that_transmit_any_moment_leave_every_share(scene: Scene) -> None:
    low, high = share_interval(replace(scene, payload=Payload(BOX, 5.0, grasp=Grasp.RIGID)))
    assert low < 0.0
    assert high > 1.0


def test_loads_that_no_hands_can_balance_have_no_share(scene: Scene) -> None:
    """Four points on one line transmit no moment about it."""
    points = {
        (agent, f"{side}_hand"): (0.0, y, 0.0)
        for agent in (ROBOT, HUMAN)
        for side, y in (("left", 0.2), ("right", -0.2))
    }
    payload = Payload(BOX, 5.0, (0.1, 0.0, 0.0), grasp_points=points)
    low, high = share_interval(replace(scene, payload=payload))
    assert high < low
