"""A robot that stands alone in a given posture: which torques its joints need.

Feet are flat on the ground; some joints move by as much as brings the centre of mass over the middle of the
soles, which carry the weight in equal parts at their origins:

    c_xy(q + d) = middle of the soles        tau = g_joint(q) - J_joint^T f,   f = weight / feet, upwards

The offsets d are found by Gauss and Newton from zero, with differences. As many groups of joints as there are
coordinates to bring over the soles: one for a symmetric posture on both feet, two on one foot.

Source: statics, as everywhere; pinocchio's centre of mass, Jacobians and gravity torques.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from evodesign.mechanics.balance import GRAVITY
from evodesign.mechanics.floating_base import ROOT, BodyState, Configuration, FloatingBody

__all__ = ["StanceCase", "StanceTorques", "stance_slopes", "stance_torques"]

Array = NDArray[np.float64]

STEPS, DIFFERENCE, OVER = 30, 1e-6, 1e-10
"""Most steps of Newton; step of its differences [rad]; distance [m] from the middle that counts as none."""

UNEVEN = 1e-3
"""Difference in height [m] of two soles that stand on the same ground."""

FURTHEST = math.radians(40.0)
"""Largest offset of a joint [rad]."""


@dataclass(frozen=True, slots=True)
class StanceCase:
    """A posture in which a robot stands alone, and what it asks of actuators.

    Args:
        name: of the case.
        joints: position [rad] of joints that are not at zero, by name.
        soles: frames under the feet that carry.
        balance: groups of joints that move by the same offset each, until the robot is balanced.
        factor: how many times the torques of the case the peak torque must be.
    """

    name: str
    joints: Mapping[str, float]
    soles: tuple[str, ...]
    balance: tuple[tuple[str, ...], ...]
    factor: float


@dataclass(frozen=True, slots=True)
class StanceTorques:
    """What became of a case.

    Args:
        torques: [N m] of every joint that moves; none where the robot cannot stand so.
        offsets: of the groups of joints that balance [rad].
        reason: a sentence; empty where it stands.
    """

    torques: Mapping[str, float]
    offsets: tuple[float, ...] = ()
    reason: str = ""


def stance_torques(body: FloatingBody, case: StanceCase) -> StanceTorques:
    """The joint torques of a robot that stands as a case says.

    Args:
        body: of the robot, with a design's masses; configurations are given in the world's axes.
        case: posture and feet.
    """
    offsets = np.zeros(len(case.balance))
    for _ in range(STEPS):
        away = _away(body, case, offsets)
        if np.abs(away).max() < OVER:
            break
        slopes = np.column_stack(
            [
                (_away(body, case, offsets + unit) - away) / DIFFERENCE
                for unit in DIFFERENCE * np.eye(len(offsets))
            ]
        )
        offsets = offsets - np.linalg.lstsq(slopes, away, rcond=None)[0]
        if not np.abs(offsets).max() < FURTHEST:
            break
    if not np.abs(_away(body, case, offsets)).max() < 1e3 * OVER:
        reason = f"the robot cannot stand as in '{case.name}': its centre of mass is not over its soles"
        return StanceTorques({}, reason=reason)
    state = _level(body, case, offsets)
    heights = [state.pose(sole)[1][2] for sole in case.soles]
    if max(heights) - min(heights) > UNEVEN:
        apart = max(heights) - min(heights)
        reason = f"the robot cannot stand as in '{case.name}': one sole is {apart:.3f} m above the other"
        return StanceTorques({}, reason=reason)
    torques = _joint_rows(state, case, _mass(body))
    return StanceTorques(dict(zip(body.joints, torques.tolist(), strict=True)), tuple(offsets.tolist()))


def stance_slopes(
    body: FloatingBody, case: StanceCase, found: StanceTorques, places: Sequence[Sequence[str]]
) -> Array:
    """How the torques change with masses at some places, the robot balanced again.

    Args:
        body: as in `stance_torques`.
        case: likewise.
        found: what became of it.
        places: groups of frames, at whose origins a group's mass is each.
    Returns:
        [N m/kg], shape (moving joints, groups).
    """
    offsets, mass = np.array(found.offsets), _mass(body)
    state, units = _level(body, case, offsets), DIFFERENCE * np.eye(len(offsets))
    center = _center_of_mass(state)
    added, moved = [], []
    for frames in places:
        rows = GRAVITY * np.sum([state.jacobian_in_world(frame)[2] for frame in frames], axis=0)
        for sole in case.soles:
            rows = rows - GRAVITY * len(frames) / len(case.soles) * state.jacobian_in_world(sole)[2]
        added.append(rows[ROOT:])
        away = np.sum([(state.pose(frame)[1] - center)[:2] for frame in frames], axis=0) / mass
        moved.append(away if len(case.soles) == 1 else away[:1])
    torques = _joint_rows(state, case, mass)
    middle = _away(body, case, offsets)
    turned, back = [], []
    for unit in units:
        other = _level(body, case, offsets + unit)
        turned.append((_joint_rows(other, case, mass) - torques) / DIFFERENCE)
        back.append((_away(body, case, offsets + unit) - middle) / DIFFERENCE)
    again = -np.linalg.lstsq(np.column_stack(back), np.column_stack(moved), rcond=None)[0]
    return np.asarray(np.column_stack(added) + np.column_stack(turned) @ again)


def _joint_rows(state: BodyState, case: StanceCase, mass: float) -> Array:
    """The torques of a state whose soles carry a mass [kg] in equal parts [N m]."""
    rows = np.array(state.bias)
    for sole in case.soles:
        rows -= GRAVITY * mass / len(case.soles) * state.jacobian_in_world(sole)[2]
    return np.asarray(rows[ROOT:])


def _mass(body: FloatingBody) -> float:
    return float(pin.computeTotalMass(body.model))


def _configuration(body: FloatingBody, case: StanceCase, offsets: Array, angles: Array) -> Configuration:
    positions = {joint: case.joints.get(joint, 0.0) for joint in body.joints}
    for joints, offset in zip(case.balance, offsets, strict=True):
        for joint in joints:
            positions[joint] += float(offset)
    return Configuration(np.zeros(3), angles, positions)


def _level(body: FloatingBody, case: StanceCase, offsets: Array) -> BodyState:
    """The state with the first sole level."""
    still = np.zeros(body.size)
    upright = body.at(_configuration(body, case, offsets, np.zeros(3)), still)
    rotation, _ = upright.pose(case.soles[0])
    angles = np.array(pin.rpy.matrixToRpy(rotation.T))
    return body.at(_configuration(body, case, offsets, angles), still)


def _away(body: FloatingBody, case: StanceCase, offsets: Array) -> Array:
    """How far the centre of mass is from over the middle of the soles, ahead and to the left [m].

    On two feet only ahead: a symmetric robot has it between them.
    """
    state = _level(body, case, offsets)
    center = _center_of_mass(state)
    middle = np.mean([state.pose(sole)[1] for sole in case.soles], axis=0)
    away = (center - middle)[:2]
    return np.asarray(away if len(case.soles) == 1 else away[:1])


def _center_of_mass(state: BodyState) -> Array:
    """In the world [m]."""
    body = state.body
    return np.array(pin.centerOfMass(body.model, body.workspace.data, state.coordinates, False))
