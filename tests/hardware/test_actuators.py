"""Laws of actuators: fits, what robots that were built would get, and losses by hand."""

from __future__ import annotations

import math

import casadi as ca
import numpy as np
import pytest

from evodesign.body.placement import Placement
from evodesign.errors import InputError
from evodesign.hardware.actuators import (
    LEAST_ROWS,
    actuator_law,
    actuator_of_row,
    fitted_power_law,
    gears_with_a_law,
    mounted_solid,
)
from evodesign.hardware.catalogue import CatalogueRow, Gear, catalogue, gearheads

FAMILY = [row for row in catalogue().values() if row.in_default_law]
PLANETARY = [row for row in catalogue().values() if row.gear is Gear.PLANETARY]
STRAIN_WAVE = [row for row in catalogue().values() if row.gear is Gear.STRAIN_WAVE]

DEFAULT = {
    "peak": (3.005875842996196, 1.0, 1.139077776880621),
    "mass": (0.06640368791463958, 0.6224203844402225, 1.297743521277159),
    "motor_constant": (0.3062716460843604, 0.6776891899729496, 1.2200005331162762),
    "inertia": (0.001533494649179741, 1.216235386189033, 2.464378315668455),
    "speed": (26.49919324494854, -0.1604075095534216, 1.3615568597541818),
    "stiffness": (690.4259021175511, 1.0, 1.4229404157758072),
}
"""Factor, exponent and scatter of the default law, which results of problems depend on."""


def test_the_default_law_is_that_of_seven_rows_whatever_the_catalogue_holds_beside_them() -> None:
    assert [row.model for row in FAMILY] == [
        "X2-7",
        "X4-10",
        "X4-36",
        "X6-60",
        "X8-120",
        "X12-320",
        "X15-450",
    ]
    assert actuator_law() == actuator_law("planetary") == actuator_law(Gear.PLANETARY)
    for name, figures in DEFAULT.items():
        law = getattr(actuator_law(), name)
        assert (law.factor, law.exponent, law.scatter) == pytest.approx(figures, rel=1e-13), name
    for row in FAMILY:
        assert row.gear is Gear.PLANETARY
        assert (row.ratio or 0.0) >= 12.0
        assert None not in (row.rated_torque_n_m, row.motor_constant, row.reflected_inertia, row.speed)


def test_the_mass_law_is_within_a_factor_of_a_fifth_of_four_rows_in_five() -> None:
    ratios = [actuator_law().mass(row.peak_torque_n_m) / row.mass_kg for row in FAMILY]
    near = [1 / 1.2 <= ratio <= 1.2 for ratio in ratios]
    assert len(near) == 7
    assert sum(near) / len(near) >= 0.8


def test_the_mass_law_holds_for_planetary_actuators_that_it_was_not_fitted_to() -> None:
    """84 actuators: two in five within a fifth, nineteen in twenty within a factor of two."""
    others = [row for row in PLANETARY if row not in FAMILY]
    ratios = np.array([actuator_law().mass(row.peak_torque_n_m) / row.mass_kg for row in others])
    assert np.mean((ratios >= 1 / 1.2) & (ratios <= 1.2)) >= 0.4
    assert np.mean((ratios >= 1 / 2) & (ratios <= 2)) >= 0.95
    assert np.exp(np.mean(np.log(ratios))) == pytest.approx(1.0, abs=0.1)


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
    row = CatalogueRow(model="ours", mass_kg=0.6, peak_torque_n_m=36.0, source="measured")
    actuator, law = actuator_of_row(row), actuator_law()
    assert actuator.rated == pytest.approx(36.0 / law.peak.factor)
    assert actuator.motor_constant == law.motor_constant(actuator.rated)
    assert actuator.mass == row.mass_kg


def test_what_a_maker_of_a_strain_wave_drive_does_not_give_is_the_law_of_such_drives() -> None:
    row = catalogue()["eRob80i-100"]
    actuator, law = actuator_of_row(row), actuator_law("strain_wave")
    assert actuator.motor_constant == law.motor_constant(31.0)
    assert actuator.inertia == law.inertia(31.0)
    assert actuator.stiffness == law.stiffness(31.0)
    assert actuator.housing == (0.08, 0.0642)
    assert actuator.speed == pytest.approx(math.pi)
    bare = actuator_of_row(catalogue()["FHA-17C-100"])
    assert bare.housing == pytest.approx((law.diameter(2.9), law.length(2.9)))


def _line(x: list[float], y: list[float], through_origin: bool = False) -> tuple[float, float, float]:
    """Factor, exponent and scatter by numpy's own least squares in the logarithms."""
    a, b = np.log(x), np.log(y)
    if through_origin:
        left = b - a
        return float(np.exp(left.mean())), 1.0, float(np.exp(left.std(ddof=1)))
    columns = np.column_stack([np.ones(len(a)), a])
    (offset, slope), squares, _, _ = np.linalg.lstsq(columns, b, rcond=None)
    return float(np.exp(offset)), float(slope), float(np.exp(np.sqrt(squares[0] / (len(a) - 2))))


@pytest.mark.parametrize(
    ("name", "x", "y"),
    [
        ("peak", "rated_torque_n_m", "peak_torque_n_m"),
        ("mass", "peak_torque_n_m", "mass_kg"),
        ("motor_constant", "rated_torque_n_m", "motor_constant"),
        ("inertia", "rated_torque_n_m", "reflected_inertia"),
        ("speed", "rated_torque_n_m", "speed"),
    ],
)
@pytest.mark.parametrize("gear", ["planetary", "strain_wave"])
def test_each_law_is_the_least_squares_of_a_second_computation(gear: str, name: str, x: str, y: str) -> None:
    rows = FAMILY if gear == "planetary" else STRAIN_WAVE
    pairs = [(getattr(row, x), getattr(row, y)) for row in rows if name != "mass" or not row.separate_drive]
    known = [(a, b) for a, b in pairs if a and b]
    assert len(known) >= (7 if gear == "planetary" else 15)
    law = getattr(actuator_law(gear), name)
    wanted = _line([a for a, _ in known], [b for _, b in known], name == "peak")
    assert (law.factor, law.exponent, law.scatter) == pytest.approx(wanted, rel=1e-10)


@pytest.mark.parametrize("gear", ["planetary", "strain_wave"])
def test_housings_follow_mass_within_a_quarter(gear: str) -> None:
    whole = [row for row in (PLANETARY if gear == "planetary" else STRAIN_WAVE) if not row.separate_drive]
    rows = [row for row in whole if row.housing]
    assert len(rows) >= 28
    law = actuator_law(gear)
    for side, part in enumerate((law.diameter, law.length)):
        sizes = [row.housing[side] for row in rows if row.housing]
        wanted = _line([row.mass_kg for row in rows], sizes)
        assert (part.factor, part.exponent, part.scatter) == pytest.approx(wanted, rel=1e-10)
        assert part.scatter < 1.25
    actuator = law.at(20.0)
    assert actuator.size == actuator.housing == law.housing(actuator.mass)
    diameter, length = actuator.size
    assert 1500.0 < float(actuator.mass / (math.pi / 4 * diameter**2 * length)) < 4500.0


def test_strain_wave_stiffness_is_the_mean_of_gears_by_themselves() -> None:
    """K1 of the eRob 80H at 100:1 is 1.0e4 N m/rad at 31 N m rated."""
    gears = {gear.model: gear for gear in gearheads(Gear.STRAIN_WAVE)}
    assert gears["eRob80H-100"].relative_stiffness * 31.0 == pytest.approx(1.0e4, rel=1e-4)
    mean = math.exp(np.mean([math.log(gear.relative_stiffness) for gear in gears.values()]))
    assert actuator_law("strain_wave").stiffness(1.0) == pytest.approx(mean, rel=1e-12)


def test_a_strain_wave_drive_holds_with_less_loss_and_is_slower_and_heavier_than_a_planetary_one() -> None:
    strain_wave, planetary = (actuator_law(gear).at(20.0) for gear in ("strain_wave", "planetary"))
    assert strain_wave.loss(20.0) < planetary.loss(20.0)
    assert strain_wave.speed < planetary.speed
    assert strain_wave.mass > planetary.mass
    assert strain_wave.inertia > planetary.inertia


def test_a_gear_with_too_few_rows_has_no_law_and_is_refused_in_a_sentence() -> None:
    assert gears_with_a_law() == ("planetary", "strain_wave")
    assert LEAST_ROWS == 4
    for name in ("cycloidal", "belt"):
        with pytest.raises(InputError, match=f"wanted a gear of which 4 rows .*, found '{name}'"):
            actuator_law(name)


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
