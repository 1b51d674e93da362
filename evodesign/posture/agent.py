"""One agent's part of a program: its variables, constraints and effort.

Everything is expressed in the agent's own frame (it looks along +x at the load above the origin), so robot
and person share every line, and so do whole agents and the halves of symmetric ones (`Form`). Joint torques
are lifted: they are variables tied to the statics by equalities, which keeps the Hessian sparse (DESIGN 3).

Source: Sartore et al. 2022, Eq. 14; DESIGN 3.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import casadi as ca

from evodesign.posture.constraints import equal, feet_constraints, hand_constraints, stance_constraints
from evodesign.posture.form import WRENCH, Form
from evodesign.posture.program import Constraint, Variable
from evodesign.statics.balance import AppliedWrench, cut
from evodesign.statics.scene import Agent, Grasp, Payload, Scene
from evodesign.tree.kinematics import Pose, euler_rotation, forward
from evodesign.tree.model import Tree

__all__ = ["COMFORT", "GRASP_ROWS", "AgentBlock", "agent_block", "hand_limits", "hand_wrench"]

Expression = Any

TORQUE_UNIT = 10.0  # [N m] per unit of a lifted torque
FORCE_UNIT = 100.0  # [N] per unit of a foot wrench
HAND_UNIT = 10.0  # [N] per unit of a hand force, [N m] per unit of a hand moment
COMFORT = 1e-2
STRONGEST = 300.0  # [N] and [N m] of a hand, beyond any holding posture

GRASP_ROWS = {Grasp.POINT: 3, Grasp.RIGID: 6}
"""Numbers of a hand's wrench that are free: a force, or a force and a moment."""


@dataclass(frozen=True, slots=True)
class AgentBlock:
    """An agent's part of a program.

    Args:
        variables: base, joints, wrenches and torques of the form.
        constraints: everything that binds the agent alone, given the grasp points.
        hand_wrenches: force [N] and moment about the grasp point [N m] on both hands by side, agent's frame;
            the load feels their negative.
        effort: squared norm of all the agent's torques [N^2 m^2], the mirrored ones included.
        posture_comfort: small convex cost that makes the posture unique where torques do not.
        wrench_comfort: likewise for the wrenches.
        uprights: z_sole . z by side; 1 for a flat foot, -1 for one upside down, which joint limits rule out.
    """

    variables: tuple[Variable, ...]
    constraints: tuple[Constraint, ...]
    hand_wrenches: Mapping[str, Expression]
    effort: Expression
    posture_comfort: Expression
    wrench_comfort: Expression
    uprights: Mapping[str, Expression]

    @property
    def comfort(self) -> Expression:
        """Both comforts together."""
        return self.posture_comfort + self.wrench_comfort


def agent_block(form: Form, tree: Tree, scene: Scene, height: Expression) -> AgentBlock:
    """Variables, constraints and effort of one agent.

    Args:
        form: all of the agent, or its left half.
        tree: the agent's whole tree, resized by a design; numbers or expressions.
        scene: load, ground and stance.
        height: of the load's centre above the ground [m].
    """
    agent = form.agent
    variables = _variables(form, scene)
    values = {variable.name.split(".", 1)[1]: variable.value for variable in variables}
    part, doubled = form.part(tree)
    base = Pose(euler_rotation(values["base_angles"]), values["base_position"])
    positions = {name: values["joints"][i] for i, name in enumerate(form.joints)}
    poses = forward(part, base, positions)
    hands = {side: hand_wrench(values[f"{side}_hand"]) for side in form.sides}
    feet = {side: values[f"{side}_foot"] for side in form.sides}
    balance = cut(part, poses, _applied(agent, poses, hands, feet), doubled)
    statics = ca.vertcat(*[balance.torques[name] for name in form.joints])
    force, moment = balance.force / FORCE_UNIT, balance.moment / TORQUE_UNIT
    if form.mirror is not None:  # the other rows vanish by symmetry
        force, moment = force[[0, 2]], moment[1]
        hands["right"] = hands["left"] * ca.DM(WRENCH)
    constraints = [
        *hand_constraints(form, poses, scene, height),
        *feet_constraints(form, poses, feet, scene),
        *stance_constraints(form, poses, scene),
        equal(f"{agent.name}.torques", (statics - values["torques"]) / TORQUE_UNIT),
        equal(f"{agent.name}.force", force),
        equal(f"{agent.name}.moment", moment),
    ]
    effort = ca.dot(ca.DM(list(form.counts)), values["torques"] ** 2)
    return AgentBlock(
        variables=tuple(variables),
        constraints=tuple(constraints),
        hand_wrenches=hands,
        effort=effort,
        posture_comfort=_posture_comfort(form, values),
        wrench_comfort=_wrench_comfort(form, hands, feet),
        uprights={side: poses[form.agent.soles[side]].rotation[2, 2] for side in form.sides},
    )


def _variables(form: Form, scene: Scene) -> list[Variable]:
    name, tilt = form.agent.name, scene.stance.base_tilt
    joints = [form.agent.tree.joint_by_name[joint] for joint in form.joints]
    sideways, turn = (0.0, 0.0) if form.mirror else (0.5, tilt)  # none in a symmetric posture
    farthest, nearest = [-3.0, -sideways, 0.0], [0.0, sideways, 3.0]
    standing = _standing(form.agent, scene)
    blocks = [
        Variable.column(f"{name}.base_position", farthest, nearest, standing, 1.0),
        Variable.column(f"{name}.base_angles", [-turn, -tilt, -turn], [turn, tilt, turn], [0.0] * 3, 1.0),
        Variable.column(
            f"{name}.joints",
            [max(joint.lower, -math.pi) for joint in joints],
            [min(joint.upper, math.pi) for joint in joints],
            [0.0] * len(joints),
            1.0,
        ),
    ]
    hand, foot, torque = hand_limits(scene.payload), [5000.0] * 6, [1000.0] * len(joints)
    rest = [0.0, 0.0, 300.0, 0.0, 0.0, 0.0]
    bounded = [
        *((f"{side}_hand", hand, [0.0] * len(hand), HAND_UNIT) for side in form.sides),
        *((f"{side}_foot", foot, rest, FORCE_UNIT) for side in form.sides),
        ("torques", torque, [0.0] * len(joints), TORQUE_UNIT),
    ]
    blocks += [
        Variable.column(f"{name}.{part}", [-x for x in limit], limit, begin, unit)
        for part, limit, begin, unit in bounded
    ]
    return blocks


def _standing(agent: Agent, scene: Scene) -> list[float]:
    """Base position [m] from which a solve begins: soles on the ground with all joints at zero."""
    poses = forward(agent.tree, Pose(ca.DM.eye(3), ca.DM.zeros(3)), {})
    lowest = min(float(poses[frame].position[2]) for frame in agent.soles.values())
    back = scene.payload.size[0] / 2.0 + scene.stance.trunk_clearance + 0.1
    return [-back, 0.0, -lowest]


def hand_limits(payload: Payload) -> list[float]:
    """Largest size of each free number of a hand's wrench [N, N m]."""
    moment = min(STRONGEST, payload.hand_moment)
    return ([STRONGEST] * 3 + [moment] * 3)[: GRASP_ROWS[payload.grasp]]


def hand_wrench(free: Expression) -> Expression:
    """Six rows from the free numbers of a grasp: a point grasp passes no moment."""
    return ca.vertcat(free, ca.DM.zeros(6 - free.numel()))


def _applied(
    agent: Agent, poses: Mapping[str, Pose], hands: Mapping[str, Expression], feet: Mapping[str, Expression]
) -> list[AppliedWrench]:
    applied = []
    for side in feet:
        hand, sole = poses[agent.hands[side]], poses[agent.soles[side]]
        applied.append(AppliedWrench(agent.hands[side], hand.position, hands[side][:3], hands[side][3:]))
        force, moment = sole.rotation @ feet[side][:3], sole.rotation @ feet[side][3:]
        applied.append(AppliedWrench(agent.soles[side], sole.position, force, moment))
    return applied


def _posture_comfort(form: Form, values: Mapping[str, Expression]) -> Expression:
    """Bent joints and a tilted base, slightly disliked."""
    joints = [form.agent.tree.joint_by_name[name] for name in form.joints]
    ranges = [min(j.upper, math.pi) - max(j.lower, -math.pi) for j in joints]
    bent = ca.dot(ca.DM(list(form.counts)), (values["joints"] / ca.DM(ranges)) ** 2)
    return COMFORT * (bent + ca.sumsqr(values["base_angles"]))


def _wrench_comfort(
    form: Form, hands: Mapping[str, Expression], feet: Mapping[str, Expression]
) -> Expression:
    """Sideways and twisting hands and unequal feet, slightly disliked."""
    lateral = sum(ca.sumsqr(wrench[:2]) + ca.sumsqr(wrench[3:]) for wrench in hands.values()) / HAND_UNIT**2
    split = ca.sumsqr(feet["left"] - feet["right"]) / FORCE_UNIT**2 if form.mirror is None else 0.0
    return COMFORT * (lateral + split)
