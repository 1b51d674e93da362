"""Quantities of a moving load.

    robot_power   sum over the robots' joints of max(torque x speed, 0), and copper losses of actuators [W]
    energy        robot_power over the time of a lift, the mean over all lifts [J]
    lift_seconds  least time in which a lift can be done, the mean over all lifts; worst_ the largest [s]
    l5s1_moment   |torque| at a person's joints between the fifth lumbar vertebra and the sacrum [N m]

No power is regained from a joint that brakes. Copper losses count where a design has actuators, whose motor
constants are known.
"""

from __future__ import annotations

import numpy as np

from evodesign.human.back import LUMBAR
from evodesign.mechanics.agent import Agent
from evodesign.posture.results import AgentPosture
from evodesign.quantities.hardware_quantities import copper_loss, power_by_torque
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
    mechanical = (max(posture.torques[joint] * speed, 0.0) for joint, speed in posture.speeds.items())
    return float(sum(mechanical)) + copper_loss(robot, posture)


def motion_power_by_torque(robot: Agent, posture: AgentPosture) -> dict[str, float]:
    """D P / d tau = 2 tau / K^2, and the speed of each joint that drives."""
    copper = power_by_torque(robot, posture)
    speeds = {joint: posture.speeds[joint] for joint in _driving(posture)}
    return {joint: copper.get(joint, 0.0) + speeds.get(joint, 0.0) for joint in posture.torques}


def motion_power_by_speed(robot: Agent, posture: AgentPosture) -> dict[str, float]:
    """The torque of each joint that drives."""
    return {joint: posture.torques[joint] for joint in _driving(posture)}


def _driving(posture: AgentPosture) -> list[str]:
    """Joints whose torque turns them on."""
    return [joint for joint, speed in posture.speeds.items() if posture.torques[joint] * speed > 0.0]


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
