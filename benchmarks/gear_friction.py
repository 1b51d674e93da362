"""Closed forms of gears' friction beside the library that identified it.

`python -m benchmarks.gear_friction`, with better-actuator-models, for CPython 3.12: for both eRob80 and
many torques, how far torques of motors by `hardware.friction` are from those that the library's friction
leaves, found by bisection.
"""

from __future__ import annotations

import sys
from typing import Any

import numpy as np
from scipy.optimize import brentq

from evodesign.hardware.actuators import friction_of_row
from evodesign.hardware.catalogue import catalogue
from evodesign.hardware.friction import GearFriction

ROWS = {"eRob80i-50": "erob80_50", "eRob80i-100": "erob80_100"}
FAST = 1e3
"""Speed [rad/s] for which friction is fully against the motion, so that viscous friction is taken away."""


SIDES = (-1.0, 1.0)


def motor_torque(model: Any, torque: float, side: float) -> float:
    """The motor's torque where friction is against a motion to a side [N m], by bisection."""

    def off(motor: float) -> float:
        return motor - torque - side * float(model.compute_frictions(motor, -torque, 0.0)[0])

    return float(brentq(off, -500.0, 500.0, xtol=1e-12))


def main() -> None:
    """Print the largest differences."""
    try:
        from bam.model import load_model  # type: ignore[import-not-found]
    except ImportError:
        sys.exit("wanted: better-actuator-models, which has wheels for CPython 3.12 only")
    for name, motor_name in ROWS.items():
        model, gear = load_model(motor_name=motor_name, model="m3"), friction_of_row(catalogue()[name])
        assert gear is not None
        dry = GearFriction(gear.backdrive, gear.load_share)

        held, driven, viscous = [], [], model.friction_viscous.value
        for torque in np.linspace(-60.0, 60.0, 121).tolist():
            off = [motor_torque(model, torque, side) for side in SIDES]
            least = 0.0 if off[0] <= 0.0 <= off[1] else min(off, key=abs)
            held.append(abs(gear.holding(torque).value - least))
            turned = [dry.turning(torque, side * FAST).value for side in SIDES]
            driven += [abs(found - motor) for found, motor in zip(turned, off, strict=True)]
        print(
            f"{name}: holding {max(held):.1e} N m, turning {max(driven):.1e} N m apart, "
            f"viscous {abs(viscous - float(gear.viscous)) / viscous:.1e} of itself"
        )


if __name__ == "__main__":
    main()
