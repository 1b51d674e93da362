"""Quantities of a moving load.

    robot_power   sum over the robot's joints of max(torque x speed, 0), and copper losses of actuators [W]
    energy        robot_power over the time of a lift, the mean over all lifts [J]
    lift_seconds  least time in which a lift can be done, the mean over all lifts; worst_ the largest [s]
    l5s1_moment   |torque| at the person's joints between the fifth lumbar vertebra and the sacrum [N m]

No power is regained from a joint that brakes. Copper losses count where a design has actuators, whose motor
constants are known.
"""

from __future__ import annotations

import functools
import operator
from collections.abc import Mapping, Sequence
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from evodesign.human.back import LUMBAR
from evodesign.mechanics.agent import HUMAN, ROBOT
from evodesign.mechanics.scene import Scene
from evodesign.posture.results import AgentPosture
from evodesign.quantities.hardware_quantities import holding_power, power_by_torque

Value = TypeVar("Value", float, NDArray[np.float64])

POWER, ENERGY, SPINE, LEAST_TIME = "robot_power", "energy", "l5s1_moment", "lift_seconds"

NEED_LIFTS = (POWER, ENERGY, LEAST_TIME)
"""How the names of quantities end that tell nothing where no load moves."""

ENDURANCE = "endurance_s"
"""How long people can hold the loads."""

OF_HOLDS = ("paper_cost", "paper2023_cost", ENDURANCE)
"""Quantities of loads held still."""


def robot_power(scene: Scene, postures: Mapping[str, AgentPosture]) -> float:
    """What the robot's joints and actuators draw at an instant [W]."""
    posture = postures[ROBOT]
    mechanical = (max(posture.torques[joint] * speed, 0.0) for joint, speed in posture.speeds.items())
    return float(sum(mechanical)) + holding_power(scene, postures)


def motion_power_by_torque(scene: Scene, postures: Mapping[str, AgentPosture]) -> dict[str, dict[str, float]]:
    """D P / d tau = 2 tau / K^2, and the speed of each joint that drives."""
    posture, copper = postures[ROBOT], power_by_torque(scene, postures)[ROBOT]
    speeds = {joint: posture.speeds[joint] for joint in _driving(posture)}
    return {ROBOT: {joint: copper.get(joint, 0.0) + speeds.get(joint, 0.0) for joint in posture.torques}}


def motion_power_by_speed(scene: Scene, postures: Mapping[str, AgentPosture]) -> dict[str, dict[str, float]]:
    """The torque of each joint that drives."""
    posture = postures[ROBOT]
    return {ROBOT: {joint: posture.torques[joint] for joint in _driving(posture)}}


def _driving(posture: AgentPosture) -> list[str]:
    """Joints whose torque turns them on."""
    return [joint for joint, speed in posture.speeds.items() if posture.torques[joint] * speed > 0.0]


def l5s1_moment(scene: Scene, postures: Mapping[str, AgentPosture]) -> float:
    """Norm of the person's torques between L5 and S1 [N m]."""
    torques = postures[HUMAN].torques
    return float(np.linalg.norm([torque for joint, torque in torques.items() if joint.startswith(LUMBAR)]))


def moment_by_torque(scene: Scene, postures: Mapping[str, AgentPosture]) -> dict[str, dict[str, float]]:
    """D |tau| / d tau of the joints between L5 and S1."""
    norm = l5s1_moment(scene, postures) or 1.0
    torques = postures[HUMAN].torques
    return {HUMAN: {joint: tau / norm for joint, tau in torques.items() if joint.startswith(LUMBAR)}}


def mean_over_time(times: Sequence[float], values: Sequence[Value]) -> Value:
    """The mean of numbers or arrays: the only one, or by the trapezoidal rule over their times [s]."""
    if len(values) == 1:
        return values[0]
    lengths = np.diff(times)
    weights = (np.append(lengths, 0.0) + np.insert(lengths, 0, 0.0)) / (2.0 * (times[-1] - times[0]))
    parts = (float(weight) * value for weight, value in zip(weights, values, strict=True))
    return functools.reduce(operator.add, parts)
