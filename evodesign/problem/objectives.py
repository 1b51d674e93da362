"""Objectives: pure functions of a design's results.

Adding one is a function here and a line in `QUANTITIES`, for a value of every case (a person with a load at
a height, undisturbed or not), or in `WHOLE`, for one of the design; the problem file then knows its name.
What does not exist (no posture, no reach) is absent, never large.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

import numpy as np

from evodesign.human.strength import largest_relative_torque
from evodesign.mechanics.balance import standing_height_of_mass
from evodesign.mechanics.scene import HUMAN, ROBOT, Scene
from evodesign.posture.results import AgentPosture
from evodesign.posture.terms.base import TORQUE_UNIT
from evodesign.posture.terms.paper_tasks import pressure_task
from evodesign.problem.aggregate import (
    WORST,
    CaseQuantity,
    ObjectiveKind,
    aggregate,
    undisturbed,
    values_over_cases,
)
from evodesign.problem.result import DesignResult
from evodesign.records import Objective

__all__ = [
    "HUMAN_EFFORT",
    "OBJECTIVES",
    "QUANTITIES",
    "SHARED_REACH",
    "objective_kind",
    "objective_value",
    "objective_values",
]


def robot_torque(scene: Scene, postures: Mapping[str, AgentPosture]) -> float:
    """The robot's |tau|_2 [N m] (paper, task t1)."""
    return postures[ROBOT].torque_norm


def human_torque(scene: Scene, postures: Mapping[str, AgentPosture]) -> float:
    """The person's |tau|_2 [N m] (paper, task t1)."""
    return postures[HUMAN].torque_norm


def peak_torque(scene: Scene, postures: Mapping[str, AgentPosture]) -> float:
    """The robot's largest |tau| over its limit, over the joints: 1 for a joint at its limit."""
    torques, limits = postures[ROBOT].torques, scene.robot.torque_limits
    return max(abs(torques[joint]) / limits[joint] for joint in scene.robot.joints)


def human_effort(scene: Scene, postures: Mapping[str, AgentPosture]) -> float:
    """The person's largest |torque| over the joint's strength in that direction; 1 is all that they have."""
    strain = largest_relative_torque(postures[HUMAN].torques, scene.human.strengths)
    return 0.0 if strain is None else strain.share


def reach_height(result: DesignResult) -> float | None:
    """Highest load that the robot can hold [m]."""
    return result.reach.highest


def shared_reach_height(result: DesignResult) -> float | None:
    """Highest load that the robot and all of the people can hold [m]."""
    if result.reach.highest is None or result.people_highest is None:
        return None
    return min(result.reach.highest, result.people_highest)


def mass(result: DesignResult) -> float:
    """Mass of the robot [kg]."""
    return float(sum(link.inertia.mass for link in result.tree.links))


def com_height(result: DesignResult) -> float:
    """Height of the robot's centre of mass above its soles, all joints at zero [m] (paper, task t4)."""
    return float(standing_height_of_mass(result.tree, tuple(result.robot.soles.values())))


def paper_cost(result: DesignResult) -> float | None:
    """W1 t1 + W3 t3 of all heights + W2 t2 + W4 t4 [(10 N m)^2], the paper's scalar cost (Eq. 14)."""
    result = undisturbed(result)
    robot, human = values_over_cases(robot_torque, result), values_over_cases(human_torque, result)
    if robot is None or human is None:
        return None
    efforts, tasks = result.paper.efforts, result.paper.tasks
    strain = efforts.robot * np.square(robot) + efforts.human * np.square(human)
    cost = tasks.weights.torque * strain.sum() / TORQUE_UNIT**2
    cost += tasks.of_design(result.space, result.values, result.robot, result.tree)
    if tasks.weights.center_of_pressure:
        feet = [posture.foot_wrenches for height in result.heights for posture in height.postures.values()]
        cost += tasks.weights.center_of_pressure * sum(pressure_task(wrenches) for wrenches in feet)
    return float(cost)


HUMAN_EFFORT = "human_effort"
"""The quantity that needs people of known strength."""

QUANTITIES: Mapping[str, CaseQuantity] = {
    "robot_torque": CaseQuantity("N m", robot_torque),
    "human_torque": CaseQuantity("N m", human_torque),
    "peak_torque": CaseQuantity("1", peak_torque),
    HUMAN_EFFORT: CaseQuantity("1", human_effort),
}
"""Values of single cases; an objective is the mean of one, or its `worst_` or `q90_`."""

SHARED_REACH = "shared_reach_height"

WHOLE: Mapping[str, ObjectiveKind] = {
    "reach_height": ObjectiveKind("m", reach_height),
    SHARED_REACH: ObjectiveKind("m", shared_reach_height),
    "mass": ObjectiveKind("kg", mass),
    "com_height": ObjectiveKind("m", com_height),
    "paper_cost": ObjectiveKind("(10 N m)^2", paper_cost),
}
"""Values of a design as a whole."""

OBJECTIVES: Mapping[str, ObjectiveKind] = {
    **{
        f"{over}{name}": aggregate(quantity, over)
        for over in ("", WORST)
        for name, quantity in QUANTITIES.items()
    },
    **WHOLE,
}
"""Objectives by name; quantiles, of which there are many, are left to `objective_kind`."""


def objective_kind(name: str) -> ObjectiveKind | None:
    """The objective of a name, such as `robot_torque`, `worst_robot_torque` or `q90_robot_torque`."""
    quantile = re.fullmatch(r"(q[1-9]\d?_)(.+)", name)
    if quantile is None or quantile[2] not in QUANTITIES:
        return OBJECTIVES.get(name)
    return aggregate(QUANTITIES[quantile[2]], quantile[1])


def objective_values(objectives: Sequence[Objective], result: DesignResult) -> dict[str, float]:
    """Natural values of a problem's objectives, by name, without those that do not exist."""
    found = {objective.name: objective_value(objective.name, result) for objective in objectives}
    return {name: value for name, value in found.items() if value is not None}


def objective_value(name: str, result: DesignResult) -> float | None:
    """An objective's value; None where it does not exist.

    Raises:
        KeyError: no objective has this name.
    """
    kind = objective_kind(name)
    if kind is None:
        raise KeyError(name)
    return kind.value(result)
