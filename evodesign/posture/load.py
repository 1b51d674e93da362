"""The load's part of a program: it is level, still, and held by up to four hands.

    sum_i f_i + (0, 0, -m g) = 0        sum_i (r_i x f_i + n_i) + c x (0, 0, -m g) = 0

with f_i and n_i the force and moment of hand i on the load (no moment with `point` grasps, as in the paper),
r_i its grasp point and c the centre of mass, both from the box's centre. Where the robot's share s is given,
its hands carry s m g. Where rigid grasps leave it free, it lies between 0 and 1: without that bound the best
posture lifts the partner by the load with hundreds of newtons.

Source: Sartore et al. 2022, Eq. 8, third row at rest.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np

from evodesign.posture.program import Constraint
from evodesign.statics.balance import GRAVITY
from evodesign.statics.scene import SIDES, Agent, Grasp, Scene
from evodesign.tree.kinematics import vector

__all__ = ["any_load", "load_constraints", "push_of"]

Expression = Any

LOAD_UNIT = 10.0  # [N] and [N m] per unit of the load's balance rows


def any_load(scene: Scene) -> tuple[Scene, Expression]:
    """A scene whose load has any mass, and that mass [kg] as a symbol: a parameter of its programs."""
    mass = ca.SX.sym("mass")
    return replace(scene, payload=replace(scene.payload, mass=mass)), mass


def turned_to_world(agent: Agent, in_agent: Expression) -> Expression:
    """A vector in world axes from one in the agent's frame, which is turned about z by 0 or 180 degrees."""
    return in_agent * ca.DM([agent.sign, agent.sign, 1.0])


def push_of(robot: Agent, hand_wrenches: Mapping[str, Expression]) -> Expression:
    """Horizontal force of the robot on the load, towards the person [N].

    Args:
        robot: the agent.
        hand_wrenches: on its hands, in its frame, by side.
    """
    return sum(-turned_to_world(robot, wrench[:3])[0] for wrench in hand_wrenches.values())


def load_constraints(
    scene: Scene, hand_wrenches: Mapping[str, Mapping[str, Expression]], *, symmetric: bool
) -> tuple[Constraint, ...]:
    """Balance of the load, the bound on the push between the agents, and the robot's share where it is given.

    Args:
        scene: agents and load.
        hand_wrenches: force [N] and moment [N m] on each hand in its agent's frame, by agent name and side.
        symmetric: whether right hands mirror left ones, so that three of the six rows vanish by themselves.
    """
    weight = ca.vertcat(0.0, 0.0, -GRAVITY * scene.payload.mass)
    force: Expression = weight
    moment: Expression = ca.cross(vector(scene.payload.center_of_mass), weight)
    for agent in (scene.robot, scene.human):
        for side in SIDES:
            wrench = hand_wrenches[agent.name][side]
            on_load = -turned_to_world(agent, wrench[:3])
            point = turned_to_world(agent, vector(scene.payload.grasp_point(agent, side)))
            force = force + on_load
            moment = moment + ca.cross(point, on_load) - turned_to_world(agent, wrench[3:])
    rows = ca.vertcat(force, moment)[[0, 2, 4]] if symmetric else ca.vertcat(force, moment)
    push = push_of(scene.robot, hand_wrenches[scene.robot.name])
    limit = scene.stance.push / LOAD_UNIT
    constraints = [
        Constraint("load.balance", rows / LOAD_UNIT, 0.0, 0.0),
        Constraint("load.push", push / LOAD_UNIT, -limit, limit),
    ]
    carried = -sum(wrench[2] for wrench in hand_wrenches[scene.robot.name].values())
    whole = GRAVITY * scene.payload.mass
    if scene.robot_share is not None:
        missing = (carried - scene.robot_share * whole) / LOAD_UNIT
        constraints.append(Constraint("load.share", missing, 0.0, 0.0))
    elif scene.payload.grasp is Grasp.RIGID:
        parts = ca.vertcat(carried, whole - carried) / LOAD_UNIT
        constraints.append(Constraint("load.share", parts, 0.0, np.inf))
    return tuple(constraints)
