"""Splines at rest at both ends, against SciPy's clamped splines through the same values."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from evodesign.motion.spline import RestingSpline


@pytest.mark.parametrize("derivative", [0, 1, 2])
@pytest.mark.parametrize("knots", [4, 9])
def test_a_spline_is_the_clamped_one_through_its_values(knots: int, derivative: int) -> None:
    values = np.random.default_rng(knots).normal(size=knots)
    places = np.linspace(0.0, knots - 1.0, 37)
    clamped = CubicSpline(np.arange(float(knots)), values, bc_type="clamped")
    spline = RestingSpline(knots)
    found = spline.image(places, derivative) @ spline.through(values)
    assert found == pytest.approx(clamped(places, derivative), abs=1e-9)


def test_bounds_of_coefficients_are_bounds_everywhere() -> None:
    image = RestingSpline(7).image(np.linspace(0.0, 6.0, 50))
    assert image.min() >= 0.0
    assert image.sum(axis=1) == pytest.approx(1.0)
