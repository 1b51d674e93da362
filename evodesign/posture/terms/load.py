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

from evodesign.mechanics.balance import GRAVITY
from evodesign.mechanics.disturbance import Disturbance, PushedAt
from evodesign.mechanics.scene import SIDES, Agent, Grasp, Scene
from evodesign.nlp.program import Constraint
from evodesign.tree.kinematics import vector

__all__ = ["any_load", "disturbed_load_constraints", "load_constraints", "push_of", "turned_to_world"]

Expression = Any

LOAD_UNIT = 10.0  # [N] and [N m] per unit of the load's balance rows


def any_load(scene: Scene) -> tuple[Scene, Expression]:
    """A scene whose load has any mass, and that mass [kg] as a symbol: a parameter of its programs."""
    mass = ca.SX.sym("mass")
    return replace(scene, payload=replace(scene.payload, mass=mass)), mass


def turned_to_world(agent: Agent, in_agent: Expression) -> Expression:
    """A vector in world axes from one in the agent's frame, which is turned about z by 0 or 180 degrees."""
    return in_agent * ca.DM([agent.sign, agent.sign, 1.0])


def push_of(agent: Agent, hand_wrenches: Mapping[str, Expression]) -> Expression:
    """Force of an agent on the load along the world's x, from the robot towards the person [N].

    Args:
        agent: robot or person.
        hand_wrenches: on its hands, in its frame, by side.
    """
    return sum(-turned_to_world(agent, wrench[:3])[0] for wrench in hand_wrenches.values())


def internal_force(scene: Scene, hand_wrenches: Mapping[str, Mapping[str, Expression]]) -> Expression:
    """How hard the agents push against each other [N].

        (X_robot - X_human) / 2        X an agent's force on the load along the world's x

    is the robot's push where nobody else pushes the load; a push from outside leaves it as it is when both
    bear half of that.

    Args:
        scene: agents.
        hand_wrenches: by agent name and side, in the agents' frames.
    """
    forces = [push_of(agent, hand_wrenches[agent.name]) for agent in (scene.robot, scene.human)]
    return (forces[0] - forces[1]) / 2.0


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
    rows = _unbalanced(scene, hand_wrenches, weight, weight, symmetric=symmetric)
    push = push_of(scene.robot, hand_wrenches[scene.robot.name])
    carried = _carried(hand_wrenches[scene.robot.name])
    return _constraints(scene, rows, push, carried, -weight[2], "")


def disturbed_load_constraints(
    scene: Scene,
    disturbance: Disturbance,
    hand_wrenches: Mapping[str, Mapping[str, Expression]],
    prefix: str,
    *,
    symmetric: bool,
) -> tuple[Constraint, ...]:
    """Balance of a load under a disturbance, and the bound on how hard the agents push against each other.

    Args:
        scene: agents and load, undisturbed.
        disturbance: what happens to them.
        hand_wrenches: as for `load_constraints`.
        prefix: begins the constraints' names.
        symmetric: as for `load_constraints`.
    """
    scene = replace(scene, payload=scene.payload.disturbed(disturbance))
    weight = ca.vertcat(0.0, 0.0, -GRAVITY * scene.payload.mass)
    push = vector(disturbance.push_on(PushedAt.LOAD))
    rows = _unbalanced(scene, hand_wrenches, weight + push, weight, symmetric=symmetric)
    squeeze, carried = internal_force(scene, hand_wrenches), _carried(hand_wrenches[scene.robot.name])
    return _constraints(scene, rows, squeeze, carried, -(weight + push)[2], prefix)


def _carried(hand_wrenches: Mapping[str, Expression]) -> Expression:
    """Upward force of an agent's hands on the load [N]."""
    return -sum(wrench[2] for wrench in hand_wrenches.values())


def _unbalanced(
    scene: Scene,
    hand_wrenches: Mapping[str, Mapping[str, Expression]],
    force: Expression,
    weight: Expression,
    *,
    symmetric: bool,
) -> Expression:
    """Sum of forces [N] and moments about the box's centre [N m] on the load.

    Args:
        scene: agents and load.
        hand_wrenches: by agent name and side, in the agents' frames.
        force: of everything but hands, [N].
        weight: the part of it that acts at the centre of mass; the rest acts at the box's centre.
        symmetric: whether rows that vanish by themselves are left out.
    """
    moment: Expression = ca.cross(vector(scene.payload.center_of_mass), weight)
    for agent in (scene.robot, scene.human):
        for side in SIDES:
            wrench = hand_wrenches[agent.name][side]
            on_load = -turned_to_world(agent, wrench[:3])
            point = turned_to_world(agent, vector(scene.payload.grasp_point(agent, side)))
            force = force + on_load
            moment = moment + ca.cross(point, on_load) - turned_to_world(agent, wrench[3:])
    return ca.vertcat(force, moment)[[0, 2, 4]] if symmetric else ca.vertcat(force, moment)


def _constraints(
    scene: Scene, rows: Expression, push: Expression, carried: Expression, whole: Expression, prefix: str
) -> tuple[Constraint, ...]:
    """The constraints of a load.

    Args:
        scene: limits and shares.
        rows: what must vanish, [N] and [N m].
        push: between the agents [N].
        carried: by the robot, upwards [N].
        whole: what both must carry [N].
        prefix: begins the constraints' names.
    """
    limit = scene.stance.push / LOAD_UNIT
    balanced = (
        Constraint(f"{prefix}load.balance", rows / LOAD_UNIT, 0.0, 0.0),
        Constraint(f"{prefix}load.push", push / LOAD_UNIT, -limit, limit),
    )
    if scene.robot_share is not None:
        missing = (carried - scene.robot_share * whole) / LOAD_UNIT
        return (*balanced, Constraint(f"{prefix}load.share", missing, 0.0, 0.0))
    if scene.payload.grasp is Grasp.RIGID:
        parts = ca.vertcat(carried, whole - carried) / LOAD_UNIT
        return (*balanced, Constraint(f"{prefix}load.share", parts, 0.0, np.inf))
    return balanced
