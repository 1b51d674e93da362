"""How large a torque or force an MJCF file lets a joint have.

    joint      the smaller of `actuatorfrcrange` and the sum over the actuators that act on it
    actuator   |gear| times `forcerange`; of a motor without one, |gear| times gain times `ctrlrange`

Of a range, the smaller of what is allowed in the two directions counts. Servos without a force range, and
actuators by tendons, cranks or sites, set no limit.

Source: MuJoCo XML reference (joint, actuator); MuJoCo's computation chapter, "Actuation model".
"""

from __future__ import annotations

import math
from typing import Any


def acts_on(mujoco: Any, model: Any, joint: int) -> list[int]:
    """The actuators of a compiled model that act on a joint itself."""
    direct = (int(mujoco.mjtTrn.mjTRN_JOINT), int(mujoco.mjtTrn.mjTRN_JOINTINPARENT))
    return [
        actuator
        for actuator, kind in enumerate(model.actuator_trntype.tolist())
        if kind in direct and model.actuator_trnid[actuator, 0] == joint
    ]


def effort_limit(mujoco: Any, model: Any, joint: int) -> float:
    """Of a joint [N m or N]; infinite where the file sets none."""
    limits = []
    if model.jnt_actfrclimited[joint]:
        limits.append(_both_ways(*model.jnt_actfrcrange[joint]))
    actuators = acts_on(mujoco, model, joint)
    if actuators:
        limits.append(sum(_largest(mujoco, model, actuator) for actuator in actuators))
    return min(limits, default=math.inf)


def _largest(mujoco: Any, model: Any, actuator: int) -> float:
    """Of an actuator, at the joint."""
    every = range(len(model.actuator_trntype))  # before MuJoCo 4 each has one control and one output
    control, output = (getattr(model, f"actuator_{part}adr", every)[actuator] for part in ("ctrl", "out"))
    gear = abs(float(model.actuator_gear[output, 0]))
    if model.actuator_forcelimited[actuator]:
        return gear * _both_ways(*model.actuator_forcerange[actuator])
    motor = (
        model.actuator_gaintype[actuator] == mujoco.mjtGain.mjGAIN_FIXED
        and model.actuator_biastype[actuator] == mujoco.mjtBias.mjBIAS_NONE
    )
    if not motor or not model.actuator_ctrllimited[control]:
        return math.inf
    return (
        gear
        * abs(float(model.actuator_gainprm[actuator, 0]))
        * _both_ways(*model.actuator_ctrlrange[control])
    )


def _both_ways(low: float, high: float) -> float:
    """What a range allows in either direction; no limit where it allows but one."""
    smaller = min(-float(low), float(high))
    return smaller if smaller > 0.0 else math.inf
