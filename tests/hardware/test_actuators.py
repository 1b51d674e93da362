"""The catalogue and its laws: sources, fits, what robots that were built would get, and losses by hand."""

from __future__ import annotations

import math

import casadi as ca
import numpy as np
import pytest

from evodesign.body.material import CATALOGUE
from evodesign.body.placement import Placement
from evodesign.hardware.actuators import (
    LEAST_RATIO,
    actuator_law,
    actuator_of_row,
    catalogue,
    catalogue_sources,
    fitted_power_law,
    mounted_solid,
)
from evodesign.hardware.structure import STRENGTHS

FAMILY = [
    row
    for row in catalogue().values()
    if row.rated_torque_n_m and row.motor_constant and row.ratio and row.ratio >= LEAST_RATIO
]


def test_every_row_has_a_source_that_is_explained_and_a_name_of_its_own() -> None:
    assert len(catalogue()) >= 19
    for row in catalogue().values():
        assert catalogue_sources()[row.source]
    assert set(STRENGTHS) <= set(CATALOGUE)


def test_the_mass_law_is_within_a_factor_of_a_fifth_of_four_rows_in_five() -> None:
    ratios = [actuator_law().mass(row.peak_torque_n_m) / row.mass_kg for row in FAMILY]
    near = [1 / 1.2 <= ratio <= 1.2 for ratio in ratios]
    assert len(near) == 7
    assert sum(near) / len(near) >= 0.8


def test_the_mass_law_holds_for_most_of_what_it_was_not_fitted_to() -> None:
    """The other makers' single-stage actuators: two in three within a fifth, all within a factor of 2.1."""
    others = [row for row in catalogue().values() if row not in FAMILY]
    ratios = np.array([actuator_law().mass(row.peak_torque_n_m) / row.mass_kg for row in others])
    assert np.mean((ratios >= 1 / 1.2) & (ratios <= 1.2)) >= 0.6
    assert np.all((ratios > 1 / 2.1) & (ratios < 2.1))


def test_knees_of_robots_that_were_built_get_masses_between_their_makers_lightest_and_heaviest() -> None:
    """Peak torques [N m] of knees and the masses [kg] that an actuator of that torque may have."""
    knees = {
        "NAO": (1.6, 0.05, 0.2),
        "BRUCE": (10.5, 0.15, 0.5),
        "iCub": (40.0, 0.4, 1.2),
        "Berkeley Humanoid": (63.0, 0.6, 1.2),
        "Unitree G1": (120.0, 1.0, 1.8),
        "MIT Humanoid": (136.0, 1.0, 2.0),
        "Cassie": (195.0, 1.2, 3.0),
        "Unitree H1": (360.0, 1.8, 4.0),
        "LOLA": (390.0, 2.0, 5.0),
    }
    law = actuator_law()
    for name, (peak, least, most) in knees.items():
        actuator = law.at(peak / law.peak.factor)
        assert actuator.peak == pytest.approx(peak)
        assert least < actuator.mass < most, name


def test_the_fit_is_the_least_squares_solution_of_the_normal_equations() -> None:
    x = [row.peak_torque_n_m for row in FAMILY]
    y = [row.mass_kg for row in FAMILY]
    a = np.column_stack([np.ones(len(x)), np.log(x)])
    offset, slope = np.linalg.solve(a.T @ a, a.T @ np.log(y))
    law = fitted_power_law(x, y)
    assert law.factor == pytest.approx(math.exp(offset), rel=1e-12)
    assert law.exponent == pytest.approx(slope, rel=1e-12)
    left = np.log(y) - offset - slope * np.log(x)
    assert law.scatter == pytest.approx(math.exp(math.sqrt(np.sum(left**2) / (len(x) - 2))), rel=1e-12)
    assert actuator_law().mass == law


def test_copper_loss_is_that_of_the_current_in_three_phases() -> None:
    """X8-120 at rated torque by hand: I = 43 / 2.4 = 17.9 A, P = 3 x 0.18 x 17.9^2 = 173.3 W."""
    row = catalogue()["X8-120"]
    actuator = actuator_of_row(row)
    current = 43.0 / 2.4
    assert actuator.loss(43.0) == pytest.approx(3 * 0.18 * current**2, rel=1e-12)
    assert current == pytest.approx(17.6, rel=0.02)  # what the maker says of rated torque
    assert actuator.inertia == pytest.approx(19.612**2 * 1.5e-4)
    assert actuator.speed == pytest.approx(158.0 / 60.0 * 2.0 * math.pi)
    assert (actuator.mass, actuator.peak, actuator.rated) == (1.40, 120.0, 43.0)


def test_what_a_maker_does_not_give_is_the_laws() -> None:
    row = catalogue()["RS06"]
    actuator, law = actuator_of_row(row), actuator_law()
    assert actuator.rated == pytest.approx(36.0 / law.peak.factor)
    assert actuator.motor_constant == law.motor_constant(actuator.rated)
    assert actuator.mass == row.mass_kg


def test_a_gear_winds_up_by_a_fraction_of_a_degree_at_rated_torque() -> None:
    actuator = actuator_law().at(40.0)
    assert math.degrees(actuator.windup(40.0)) == pytest.approx(0.083, rel=0.01)
    assert actuator.windup(-20.0) == pytest.approx(-actuator.windup(40.0) / 2.0)


def test_the_law_works_with_expressions_and_its_ball_has_the_mass() -> None:
    symbol = ca.SX.sym("rated")
    actuator = actuator_law().at(symbol)
    place = Placement(translation=(0.1, 0.2, 0.3))
    inertia = mounted_solid(actuator, place, (1.0, 0.0, 0.0)).inertia
    found = ca.Function("f", [symbol], [actuator.mass, inertia.mass, inertia.about_center[0][0]])
    number = actuator_law().at(30.0)
    radius = (3.0 * number.mass / (4.0 * math.pi * 3000.0)) ** (1 / 3)
    wanted = (number.mass, number.mass, 0.4 * number.mass * radius**2)
    assert [float(each) for each in found(30.0)] == pytest.approx(wanted, rel=1e-12)
    assert mounted_solid(number, place, (1.0, 0.0, 0.0)).inertia.center == (0.1, 0.2, 0.3)
