"""Friction of an actuator's gear, and what it leaves for the motor to do; all torques are at the output.

    F = f + k |tau + m| + c |w|,      f = (1 - k) b

with m of the motor, tau at the joint, w its speed, b the torque that turns the output without current.
In a gear that stands, friction takes what it can, up to F:

    holds     |m| = max((1 - k) |tau| - f, 0) / (1 + k)

In one that turns it is against the motion. With s = w / sqrt(w^2 + w_s^2) in place of the sign of w,

    turns     m = ((1 + s k') tau + s f + c w) / (1 - s k'),      k' = k sign(2 tau + s f + c w)

so that a small change of a motion changes m little. k stands for what is otherwise called efficiency: a load
that is lifted slowly takes (1 + k) / (1 - k) times its torque, beside f.

Source: Coulomb and viscous friction that grows with the load, model M3 of Duclusaud et al. 2024 (Extended
friction models for the physics simulation of servo actuators), which identify it for two rows.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from evodesign.body.placement import Scalar

SLOW = 0.02
"""Speed w_s [rad/s] below which friction fades: a degree a second, at which nothing is lifted."""


@dataclass(frozen=True, slots=True)
class MotorTorque:
    """What a motor gives, at the output.

    Args:
        value: [N m].
        by_torque: its derivative by the torque at the joint.
        by_speed: its derivative by the joint's speed [N m s/rad].
    """

    value: float
    by_torque: float
    by_speed: float = 0.0


@dataclass(frozen=True, slots=True)
class GearFriction:
    """Friction of one actuator.

    Args:
        backdrive: torque that turns the output without current [N m], a number or an expression.
        load_share: k, what friction grows by with the torque that the gear carries.
        viscous: c [N m s/rad].
    """

    backdrive: Scalar
    load_share: Scalar = 0.0
    viscous: Scalar = 0.0

    def holding(self, torque: float) -> MotorTorque:
        """The motor's torque in a joint that stands still and bears a torque [N m]."""
        k = float(self.load_share)
        left = (1.0 - k) * (abs(torque) - float(self.backdrive))
        if left <= 0.0:
            return MotorTorque(0.0, 0.0)
        return MotorTorque(math.copysign(left, torque) / (1.0 + k), (1.0 - k) / (1.0 + k))

    def turning(self, torque: float, speed: float) -> MotorTorque:
        """The motor's torque in a joint that gives a torque [N m] and turns at a speed [rad/s]."""
        k, c = float(self.load_share), float(self.viscous)
        f = (1.0 - k) * float(self.backdrive)
        root = math.hypot(speed, SLOW)
        s, s_by_speed = speed / root, SLOW**2 / root**3
        k = math.copysign(k, 2.0 * torque + s * f + c * speed)
        value = ((1.0 + s * k) * torque + s * f + c * speed) / (1.0 - s * k)
        by_speed = (s_by_speed * (k * (torque + value) + f) + c) / (1.0 - s * k)
        return MotorTorque(value, (1.0 + s * k) / (1.0 - s * k), by_speed)
