"""The load's part of a program: it is level, still, and held by up to four hands.

    sum_i f_i + (0, 0, -m g) = 0        sum_i r_i x f_i = 0

with f_i the force of hand i on the load and r_i its grasp point from the load's centre of mass. Hands pass
forces, not moments (`point` grasps, as in the paper).

Source: Sartore et al. 2022, Eq. 8, third row at rest.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import casadi as ca

from evodesign.posture.program import Constraint
from evodesign.statics.balance import GRAVITY
from evodesign.statics.scene import SIDES, Agent, Scene
from evodesign.tree.kinematics import vector

__all__ = ["force_on_load", "load_constraints", "push_between"]

Expression = Any

LOAD_UNIT = 10.0  # [N] and [N m] per unit of the load's balance rows


def force_on_load(agent: Agent, hand_force: Expression) -> Expression:
    """Force on the load in world axes [N] from the force on a hand in the agent's frame."""
    return -hand_force * ca.DM([agent.sign, agent.sign, 1.0])


def push_between(robot: Agent, hand_forces: Mapping[str, Expression]) -> Expression:
    """Horizontal force of the robot on the load, towards the person [N]."""
    return sum(force_on_load(robot, hand_forces[side])[0] for side in SIDES)


def load_constraints(
    scene: Scene, hand_forces: Mapping[str, Mapping[str, Expression]]
) -> tuple[Constraint, ...]:
    """Balance of the load and the bound on the push between the agents.

    Args:
        scene: agents and load.
        hand_forces: force on each hand in its agent's frame [N], by agent name and side.
    """
    force: Expression = ca.vertcat(0.0, 0.0, -GRAVITY * scene.payload.mass)
    moment: Expression = ca.DM.zeros(3)
    for agent in (scene.robot, scene.human):
        turn = ca.DM([agent.sign, agent.sign, 1.0])
        for side in SIDES:
            on_load = force_on_load(agent, hand_forces[agent.name][side])
            force = force + on_load
            moment = moment + ca.cross(vector(scene.payload.grasp(side)) * turn, on_load)
    push = push_between(scene.robot, hand_forces[scene.robot.name])
    return (
        Constraint("load.balance", ca.vertcat(force, moment) / LOAD_UNIT, 0.0, 0.0),
        Constraint(
            "load.push", push / LOAD_UNIT, -scene.stance.push / LOAD_UNIT, scene.stance.push / LOAD_UNIT
        ),
    )
