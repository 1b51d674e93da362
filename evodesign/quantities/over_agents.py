"""Quantities of one agent's posture, taken over everyone of a role who holds the load."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence

import numpy as np

from evodesign.mechanics.agent import Agent, Role
from evodesign.mechanics.robot_gradient import RobotGradient
from evodesign.mechanics.scene import Scene
from evodesign.posture.results import AgentPosture, Array
from evodesign.quantities.design_result import ByPosture, ByRobot, ByTorque, CaseQuantity, PostureSlopes

AgentValue = Callable[[Agent, AgentPosture], float]
"""From an agent and its posture to a value."""

AgentSlopes = Callable[[Agent, AgentPosture], Mapping[str, float]]
"""To a value's derivatives by the torque or the speed of each joint."""

RobotSlopes = Callable[[RobotGradient, Sequence[float], Agent, AgentPosture], tuple[Array, PostureSlopes]]
"""To a value's derivatives by what programs are given, and by the agent's posture."""

Way = Callable[[Sequence[float]], tuple[float, Sequence[float]]]
"""From the values of agents to that of all, and its derivatives by each."""


def robots(agent: Agent) -> bool:
    """Whether an agent is a robot."""
    return agent.role is Role.ROBOT


def designed(agent: Agent) -> bool:
    """Whether an agent is a robot that designs change."""
    return agent.designed


def people(agent: Agent) -> bool:
    """Whether an agent is a person."""
    return agent.role is Role.PERSON


def largest(values: Sequence[float]) -> tuple[float, Sequence[float]]:
    """That of the agent who bears most."""
    place = max(range(len(values)), key=lambda number: values[number])
    return values[place], [float(number == place) for number in range(len(values))]


def least(values: Sequence[float]) -> tuple[float, Sequence[float]]:
    """That of the agent who lasts least."""
    value, slopes = largest([-each for each in values])
    return -value, slopes


def total(values: Sequence[float]) -> tuple[float, Sequence[float]]:
    """The sum."""
    return math.fsum(values), [1.0] * len(values)


def norm(values: Sequence[float]) -> tuple[float, Sequence[float]]:
    """That of a vector whose parts have these norms."""
    value = values[0] if len(values) == 1 else math.hypot(*values)
    return value, [each / value if value else 1.0 for each in values]


def over_agents(
    who: Callable[[Agent], bool],
    way: Way,
    unit: str,
    value: AgentValue,
    *,
    by_torque: AgentSlopes | None = None,
    by_speed: AgentSlopes | None = None,
    by_posture: Callable[[Agent, AgentPosture], PostureSlopes] | None = None,
    by_robot: RobotSlopes | None = None,
    of_actuators: bool = True,
) -> CaseQuantity:
    """The quantity that a value of each of some agents is of them all.

    Args:
        who: whether an agent is one of them.
        way: how their values are taken together.
        unit: of the values.
        value: of one agent.
        by_torque: its derivatives by torques, as in `CaseQuantity`.
        by_speed: likewise by speeds.
        by_posture: likewise by posture and wrenches.
        by_robot: likewise by what programs are given, and by posture and wrenches.
        of_actuators: whether the value of a robot may depend on its actuators beside torques and speeds.
    """

    def of_each(scene: Scene, postures: Mapping[str, AgentPosture]) -> list[tuple[Agent, AgentPosture]]:
        return [(agent, postures[agent.name]) for agent in scene.agents if who(agent)]

    def of_all(scene: Scene, postures: Mapping[str, AgentPosture]) -> float:
        return way([value(*each) for each in of_each(scene, postures)])[0]

    def weighted(
        scene: Scene, postures: Mapping[str, AgentPosture]
    ) -> Iterator[tuple[Agent, AgentPosture, float]]:
        every = of_each(scene, postures)
        weights = way([value(*each) for each in every])[1]
        return ((*each, weight) for each, weight in zip(every, weights, strict=True) if weight)

    def slopes(own: AgentSlopes | None) -> ByTorque | None:
        if own is None:
            return None
        return lambda scene, postures: {
            agent.name: {joint: weight * slope for joint, slope in own(agent, posture).items()}
            for agent, posture, weight in weighted(scene, postures)
        }

    def posture_slopes() -> ByPosture | None:
        if by_posture is None:
            return None
        return lambda scene, postures: {
            agent.name: by_posture(agent, posture).times(weight)
            for agent, posture, weight in weighted(scene, postures)
        }

    def robot_slopes() -> ByRobot | None:
        if by_robot is None:
            return None

        def found(
            robot: RobotGradient, values: Sequence[float], scene: Scene, postures: Mapping[str, AgentPosture]
        ) -> tuple[Array, Mapping[str, PostureSlopes]]:
            by_values, by_postures = np.zeros(len(values)), {}
            for agent, posture, weight in weighted(scene, postures):
                own, by_own = by_robot(robot, values, agent, posture)
                by_values += weight * own
                by_postures[agent.name] = by_own.times(weight)
            return by_values, by_postures

        return found

    driven = of_actuators and who is not people and by_robot is None
    return CaseQuantity(
        unit, of_all, slopes(by_torque), slopes(by_speed), posture_slopes(), robot_slopes(), driven
    )
