"""Quantities of a moving load.

    robot_power   sum over the robots' joints of max(m x speed, 0), and copper losses of actuators [W], m the
                  torque of the joint's motor: the joint's, and its gear's friction (`hardware.friction`)
    energy        robot_power over the time of a lift, the mean over all lifts [J]
    lift_seconds  least time in which a lift can be done, the mean over all lifts; worst_ the largest [s]
    l5s1_moment   |torque| at a person's joints between the fifth lumbar vertebra and the sacrum [N m]

No power is regained from a joint that brakes. Copper losses count where a design has actuators, whose motor
constants are known.
"""

from __future__ import annotations

import numpy as np

from evodesign.hardware.friction import MotorTorque
from evodesign.human.back import LUMBAR
from evodesign.mechanics.agent import Agent
from evodesign.posture.results import AgentPosture
from evodesign.quantities.hardware_quantities import (
    copper_loss,
    motor_torque,
    power_by_speed,
    power_by_torque,
)
from evodesign.quantities.over_agents import largest, over_agents, people, robots, total

POWER, ENERGY, SPINE, LEAST_TIME = "robot_power", "energy", "l5s1_moment", "lift_seconds"

NEED_LIFTS = (POWER, ENERGY, LEAST_TIME)
"""How the names of quantities end that tell nothing where no load moves."""

ENDURANCE = "endurance_s"
"""How long people can hold the loads."""

PAPER_COSTS = ("paper_cost", "paper2023_cost", "paper2025_cost")
OF_HOLDS = (*PAPER_COSTS, ENDURANCE)
"""Quantities of loads held still."""


def power(robot: Agent, posture: AgentPosture) -> float:
    """What a robot's joints and actuators draw at an instant [W]."""
    return sum(motor.value * speed for motor, speed in _driving(robot, posture).values()) + copper_loss(
        robot, posture
    )


def motion_power_by_torque(robot: Agent, posture: AgentPosture) -> dict[str, float]:
    """D P / d tau: of copper losses, and dm / d tau times the speed of each motor that drives."""
    copper = power_by_torque(robot, posture)
    found = {joint: copper.get(joint, 0.0) for joint in posture.torques}
    for joint, (motor, speed) in _driving(robot, posture).items():
        found[joint] += motor.by_torque * speed
    return found


def motion_power_by_speed(robot: Agent, posture: AgentPosture) -> dict[str, float]:
    """D P / d w: of copper losses, and m + dm / d w times the speed of each motor that drives."""
    copper = power_by_speed(robot, posture)
    found = {joint: copper.get(joint, 0.0) for joint in posture.speeds}
    for joint, (motor, speed) in _driving(robot, posture).items():
        found[joint] += motor.value + motor.by_speed * speed
    return found


def _driving(robot: Agent, posture: AgentPosture) -> dict[str, tuple[MotorTorque, float]]:
    """Torque [N m] and speed [rad/s] of the motors that turn their joints on."""
    motors = ((joint, motor_torque(robot, posture, joint), speed) for joint, speed in posture.speeds.items())
    return {joint: (motor, speed) for joint, motor, speed in motors if motor.value * speed > 0.0}


ROBOT_POWER = over_agents(
    robots, total, "W", power, by_torque=motion_power_by_torque, by_speed=motion_power_by_speed
)


def l5s1_moment(person: Agent, posture: AgentPosture) -> float:
    """Norm of a person's torques between L5 and S1 [N m]."""
    own = [torque for joint, torque in posture.torques.items() if joint.startswith(LUMBAR)]
    return float(np.linalg.norm(own))


def moment_by_torque(person: Agent, posture: AgentPosture) -> dict[str, float]:
    """D |tau| / d tau of the joints between L5 and S1."""
    size = l5s1_moment(person, posture) or 1.0
    return {joint: tau / size for joint, tau in posture.torques.items() if joint.startswith(LUMBAR)}


L5S1_MOMENT = over_agents(people, largest, "N m", l5s1_moment, by_torque=moment_by_torque)
