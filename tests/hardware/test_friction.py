"""Friction of gears: the closed forms against the balance of torques, solved by bisection."""

from __future__ import annotations

import math

import pytest
from scipy.optimize import brentq

from evodesign.hardware.actuators import actuator_of_row, friction_law, friction_of_row
from evodesign.hardware.catalogue import Gear, catalogue
from evodesign.hardware.friction import GearFriction

GEARS = [
    GearFriction(1.6),
    GearFriction(1.6, viscous=0.4),
    GearFriction(3.0, 0.15, 2.0),
    GearFriction(0.0, 0.3),
]
TORQUES = [-40.0, -2.0, -0.4, 0.0, 0.7, 3.1, 25.0]


def most(gear: GearFriction, motor: float, outside: float, speed: float) -> float:
    """The largest friction: base, share of what works against each other on the gear, and viscous."""
    base = gear.backdrive * (1.0 - gear.load_share)
    return float(base + gear.load_share * abs(motor - outside) + gear.viscous * abs(speed))


@pytest.mark.parametrize("gear", GEARS)
@pytest.mark.parametrize("torque", TORQUES)
def test_a_gear_that_stands_takes_what_it_can(gear: GearFriction, torque: float) -> None:
    """The load pulls with -torque; the least motor torque for which friction is enough, by bisection."""

    def lacks(motor: float) -> float:
        return abs(motor - torque) - most(gear, motor, -torque, 0.0)

    least = 0.0 if lacks(0.0) <= 0.0 else brentq(lacks, 0.0, torque, xtol=1e-13)
    assert gear.holding(torque).value == pytest.approx(least, abs=1e-9)


@pytest.mark.parametrize("gear", GEARS)
@pytest.mark.parametrize("torque", TORQUES)
@pytest.mark.parametrize("speed", [-3.0, 0.5])
def test_in_a_gear_that_turns_friction_is_against_the_motion(
    gear: GearFriction, torque: float, speed: float
) -> None:
    def off(motor: float) -> float:
        return motor - math.copysign(most(gear, motor, -torque, speed), speed) - torque

    motor = brentq(off, -1e3, 1e3, xtol=1e-13)
    assert gear.turning(torque, speed).value == pytest.approx(motor, rel=2e-3, abs=2e-3)  # (w_s / w)^2 / 2


@pytest.mark.parametrize("gear", GEARS)
@pytest.mark.parametrize("torque", [-40.0, -0.4, 0.7, 25.0])
def test_slopes_are_those_of_differences(gear: GearFriction, torque: float) -> None:
    step = 1e-6
    holding = gear.holding(torque + step).value - gear.holding(torque - step).value
    assert gear.holding(torque).by_torque == pytest.approx(holding / (2.0 * step), abs=1e-7)
    for speed in (-1.0, 0.01, 0.3):
        found = gear.turning(torque, speed)
        by_torque = gear.turning(torque + step, speed).value - gear.turning(torque - step, speed).value
        by_speed = gear.turning(torque, speed + step).value - gear.turning(torque, speed - step).value
        assert found.by_torque == pytest.approx(by_torque / (2.0 * step), rel=1e-6, abs=1e-6)
        assert found.by_speed == pytest.approx(by_speed / (2.0 * step), rel=1e-6, abs=1e-5)


def test_without_current_a_gear_turns_at_its_backdrive_torque() -> None:
    gear = GearFriction(3.0, 0.15, 2.0)
    assert gear.holding(2.999).value == 0.0
    assert gear.holding(3.001).value > 0.0


def test_holding_takes_less_and_lifting_more() -> None:
    row = catalogue()["eRob80i-100"]
    gear = friction_of_row(row)
    assert gear is not None
    held, lifted = gear.holding(31.0).value, gear.turning(31.0, 0.2).value
    assert 0.0 < held < 31.0 < lifted
    actuator = actuator_of_row(row)
    assert actuator.friction is None
    assert actuator.motor(31.0).value == 31.0


def test_a_row_has_its_own_friction_or_that_of_its_law() -> None:
    law = friction_law()
    assert law is not None
    known = [row for row in catalogue().values() if row.gear is Gear.PLANETARY and row.friction_torque_n_m]
    assert law.count == len([row for row in known if row.rated_torque_n_m])
    own, other = (friction_of_row(catalogue()[name]) for name in ("X6-60", "RS04"))
    assert own == GearFriction(1.6)
    assert other == GearFriction(law(40.0))
    assert friction_law(Gear.STRAIN_WAVE) is None
    assert friction_of_row(catalogue()["RH-17"]) is None
