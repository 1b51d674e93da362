"""Footsteps, swings and the pendulum above them, against integration and differences."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from evodesign.control.footsteps import Gait, progress, swing
from evodesign.control.pendulum import pendulum_course

RATE = 3.6
TIMES = (0.0, 0.6, 1.2, 1.7, 1.9, 2.4, 2.7, 4.0)
LEFT, RIGHT, NEXT = (0.0, 0.1), (0.02, -0.1), (0.2, 0.1)
PRESSURES = np.array([(0.0, 0.0), (0.0, 0.0), RIGHT, RIGHT, NEXT, NEXT, (0.2, 0.0), (0.2, 0.0)])


def test_the_pendulum_is_that_of_its_equations_integrated() -> None:
    """The capture point backwards from its rest, the centre of mass forwards after it: both are stable so."""
    course = pendulum_course(RATE, TIMES, PRESSURES)
    end = TIMES[-1]

    def pressure(time: float) -> np.ndarray:
        return np.array([np.interp(time, TIMES, course.pressures[:, axis]) for axis in (0, 1)])

    exact = {"rtol": 1e-10, "atol": 1e-12, "dense_output": True, "max_step": 0.02}
    back = solve_ivp(
        lambda past, capture: -RATE * (capture - pressure(end - past)), (0.0, end), PRESSURES[-1], **exact
    )
    ahead = solve_ivp(
        lambda time, center: RATE * (back.sol(end - time) - center), (0.0, end), (0, 0), **exact
    )
    for time in np.linspace(0.0, end, 37):
        center, velocity, acceleration, point = course.at(time)
        capture = back.sol(end - time)
        assert center == pytest.approx(ahead.sol(time), abs=1e-6)
        assert center + velocity / RATE == pytest.approx(capture, abs=1e-6)
        assert acceleration == pytest.approx(RATE**2 * (center - pressure(time)), abs=1e-5)
        assert point == pytest.approx(pressure(time), abs=1e-9)


def test_the_pendulum_rests_above_its_pressure_point_at_both_ends() -> None:
    course = pendulum_course(RATE, TIMES, PRESSURES)
    for time, slow in ((0.0, 1e-12), (TIMES[-1], 5e-3)):  # it comes to rest like e^(-w t)
        center, velocity, _, point = course.at(time)
        assert center == pytest.approx(point, abs=slow)
        assert np.linalg.norm(velocity) <= RATE * slow
    assert course.pressures[1][1] > 0.0, "it pushes itself off from the foot that will swing"
    assert np.delete(course.pressures, 1, 0) == pytest.approx(np.delete(PRESSURES, 1, 0))


def test_a_swing_foot_leaves_and_lands_at_rest_and_moves_as_its_derivatives_say() -> None:
    gait, start, end = Gait.of(0.8), np.array([0.1, 0.2, 0.0]), np.array([0.5, 0.1, 0.0])
    for time, place in ((0.0, start), (gait.swinging, end)):
        moved = swing(start, end, gait, time)
        assert moved[0] == pytest.approx(place, abs=1e-12)
        assert moved[1] == pytest.approx(np.zeros(3), abs=1e-12)
    step = 1e-5
    for time in np.linspace(0.03, 0.97, 18) * gait.swinging:
        (before, slow, _), now, (after, fast, _) = (
            swing(start, end, gait, time + each) for each in (-step, 0.0, step)
        )
        assert now[1] == pytest.approx((after - before) / (2.0 * step), abs=1e-6)
        assert now[2] == pytest.approx((fast - slow) / (2.0 * step), abs=1e-6)
        assert now[0][2] > 0.0
    assert swing(start, end, gait, gait.swinging / 2.0)[0][2] == pytest.approx(gait.lift)


def test_steps_are_those_of_bodies_of_like_build() -> None:
    short, long = Gait.of(0.4), Gait.of(0.9)
    assert long.length / short.length == pytest.approx(0.9 / 0.4)
    assert (long.seconds / short.seconds) ** 2 == pytest.approx(0.9 / 0.4)


def test_feet_that_pass_go_two_lengths_and_feet_side_by_side_follow_each_other() -> None:
    assert progress(0.5, 0.2, passing=True) == pytest.approx([1 / 6, 2 / 6, 0.5, 0.5])
    assert progress(0.4, 0.2, passing=False) == pytest.approx([0.2, 0.2, 0.4, 0.4])
