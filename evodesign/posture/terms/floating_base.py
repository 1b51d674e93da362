"""Floating base and joints: where an agent is, within its joint limits and a bounded tilt.

Source: Sartore et al. 2022, Eq. 14, whose variable q_b, s they are.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import casadi as ca
import numpy as np

from evodesign.mechanics.agent import Agent
from evodesign.mechanics.scene import Scene
from evodesign.posture.limit_groups import LimitGroup
from evodesign.posture.symmetry import Form
from evodesign.posture.terms.base import (
    Body,
    BodyTerm,
    Bound,
    MeasuredBody,
    Residual,
    Row,
    Unknown,
    both_ways,
)
from evodesign.tree.kinematics import Pose, forward
from evodesign.tree.model import Joint, JointKind


def unknowns(form: Form, scene: Scene) -> Iterator[Unknown]:
    """Position [m] and angles [rad] of the base, and the coordinates of the joints [rad]."""
    tilt = scene.stance.base_tilt
    sideways, turn = (0.0, 0.0) if form.mirror else (0.5, tilt)  # none in a symmetric posture
    lower, upper = zip(*coordinate_ranges(form), strict=True)
    yield Unknown(
        "base_position",
        [
            -3.0,
            -sideways,
            0.0 if form.agent.on_feet else -1.0,
        ],  # the root of a robot on wheels is on the ground
        [0.0, sideways, 3.0],
        _standing(form.agent, scene),
        posture_only=True,
    )
    back, forth = both_ways(Bound("base tilt", tilt, "rad", True, key="limits.base_tilt_rad"))
    yield Unknown(
        "base_angles",
        [-turn, -tilt, -turn],
        [turn, tilt, turn],
        [0.0] * 3,
        group=LimitGroup.STANCE,
        posture_only=True,
        least=(back,),
        most=(forth,),
    )
    yield Unknown(
        "joints",
        lower,
        upper,
        np.clip(0.0, lower, upper).tolist(),
        group=LimitGroup.JOINT_LIMITS,
        posture_only=True,
        labels=tuple(form.coordinates),
        drawn=True,
        least=tuple(_range_bounds(form, lower, at_most=False)),
        most=tuple(_range_bounds(form, upper, at_most=True)),
    )


def _range_bounds(form: Form, ends: Sequence[float], *, at_most: bool) -> Iterator[Bound]:
    """One end of every coordinate's range; of a half, it is that of the pair."""
    joints, bent = form.agent.tree.joint_by_name, form.agent.bent_ranges
    for name, end in zip(form.coordinates, ends, strict=True):
        if name in joints:
            joint = joints[name]
            unit = "m" if joint.kind is JointKind.PRISMATIC else "rad"
            known = "flexion" if name in bent and end not in (joint.lower, joint.upper) else "joint range"
            yield Bound(known, end, unit, at_most, part=form.words_of(name))
        else:
            yield Bound("range that joints share", end, "rad", at_most, part=name)


def joint_ranges(form: Form) -> list[tuple[float, float]]:
    """Limits of each of the form's joints [rad], of those that turn further those of one turn about zero."""
    bent = {**form.agent.bent_ranges, **form.agent.chosen_ranges}
    known = form.agent.tree.joint_by_name
    return [bent.get(name) or _one_turn(known[name]) for name in form.joints]


def coordinate_ranges(form: Form) -> list[tuple[float, float]]:
    """Limits of each of the form's coordinates [rad]: a rhythm's, within those of its joints."""
    joints = dict(zip(form.joints, joint_ranges(form), strict=True))
    own = {each.name: (each.lower, each.upper) for each in form.rhythms}
    found = []
    for name, shares in form.coordinates.items():
        ends = [(joints[joint][0] / share, joints[joint][1] / share) for joint, share in shares.items()]
        lower, upper = zip(*ends, own.get(name, ends[0]), strict=True)
        found.append((max(lower), min(upper)))
    return found


TURN = 2.0 * math.pi


def _one_turn(joint: Joint) -> tuple[float, float]:
    """The limits, or the 2 pi [rad, of a slide m] between them that are centred nearest to zero."""
    if joint.upper - joint.lower <= TURN:
        return joint.lower, joint.upper
    lower = min(max(-math.pi, joint.lower), joint.upper - TURN)
    return lower, lower + TURN


def _standing(agent: Agent, scene: Scene) -> list[float]:
    """Base position [m] from which a solve begins: soles on the ground with all joints at zero."""
    poses = forward(agent.tree, Pose(ca.DM.eye(3), ca.DM.zeros(3)), {})
    lowest = min(float(poses[frame].position[2]) for frame in agent.foot_frames)
    back = scene.payload.faced(agent)[0] / 2.0 + scene.stance_of(agent).trunk_clearance + 0.1
    return [-back, 0.0, -lowest]


def residuals(body: MeasuredBody) -> Iterator[Residual]:
    """Joints beyond their limits, a base that tilts too far, and a posture that a disturbance moved."""
    posture, tree = body.posture, body.agent.tree
    limits = {
        name: (tree.joint_by_name[name].lower, tree.joint_by_name[name].upper) for name in posture.joints
    }
    limits |= body.agent.bent_ranges
    beyond = max(
        0.0, *(max(limits[name][0] - at, at - limits[name][1]) for name, at in posture.joints.items())
    )
    yield Residual("joint_limits", beyond, "rad", "joint limits", LimitGroup.JOINT_LIMITS, posture_only=True)
    tilt = max(0.0, float(np.abs(posture.base_angles).max()) - body.scene.stance.base_tilt)
    yield Residual("base_tilt", tilt, "rad", "the tilt of the base", LimitGroup.STANCE, posture_only=True)
    if body.disturbed:
        other = body.undisturbed
        base = np.abs(posture.base_position - other.base_position).max()
        turned = np.abs(posture.base_angles - other.base_angles).max()
        moved = max(base, turned, *(abs(posture.joints[name] - x) for name, x in other.joints.items()))
        yield Residual("moved", float(moved), "m or rad", "the posture that a disturbance leaves as it is")


def rows(body: Body) -> Iterator[Row]:
    """Joints within the limits that a design chooses [rad]."""
    chosen, group = body.agent.chosen_ranges, LimitGroup.JOINT_LIMITS
    places = {name: place for place, name in enumerate(body.form.joints) if name in chosen}
    if not places:
        return
    positions = body.values["joints"]
    joints = [(body.part.joint_by_name[name], positions[place]) for name, place in places.items()]
    above = ca.vertcat(*[position - joint.lower for joint, position in joints])
    below = ca.vertcat(*[joint.upper - position for joint, position in joints])
    for end, column in (("lower", above), ("upper", below)):
        words = (body.form.words_of(name) for name in places)
        least = tuple(Bound(f"distance from the {end} limit", 0.0, "rad", False, part=each) for each in words)
        row = Row(f"{end}_limits", column, 0.0, np.inf, ("joint_limits",), group=group, posture_only=True)
        yield replace(row, labels=tuple(places), least=least)


FLOATING_BASE = BodyTerm("floating_base", unknowns=unknowns, rows=rows, residuals=residuals)
