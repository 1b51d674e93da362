"""What the wrenches on an agent's hands add to its joint torques, in the same posture.

The torques less those of the same agent in the same posture with empty hands, both with the foot wrenches
that ask least of the joints. Statics is linear in the wrenches, so weight, inertia and pushes fall out of the
difference, and it is what the hands' wrenches w alone ask for:

    tau = T_h w + T_f f        0 = B_h w + B_f f        f = argmin |tau|^2

with T and B the rows of joints and base of `mechanics.balance.cut`. Limits of contact do not bind f, so that
it exists also where the agent would fall without the load. With multipliers mu of the base's rows, the
derivative of |tau| by the posture is that of (tau . (T w) + mu . (B w)) / |tau| with tau, mu and both
wrenches held (envelope theorem).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from evodesign.mechanics.agent import Agent
from evodesign.mechanics.balance import AppliedWrench, cut
from evodesign.tree.kinematics import Pose, euler_rotation, forward
from evodesign.tree.model import Link, Tree

Array = NDArray[np.float64]

BASE = 6
"""Rows of the base, before those of the joints; columns of the hands stand before those of the feet."""


@dataclass(frozen=True, slots=True, eq=False)
class _Statics:
    """What wrenches on hands and feet ask of base and joints.

    Args:
        rows: from base angles and joints [rad] to the matrix of B and T, shape (6 + joints, 6 x contacts).
        slope: from these, wrenches and weights of the rows to the derivatives of the weighted sum by
            angles and joints, shape (3 + joints,).
    """

    rows: ca.Function
    slope: ca.Function


@lru_cache(maxsize=32)
def _statics(tree: Tree, joints: tuple[str, ...], hands: tuple[str, ...], soles: tuple[str, ...]) -> _Statics:
    weightless = replace(tree, links=tuple(Link(link.name) for link in tree.links))
    angles, turns = ca.SX.sym("angles", 3), ca.SX.sym("joints", len(joints))
    wrenches = ca.SX.sym("wrenches", 6 * len((*hands, *soles)))
    weights = ca.SX.sym("weights", BASE + len(joints))
    base = Pose(euler_rotation(angles), ca.DM.zeros(3))
    poses = forward(weightless, base, dict(zip(joints, ca.vertsplit(turns), strict=True)))
    applied = []
    for place, frame in enumerate((*hands, *soles)):
        wrench, pose = wrenches[6 * place : 6 * place + 6], poses[frame]
        force, moment = wrench[:3], wrench[3:]
        if frame in soles:
            force, moment = pose.rotation @ force, pose.rotation @ moment
        applied.append(AppliedWrench(frame, pose.position, force, moment))
    balance = cut(weightless, poses, applied)
    asked = ca.vertcat(balance.force, balance.moment, *(balance.torques[name] for name in joints))
    slope = ca.gradient(ca.dot(weights, asked), ca.vertcat(angles, turns))
    return _Statics(
        rows=ca.Function("rows", [angles, turns], [ca.jacobian(asked, wrenches)]),
        slope=ca.Function("slope", [angles, turns, wrenches, weights], [slope]),
    )


@dataclass(frozen=True, slots=True)
class NormSlopes:
    """Derivatives of |tau|.

    Args:
        angles: by the base's roll, pitch and yaw [N m/rad], shape (3,).
        joints: by the joints' positions [N m/rad], shape (joints,).
        hands: by the wrenches on the hands, shape (6 x hands,).
    """

    angles: Array
    joints: Array
    hands: Array


@dataclass(frozen=True, slots=True, eq=False)
class LoadTorques:
    """Torques that the hands' wrenches ask for, and what they follow from.

    Args:
        torques: [N m], shape (joints,).
        wrenches: of hands and feet [N, N m], shape (6 x contacts,).
        multipliers: of the base's rows, shape (6,).
        rows: of base and joints, shape (6 + joints, 6 x contacts).
        posture: base angles and joints [rad].
        statics: of the agent.
    """

    torques: Array
    wrenches: Array
    multipliers: Array
    rows: Array
    posture: tuple[Array, Array]
    statics: _Statics
    hands: int

    @property
    def norm(self) -> float:
        """Of the torques [N m]."""
        return float(np.linalg.norm(self.torques))

    def slopes(self) -> NormSlopes:
        """How the norm moves with the posture; not at all where the hands pass nothing."""
        weights = np.concatenate([self.multipliers, self.torques]) / (self.norm or 1.0)
        found = np.array(self.statics.slope(*self.posture, self.wrenches, weights)).ravel()
        return NormSlopes(found[:3], found[3:], self.rows[:, : self.hands].T @ weights)


def load_torques(agent: Agent, angles: Array, joints: Array, hands: Array) -> LoadTorques:
    """What the wrenches on the hands ask of an agent's joints.

    Args:
        agent: with a tree of numbers.
        angles: roll, pitch, yaw of the base in the agent's frame [rad], shape (3,).
        joints: positions in the agent's order [rad].
        hands: wrenches on the hands, about the origin of each in the agent's frame, shape (6 x hands,).
    """
    statics = _statics(agent.tree, agent.joints, agent.hand_frames, agent.foot_frames)
    rows = np.array(statics.rows(angles, joints))
    base, torques = rows[:BASE], rows[BASE:]
    count = len(hands)
    by_feet, of_base = torques[:, count:], base[:, count:]
    stationary = np.block([[by_feet.T @ by_feet, of_base.T], [of_base, np.zeros((BASE, BASE))]])
    asked = np.concatenate([by_feet.T @ torques[:, :count] @ hands, base[:, :count] @ hands])
    found = np.linalg.lstsq(stationary, -asked, rcond=None)[0]
    feet = by_feet.shape[1]
    wrenches = np.concatenate([hands, found[:feet]])
    return LoadTorques(torques @ wrenches, wrenches, found[feet:], rows, (angles, joints), statics, count)
