"""One agent's part of a posture program: its variables, constraints and effort.

Everything is expressed in the agent's own frame (it looks along +x at the load above the origin), so robot
and person share every line. Joint torques are lifted: they are variables tied to the statics by equalities,
which keeps the Hessian sparse (DESIGN 3).

Constraints are those of the paper's Eq. 14 (c to g: hands on the load, feet on the ground and flat), made
well posed: "flat" is two vanishing entries of the sole's rotation rather than one entry equal to one, and
joint limits, unilateral contact, friction and the stance are enforced.

Source: Sartore et al. 2022, Eq. 14; DESIGN 3.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from evodesign.posture.program import Constraint, Variable
from evodesign.statics.balance import AppliedWrench, cut
from evodesign.statics.contact import foot_margins
from evodesign.statics.scene import SIDES, Agent, Grasp, Scene
from evodesign.tree.kinematics import Pose, euler_rotation, forward, vector
from evodesign.tree.model import Tree

__all__ = ["GRASP_ROWS", "AgentBlock", "agent_block", "hand_wrench"]

Expression = Any

TORQUE_UNIT = 10.0  # [N m] per unit of a lifted torque
FORCE_UNIT = 100.0  # [N] per unit of a foot wrench
HAND_UNIT = 10.0  # [N] per unit of a hand force, [N m] per unit of a hand moment

GRASP_ROWS = {Grasp.POINT: 3, Grasp.RIGID: 6}
"""Numbers of a hand's wrench that are free: a force, or a force and a moment."""


@dataclass(frozen=True, slots=True)
class AgentBlock:
    """An agent's part of a program.

    Args:
        variables: base, joints, wrenches and torques.
        constraints: everything that binds the agent alone, given the grasp points.
        hand_wrenches: force [N] and moment about the grasp point [N m] on the hand by side, agent's frame;
            the load feels their negative.
        torques: lifted joint torques [N m], in the order of the agent's joints.
        comfort: small convex cost that makes the posture unique where torques do not.
    """

    variables: tuple[Variable, ...]
    constraints: tuple[Constraint, ...]
    hand_wrenches: Mapping[str, Expression]
    torques: Expression
    comfort: Expression


def agent_block(agent: Agent, tree: Tree, scene: Scene, height: Expression) -> AgentBlock:
    """Variables, constraints and effort of one agent.

    Args:
        agent: names and limits.
        tree: the agent's tree, resized by a design; numbers or expressions.
        scene: load, ground and stance.
        height: of the load's centre above the ground [m].
    """
    variables = _variables(agent, scene)
    values = {variable.name.split(".", 1)[1]: variable.value for variable in variables}
    base = Pose(euler_rotation(values["base_angles"]), values["base_position"])
    positions = {name: values["joints"][i] for i, name in enumerate(agent.joints)}
    poses = forward(tree, base, positions)
    hands = {side: hand_wrench(values[f"{side}_hand"]) for side in SIDES}
    feet = {side: values[f"{side}_foot"] for side in SIDES}
    balance = cut(tree, poses, _applied(agent, poses, hands, feet))
    statics = ca.vertcat(*[balance.torques[name] for name in agent.joints])
    constraints = [
        *_hands(agent, poses, scene, height),
        *_feet(agent, poses, feet, scene),
        *_stance(agent, poses, scene),
        _equal(f"{agent.name}.torques", (statics - values["torques"]) / TORQUE_UNIT),
        _equal(f"{agent.name}.force", balance.force / FORCE_UNIT),
        _equal(f"{agent.name}.moment", balance.moment / TORQUE_UNIT),
    ]
    comfort = _comfort(agent, values, hands, feet)
    return AgentBlock(tuple(variables), tuple(constraints), hands, values["torques"], comfort)


def _variables(agent: Agent, scene: Scene) -> list[Variable]:
    name = agent.name
    tilt = scene.stance.base_tilt
    joints = [agent.tree.joint_by_name[joint] for joint in agent.joints]
    start = start_posture(agent, scene)
    blocks = [
        Variable.column(f"{name}.base_position", [-3.0, -0.5, 0.0], [0.0, 0.5, 3.0], start[0], 1.0),
        Variable.column(f"{name}.base_angles", [-tilt] * 3, [tilt] * 3, [0.0] * 3, 1.0),
        Variable.column(
            f"{name}.joints",
            [max(joint.lower, -math.pi) for joint in joints],
            [min(joint.upper, math.pi) for joint in joints],
            start[1],
            1.0,
        ),
    ]
    hand, foot, torque = [300.0] * GRASP_ROWS[scene.payload.grasp], [5000.0] * 6, [1000.0] * len(joints)
    rest = [0.0, 0.0, 300.0, 0.0, 0.0, 0.0]
    bounded = [
        *((f"{side}_hand", hand, [0.0] * len(hand), HAND_UNIT) for side in SIDES),
        *((f"{side}_foot", foot, rest, FORCE_UNIT) for side in SIDES),
        ("torques", torque, [0.0] * len(joints), TORQUE_UNIT),
    ]
    blocks += [
        Variable.column(f"{name}.{part}", [-x for x in limit], limit, begin, unit)
        for part, limit, begin, unit in bounded
    ]
    return blocks


def start_posture(agent: Agent, scene: Scene) -> tuple[list[float], list[float]]:
    """Base position [m] and joint positions [rad] from which a solve begins: standing, joints at zero."""
    origin = Pose(ca.DM.eye(3), ca.DM.zeros(3))
    poses = forward(agent.tree, origin, {})
    lowest = min(float(poses[frame].position[2]) for frame in agent.soles.values())
    back = scene.payload.size[0] / 2.0 + scene.stance.trunk_clearance + 0.1
    return [-back, 0.0, -lowest], [0.0] * len(agent.joints)


def hand_wrench(free: Expression) -> Expression:
    """Six rows from the free numbers of a grasp: a point grasp passes no moment."""
    return ca.vertcat(free, ca.DM.zeros(6 - free.numel()))


def _applied(
    agent: Agent, poses: Mapping[str, Pose], hands: Mapping[str, Expression], feet: Mapping[str, Expression]
) -> list[AppliedWrench]:
    applied = []
    for side in SIDES:
        hand, sole = poses[agent.hands[side]], poses[agent.soles[side]]
        applied.append(AppliedWrench(agent.hands[side], hand.position, hands[side][:3], hands[side][3:]))
        force, moment = sole.rotation @ feet[side][:3], sole.rotation @ feet[side][3:]
        applied.append(AppliedWrench(agent.soles[side], sole.position, force, moment))
    return applied


def _hands(agent: Agent, poses: Mapping[str, Pose], scene: Scene, height: Expression) -> list[Constraint]:
    lift = ca.vertcat(0.0, 0.0, height)
    return [
        _equal(
            f"{agent.name}.{side}_hand_on_load",
            poses[agent.hands[side]].position - vector(scene.payload.grasp_point(agent, side)) - lift,
        )
        for side in SIDES
    ]


def _feet(
    agent: Agent, poses: Mapping[str, Pose], feet: Mapping[str, Expression], scene: Scene
) -> list[Constraint]:
    constraints = []
    for side in SIDES:
        sole = poses[agent.soles[side]]
        level = ca.vertcat(sole.position[2], sole.rotation[0, 2], sole.rotation[1, 2])
        margins = ca.vertcat(*foot_margins(feet[side], agent.sole_size, scene.ground)) / FORCE_UNIT
        yaw = math.sin(scene.stance.foot_yaw)
        constraints += [
            _equal(f"{agent.name}.{side}_foot_flat", level),
            Constraint(f"{agent.name}.{side}_foot_contact", margins, 0.0, np.inf),
            Constraint(f"{agent.name}.{side}_foot_yaw", sole.rotation[1, 0], -yaw, yaw),
        ]
    return constraints


def _stance(agent: Agent, poses: Mapping[str, Pose], scene: Scene) -> list[Constraint]:
    stance = scene.stance
    left, right = (poses[agent.soles[side]].position for side in SIDES)
    nearest = -scene.payload.size[0] / 2.0 - stance.trunk_clearance
    trunk = ca.vertcat(*[poses[frame].position[0] for frame in agent.trunk])
    name = agent.name
    return [
        Constraint(f"{name}.feet_apart", left[1] - right[1], *stance.feet_apart),
        Constraint(f"{name}.feet_stagger", left[0] - right[0], -stance.feet_stagger, stance.feet_stagger),
        Constraint(f"{name}.trunk_clear", trunk, -np.inf, nearest),
    ]


def _comfort(
    agent: Agent,
    values: Mapping[str, Expression],
    hands: Mapping[str, Expression],
    feet: Mapping[str, Expression],
) -> Expression:
    joints = [agent.tree.joint_by_name[name] for name in agent.joints]
    ranges = [min(j.upper, math.pi) - max(j.lower, -math.pi) for j in joints]
    bent = values["joints"] / ca.DM(ranges)
    lateral = sum(ca.sumsqr(wrench[:2]) + ca.sumsqr(wrench[3:]) for wrench in hands.values()) / HAND_UNIT**2
    split = ca.sumsqr(feet["left"] - feet["right"]) / FORCE_UNIT**2
    return 1e-2 * (ca.sumsqr(bent) + ca.sumsqr(values["base_angles"]) + lateral + split)


def _equal(name: str, expression: Expression) -> Constraint:
    return Constraint(name, expression, 0.0, 0.0)
