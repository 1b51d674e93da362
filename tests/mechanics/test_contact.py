"""A foot's margins against corner forces: what four corners can push is what the margins allow."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from evodesign.mechanics.contact import Ground, SoleSize, foot_margins

SOLE = SoleSize(0.24, 0.10)
CORNERS = np.array([[x, y, 0.0] for x in (-0.12, 0.12) for y in (-0.05, 0.05)])


@given(st.lists(st.floats(0.0, 500.0), min_size=4, max_size=4))
def test_corners_that_only_push_keep_every_margin(pushes: list[float]) -> None:
    force = np.array([0.0, 0.0, sum(pushes)])
    moment = sum((np.cross(c, [0.0, 0.0, f]) for c, f in zip(CORNERS, pushes, strict=True)), np.zeros(3))
    assert min(foot_margins(np.concatenate([force, moment]), SOLE, Ground())) >= -1e-9


@given(st.floats(-0.2, 0.2), st.floats(-0.1, 0.1), st.floats(1.0, 1000.0))
def test_centre_of_pressure_outside_the_sole_breaks_a_margin(x: float, y: float, push: float) -> None:
    assume(abs(abs(x) - 0.12) > 1e-6 and abs(abs(y) - 0.05) > 1e-6)
    moment = np.cross([x, y, 0.0], [0.0, 0.0, push])
    holds = min(foot_margins(np.concatenate([[0.0, 0.0, push], moment]), SOLE, Ground())) >= 0.0
    assert holds == (abs(x) < 0.12 and abs(y) < 0.05)


@given(st.floats(0.0, 2.0 * math.pi), st.floats(0.0, 600.0), st.floats(1.0, 1000.0))
def test_friction_pyramid_lies_inside_the_cone(angle: float, side: float, push: float) -> None:
    ground = Ground(friction=0.5)
    wrench = np.array([side * math.cos(angle), side * math.sin(angle), push, 0.0, 0.0, 0.0])
    if min(foot_margins(wrench, SOLE, ground)) >= 0.0:
        assert side <= 0.5 * push * (1.0 + 1e-12)
    if side <= 0.5 / math.sqrt(2.0) * push:
        assert min(foot_margins(wrench, SOLE, ground)) >= -1e-9


@pytest.mark.parametrize(
    "wrench", [[0, 0, -1, 0, 0, 0], [0, 0, 100, 0, 0, 3], [0, 0, 5, 0, 0, 0]], ids=["pull", "twist", "light"]
)
def test_pulling_twisting_and_too_light_feet_break_a_margin(wrench: list[float]) -> None:
    assert min(foot_margins(wrench, SOLE, Ground(least_force=10.0))) < 0.0
