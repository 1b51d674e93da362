"""Objectives: pure functions of a design's results.

Adding one is a function here and a line in `OBJECTIVES`; the problem file then knows its name. A function
gives None where its value does not exist (no posture, no reach): absent, never large.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from evodesign.design.space import DesignSpace
from evodesign.posture.bearing import TORQUE_UNIT
from evodesign.posture.joint import JointSettings
from evodesign.posture.reach import Reach
from evodesign.posture.solution import HeightSolution
from evodesign.posture.tasks import pressure_task
from evodesign.records import Objective
from evodesign.statics.balance import standing_height_of_mass
from evodesign.statics.scene import HUMAN, ROBOT, Agent
from evodesign.tree.model import Tree

__all__ = ["OBJECTIVES", "DesignResult", "ObjectiveKind", "objective_values"]


@dataclass(frozen=True, slots=True)
class DesignResult:
    """Everything that was computed of one design.

    Args:
        robot: the agent as the file describes it.
        space: design parameters.
        values: one number per design parameter.
        tree: the robot of the design.
        reach: interval of load heights that it can hold.
        heights: one solution per required height.
        paper: the paper's tasks and their weights.
    """

    robot: Agent
    space: DesignSpace
    values: Sequence[float]
    tree: Tree
    reach: Reach
    heights: tuple[HeightSolution, ...]
    paper: JointSettings


@dataclass(frozen=True, slots=True)
class ObjectiveKind:
    """An objective's unit and formula."""

    unit: str
    value: Callable[[DesignResult], float | None]


def _torque_norms(result: DesignResult, agent: str) -> list[float] | None:
    """Torque norm of an agent per required height [N m]; None unless all are solved."""
    if not all(height.solved for height in result.heights):
        return None
    return [height.postures[agent].torque_norm for height in result.heights]


def _mean_torque(result: DesignResult, agent: str) -> float | None:
    norms = _torque_norms(result, agent)
    return None if norms is None else float(np.mean(norms))


def _worst_torque(result: DesignResult, agent: str) -> float | None:
    norms = _torque_norms(result, agent)
    return None if norms is None else max(norms)


def robot_torque(result: DesignResult) -> float | None:
    """Mean over the required heights of the robot's |tau|_2 [N m] (paper, task t1)."""
    return _mean_torque(result, ROBOT)


def human_torque(result: DesignResult) -> float | None:
    """Mean over the required heights of the person's |tau|_2 [N m] (paper, task t1)."""
    return _mean_torque(result, HUMAN)


def worst_robot_torque(result: DesignResult) -> float | None:
    """Largest over the required heights of the robot's |tau|_2 [N m]."""
    return _worst_torque(result, ROBOT)


def worst_human_torque(result: DesignResult) -> float | None:
    """Largest over the required heights of the person's |tau|_2 [N m]."""
    return _worst_torque(result, HUMAN)


def reach_height(result: DesignResult) -> float | None:
    """Highest load that the robot can hold [m]."""
    return result.reach.highest


def mass(result: DesignResult) -> float:
    """Mass of the robot [kg]."""
    return float(sum(link.inertia.mass for link in result.tree.links))


def com_height(result: DesignResult) -> float:
    """Height of the robot's centre of mass above its soles, all joints at zero [m] (paper, task t4)."""
    return float(standing_height_of_mass(result.tree, tuple(result.robot.soles.values())))


def paper_cost(result: DesignResult) -> float | None:
    """W1 t1 + W3 t3 of all heights + W2 t2 + W4 t4 [(10 N m)^2], the paper's scalar cost (Eq. 14)."""
    robot, human = _torque_norms(result, ROBOT), _torque_norms(result, HUMAN)
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


OBJECTIVES: Mapping[str, ObjectiveKind] = {
    "robot_torque": ObjectiveKind("N m", robot_torque),
    "human_torque": ObjectiveKind("N m", human_torque),
    "worst_robot_torque": ObjectiveKind("N m", worst_robot_torque),
    "worst_human_torque": ObjectiveKind("N m", worst_human_torque),
    "reach_height": ObjectiveKind("m", reach_height),
    "mass": ObjectiveKind("kg", mass),
    "com_height": ObjectiveKind("m", com_height),
    "paper_cost": ObjectiveKind("(10 N m)^2", paper_cost),
}


def objective_values(objectives: Sequence[Objective], result: DesignResult) -> dict[str, float]:
    """Natural values of a problem's objectives, by name, without those that do not exist."""
    found = {objective.name: OBJECTIVES[objective.name].value(result) for objective in objectives}
    return {name: value for name, value in found.items() if value is not None}
