"""Joint torques and equilibrium: what hands, feet, weights and pushes ask of the joints.

    tau = g_joint(q, pi) - J_joint^T f        0 = g_base(q, pi) - J_base^T f

Torques are variables tied to the statics by equalities, which keeps the Hessian sparse. Where a design
chooses actuators, |tau| <= rated torque are rows that depend on the design, so that one program serves every
actuator and tangents know of the limits. The rows come from
cutting the tree; the residuals from pinocchio's Jacobians and `nonLinearEffects` at rest.

Source: Sartore et al. 2022, Eq. 14 b and Eq. 5 at rest; docs/model.md.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from evodesign.mechanics.agent import Agent
from evodesign.mechanics.balance import AppliedWrench, cut
from evodesign.mechanics.floating_base import ROOT, BodyState
from evodesign.mechanics.scene import Scene
from evodesign.posture.results import AgentPosture
from evodesign.posture.symmetry import Form
from evodesign.posture.terms.base import (
    FORCE_UNIT,
    TORQUE_UNIT,
    Body,
    BodyTerm,
    Bound,
    Expression,
    MeasuredBody,
    Residual,
    Row,
    Unknown,
    both_ways,
)
from evodesign.posture.terms.load import turned_to_agent
from evodesign.tree.equip import rated_torques
from evodesign.tree.kinematics import vector

Array = NDArray[np.float64]

LARGEST_TORQUE = 1000.0  # [N m]; bounds a joint without a limit

LIMITS_KEY = "robot.torque_limits_n_m"
"""Where a problem file has torque limits in place of the URDF's."""


def unknowns(form: Form, scene: Scene) -> Iterator[Unknown]:
    """The torques of the form's joints [N m]; a pair exerts what its weaker joint can."""
    limits = form.agent.torque_limits if form.agent.limits_torques else {}
    pairs = {name: name for name in form.joints} if form.mirror is None else form.mirror.joints
    most = [
        min(LARGEST_TORQUE, *(limits.get(joint, LARGEST_TORQUE) for joint in (name, pairs[name])))
        for name in form.joints
    ]
    least, rest = [-x for x in most], [0.0] * len(most)
    pairs_of_bounds = [
        both_ways(Bound("torque limit", limit, "N m", True, key=LIMITS_KEY, part=form.words_of(name)))
        for name, limit in zip(form.joints, most, strict=True)
    ]
    below, above = zip(*pairs_of_bounds, strict=True)
    asked = Unknown("torques", least, most, rest, TORQUE_UNIT, labels=form.joints)
    yield replace(asked, least=below, most=above)


def effort(body: Body) -> Expression:
    """Squared norm of all the agent's torques [N^2 m^2], the mirrored ones included (task t1)."""
    return ca.dot(ca.DM(list(body.form.counts)), body.values["torques"] ** 2)


def rows(body: Body) -> Iterator[Row]:
    """Torques that are those of statics, and a base on which force and moment vanish."""
    form = body.form
    applied = [*_contacts(body), *_push(body), *body.inertial]
    balance = cut(body.part, body.poses, applied, body.doubled)
    statics = ca.vertcat(*[balance.torques[name] + body.reflected.get(name, 0.0) for name in form.joints])
    force, moment = balance.force / FORCE_UNIT, balance.moment / TORQUE_UNIT
    if form.mirror is not None:  # the other rows vanish by symmetry
        force, moment = force[[0, 2]], moment[1]
    lifted = (statics - body.values["torques"]) / TORQUE_UNIT
    yield Row("torques", lifted, 0.0, 0.0, ("torque",), TORQUE_UNIT, labels=form.joints)
    yield Row("force", force, 0.0, 0.0, ("force_balance",), FORCE_UNIT)
    yield Row("moment", moment, 0.0, 0.0, ("moment_balance",), TORQUE_UNIT)
    yield from _within_rated(body)


def _within_rated(body: Body) -> Iterator[Row]:
    """Torques within what the design's actuators can hold for ever."""
    rated, form = rated_torques(body.part), body.form
    shares = {
        joint: body.values["torques"][place] / rated[joint]
        for place, joint in enumerate(form.joints)
        if joint in rated
    }
    if shares:
        within = ca.vertcat(*shares.values())
        bounds = tuple(
            Bound("rated torque", rated[joint], "N m", True, share / rated[joint], part=form.words_of(joint))
            for joint, share in shares.items()
        )
        row = Row("rated_torques", within, -1.0, 1.0, ("torque_limits",), labels=tuple(shares))
        yield replace(row, least=bounds, most=bounds)


def _contacts(body: Body) -> Iterator[AppliedWrench]:
    """What load and ground do to the agent, in its own frame."""
    for hand in body.form.hands:
        wrench = body.hands[hand.name]
        yield AppliedWrench(hand.frame, body.poses[hand.frame].position, wrench[:3], wrench[3:])
    for foot in body.form.feet:
        sole, wrench = body.poses[foot.frame], body.feet[foot.name]
        yield AppliedWrench(foot.frame, sole.position, sole.rotation @ wrench[:3], sole.rotation @ wrench[3:])


def _push(body: Body) -> Iterator[AppliedWrench]:
    """A disturbance's push on the agent's trunk, in its own frame."""
    push = body.disturbance.push_on(body.agent.name)
    if any(push):
        force = turned_to_agent(body.agent, vector(push))
        frame = body.agent.pushed_frame
        yield AppliedWrench(frame, body.poses[frame].position, force, ca.DM.zeros(3))


def asked(agent: Agent, posture: AgentPosture, state: BodyState, push: Sequence[float]) -> Array:
    """Rows of h - J^T f, what balance asks of the base (six) and of the joints [N, N m].

    Args:
        agent: whose posture it is.
        posture: with its wrenches.
        state: of that posture; at rest, or as it moves.
        push: on the agent's trunk, in the world [N].
    """
    rows = np.array(state.bias)
    if any(push):
        in_agent = agent.turn.T @ np.array(push)
        rows -= state.jacobian_in_world(agent.pushed_frame)[:3].T @ in_agent
    for hand in agent.hands:
        rows -= state.jacobian_in_world(hand.frame).T @ posture.wrenches[hand.name]
    for foot in agent.feet:
        rows -= state.jacobian_in_frame(foot.frame).T @ posture.wrenches[foot.name]
    return rows


def residuals(body: MeasuredBody) -> Iterator[Residual]:
    """What base and joints miss of their balance; and torques beyond their limits."""
    agent, posture = body.agent, body.posture
    rows = asked(agent, posture, body.state, body.disturbance.push_on(agent.name))
    base, joints = np.abs(rows[:ROOT]), rows[ROOT:]
    wrong = float(np.abs(joints - [posture.torques[name] for name in agent.joints]).max())
    yield Residual("torque", wrong, "N m", "joint torques")
    yield Residual("force_balance", float(base[:3].max()), "N", "the balance of forces")
    yield Residual("moment_balance", float(base[3:].max()), "N m", "the balance of moments")
    if agent.limits_torques:
        beyond = [abs(posture.torques[name]) - limit for name, limit in agent.torque_limits.items()]
        yield Residual("torque_limits", max(0.0, *beyond, 0.0), "N m", "torque limits")


TORQUE = BodyTerm("torque", unknowns=unknowns, rows=rows, residuals=residuals)
