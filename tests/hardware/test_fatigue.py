"""Fatigue: Goodman's line met geometrically, and the line of 6061-T6 in the units of its source."""

from __future__ import annotations

import math

import numpy as np
import pytest

from evodesign.hardware.fatigue import ALUMINIUM_6061_T6

PSI = 6894.757


@pytest.mark.parametrize("cycles", [1e3, 1e5, 3e6])
def test_the_line_is_that_of_its_source_in_pounds_per_square_inch(cycles: float) -> None:
    printed = (2_100_000.0 / math.sqrt(cycles) + 14_000.0) * PSI
    assert ALUMINIUM_6061_T6.amplitude(cycles) == pytest.approx(printed, rel=1e-3)


@pytest.mark.parametrize("stress", [2e6, 80e6, 400e6])
def test_a_load_grows_until_mean_and_amplitude_meet_goodmans_line(stress: float) -> None:
    cycles = 2.4e6
    amplitude, ultimate = ALUMINIUM_6061_T6.amplitude(cycles), ALUMINIUM_6061_T6.ultimate
    # (mean, amplitude) = n (stress, stress) / 2 = (ultimate, 0) + share (-ultimate, amplitude)
    rows = np.array([[stress / 2.0, ultimate], [stress / 2.0, -amplitude]])
    factor, share = np.linalg.solve(rows, [ultimate, 0.0])
    assert 0.0 < share < 1.0
    assert ALUMINIUM_6061_T6.safety_factor(stress, cycles) == pytest.approx(factor)


def test_what_is_not_loaded_does_not_tire() -> None:
    assert ALUMINIUM_6061_T6.safety_factor(0.0, 1e6) == math.inf
