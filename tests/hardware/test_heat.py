"""Temperatures of windings, against closed forms by hand and an integration by SciPy."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from evodesign.hardware.heat import Duty

DUTY = Duty(holds_per_hour=60.0, hold=12.0, shift=2.0, air=25.0, limit=120.0, time_constant=180.0)


def integrated(duty: Duty, share: float) -> float:
    """The warmest moment, hold after hold, by an explicit method of order eight."""
    rise = duty.limit - 25.0
    grown = 1.0 + 0.00393 * (duty.limit - 20.0)
    period, warmest, now = 3600.0 / duty.holds_per_hour, -math.inf, duty.air

    def heated(_: float, temperature: np.ndarray) -> np.ndarray:
        loss = rise * share**2 * (1.0 + 0.00393 * (temperature - 20.0)) / grown
        return (loss - (temperature - duty.air)) / duty.time_constant

    def cooled(_: float, temperature: np.ndarray) -> np.ndarray:
        return (duty.air - temperature) / duty.time_constant

    for _ in range(int(duty.shift * duty.holds_per_hour)):
        for slope, seconds in ((heated, duty.hold), (cooled, period - duty.hold)):
            if seconds > 0.0:
                run = solve_ivp(slope, (0.0, seconds), [now], method="DOP853", rtol=1e-10, atol=1e-9)
                now = float(run.y[0, -1])
                warmest = max(warmest, now)
    return warmest


@pytest.mark.parametrize("share", [0.0, 0.3, 0.8, 1.5, 2.5])
@pytest.mark.parametrize(
    "duty",
    [
        DUTY,
        replace(DUTY, air=40.0, time_constant=60.0),
        replace(DUTY, holds_per_hour=12.0, hold=200.0, shift=1.0),
        replace(DUTY, holds_per_hour=2.0, hold=5.0, shift=0.5),
    ],
)
def test_a_shift_is_as_warm_as_its_equation_integrated(duty: Duty, share: float) -> None:
    wanted = integrated(duty, share)
    if wanted < 900.0:
        assert duty.temperature(share) == pytest.approx(wanted, rel=1e-6)


def test_a_step_of_loss_follows_the_exponential() -> None:
    """One hold, with copper that stays as it is: 1 - exp(-t / tau) of the rise, with its growth by hand."""
    once = replace(DUTY, holds_per_hour=1.0, hold=90.0, shift=1.0)
    share = 1e-3  # so little that resistance stays what it is in the air
    rise = share**2 * (120.0 - 25.0) / (1.0 + 0.393) * (1.0 + 0.00393 * 5.0)
    assert once.temperature(share) - 25.0 == pytest.approx(rise * (1.0 - math.exp(-0.5)), rel=1e-5)


def test_rated_torque_for_ever_is_the_limit_and_less_in_warmer_air() -> None:
    ever = replace(DUTY, hold=60.0, shift=24.0)
    assert ever.temperature(1.0) == pytest.approx(120.0, abs=1e-6)
    assert ever.derating == 1.0
    warm = replace(ever, air=45.0)
    assert 0.5 < warm.derating < 1.0
    assert warm.temperature(warm.derating) == pytest.approx(120.0, abs=1e-6)
    # both heats lead to the limit: (share)^2 (limit - 25) = limit - 45, as copper is as warm in both
    assert warm.derating == pytest.approx(math.sqrt(75.0 / 95.0), rel=1e-6)


@pytest.mark.parametrize("share", [0.2, 0.9, 1.6])
def test_the_slope_is_that_of_differences(share: float) -> None:
    step = 1e-5
    differences = (DUTY.temperature(share + step) - DUTY.temperature(share - step)) / (2.0 * step)
    assert DUTY.slope(share) == pytest.approx(differences, rel=1e-7)


def test_a_winding_that_burns_is_told_as_burnt() -> None:
    ever = replace(DUTY, hold=60.0, shift=24.0)
    assert ever.temperature(3.0) == 1000.0
    assert ever.slope(3.0) == 0.0
