"""What a standing agent bears: wrenches on hands and feet, and the joint torques that go with them.

One posture may have to bear several things, each with wrenches and torques of its own. Joint torques are
lifted: they are variables tied to the statics by equalities, which keeps the Hessian sparse (DESIGN 3).

Source: Sartore et al. 2022, Eq. 14 b; DESIGN 2 and 3.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca

from evodesign.mechanics.balance import AppliedWrench, cut
from evodesign.mechanics.scene import Agent, Grasp, Payload, Scene
from evodesign.nlp.program import Constraint, Variable
from evodesign.posture.symmetry import WRENCH, Form
from evodesign.posture.terms.floating_base import COMFORT, Stand
from evodesign.posture.terms.stance import equal, foot_contact
from evodesign.tree.kinematics import Pose

__all__ = [
    "FORCE_UNIT",
    "GRASP_ROWS",
    "HAND_UNIT",
    "TORQUE_UNIT",
    "Bearing",
    "bear",
    "hand_limits",
    "hand_wrench",
]

Expression = Any

TORQUE_UNIT = 10.0  # [N m] per unit of a lifted torque
FORCE_UNIT = 100.0  # [N] per unit of a foot wrench
STRONGEST = 300.0  # [N] and [N m] of a hand, beyond any holding posture
HAND_UNIT = 10.0  # [N] per unit of a hand force, [N m] per unit of a hand moment
LARGEST_TORQUE = 1000.0  # [N m]; bounds a joint without a limit

GRASP_ROWS = {Grasp.POINT: 3, Grasp.RIGID: 6}
"""Numbers of a hand's wrench that are free: a force, or a force and a moment."""


@dataclass(frozen=True, slots=True)
class Bearing:
    """The part of a program that says what an agent bears.

    Args:
        variables: wrenches and torques of the form.
        contact: constraints on what each foot may pass to the ground, by side.
        balance: constraints of equilibrium.
        hand_wrenches: force [N] and moment about the grasp point [N m] on both hands by side, agent's frame;
            the load feels their negative.
        effort: squared norm of all the agent's torques [N^2 m^2], the mirrored ones included.
        comfort: small convex cost that makes wrenches unique where torques do not.
    """

    variables: tuple[Variable, ...]
    contact: Mapping[str, Constraint]
    balance: tuple[Constraint, ...]
    hand_wrenches: Mapping[str, Expression]
    effort: Expression
    comfort: Expression


def bear(stand: Stand, scene: Scene, prefix: str = "", pushes: Sequence[AppliedWrench] = ()) -> Bearing:
    """Variables and constraints of what an agent bears.

    Args:
        stand: how it stands.
        scene: load and ground.
        prefix: begins the names of variables and constraints, where the agent bears more than one thing.
        pushes: external wrenches on the agent beside those on hands and feet, in its own frame.
    """
    form, poses = stand.form, stand.poses
    name = f"{prefix}{form.agent.name}"
    variables = _variables(form, scene, name)
    values = {variable.name.removeprefix(f"{name}."): variable.value for variable in variables}
    hands = {side: hand_wrench(values[f"{side}_hand"]) for side in form.sides}
    feet = {side: values[f"{side}_foot"] for side in form.sides}
    applied = [*_applied(form.agent, poses, hands, feet), *pushes]
    balance = cut(stand.part, poses, applied, stand.doubled)
    statics = ca.vertcat(*[balance.torques[joint] for joint in form.joints])
    force, moment = balance.force / FORCE_UNIT, balance.moment / TORQUE_UNIT
    if form.mirror is not None:  # the other rows vanish by symmetry
        force, moment = force[[0, 2]], moment[1]
        hands["right"] = hands["left"] * ca.DM(WRENCH)
    return Bearing(
        variables=variables,
        contact={side: foot_contact(name, side, feet[side], form.agent, scene) for side in form.sides},
        balance=(
            equal(f"{name}.torques", (statics - values["torques"]) / TORQUE_UNIT),
            equal(f"{name}.force", force),
            equal(f"{name}.moment", moment),
        ),
        hand_wrenches=hands,
        effort=ca.dot(ca.DM(list(form.counts)), values["torques"] ** 2),
        comfort=_comfort(form, hands, feet),
    )


def _variables(form: Form, scene: Scene, name: str) -> tuple[Variable, ...]:
    """Wrenches on hands and feet, and torques."""
    hand, foot, torque = hand_limits(scene.payload), [5000.0] * 6, _torque_bounds(form)
    rest = [0.0, 0.0, 300.0, 0.0, 0.0, 0.0]
    bounded = [
        *((f"{side}_hand", hand, [0.0] * len(hand), HAND_UNIT) for side in form.sides),
        *((f"{side}_foot", foot, rest, FORCE_UNIT) for side in form.sides),
        ("torques", torque, [0.0] * len(torque), TORQUE_UNIT),
    ]
    return tuple(
        Variable.column(f"{name}.{part}", [-x for x in limit], limit, begin, unit)
        for part, limit, begin, unit in bounded
    )


def hand_limits(payload: Payload) -> list[float]:
    """Largest size of each free number of a hand's wrench [N, N m]."""
    moment = min(STRONGEST, payload.hand_moment)
    return ([STRONGEST] * 3 + [moment] * 3)[: GRASP_ROWS[payload.grasp]]


def _torque_bounds(form: Form) -> list[float]:
    """Largest torque of each of the form's joints [N m]; a pair bears what its weaker joint does."""
    limits = form.agent.torque_limits if form.agent.limits_torques else {}
    pairs = {name: name for name in form.joints} if form.mirror is None else form.mirror.joints
    return [
        min(LARGEST_TORQUE, *(limits.get(joint, LARGEST_TORQUE) for joint in (name, pairs[name])))
        for name in form.joints
    ]


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


def _comfort(form: Form, hands: Mapping[str, Expression], feet: Mapping[str, Expression]) -> Expression:
    """Sideways and twisting hands and unequal feet, slightly disliked."""
    lateral = sum(ca.sumsqr(wrench[:2]) + ca.sumsqr(wrench[3:]) for wrench in hands.values()) / HAND_UNIT**2
    split = ca.sumsqr(feet["left"] - feet["right"]) / FORCE_UNIT**2 if form.mirror is None else 0.0
    return COMFORT * (lateral + split)
