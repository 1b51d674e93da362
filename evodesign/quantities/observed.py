"""A person's posture as an observer with a worksheet sees it (`human.worksheets`).

    trunk       from the pelvis to the foot of the neck, against the vertical; turned: shoulders on pelvis
    upper arm   from shoulder to elbow, in the axes of the chest: u = (x, y, z)
                flexion atan2(x, -z)        abduction asin(y outwards / |u|)
                beyond 70 degrees of abduction the flexion is the angle to the hanging arm
    elbow       angle between upper arm and forearm
    neck, wrists, knees    their joints' own angles

Forearms work aside where the hand is across the chest's midline, or where they point outwards by more than 20
degrees; both feet carry the person if each carries at least a third of what they press on the ground (our
choices). The hand's rotation about the forearm is not modelled and counts as in mid-range; shoulders are
raised with their joint; arms are not supported.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from evodesign.body.placement import Placement
from evodesign.human.worksheets import ABDUCTED, UNSEEN, ArmSeen, BodySeen
from evodesign.mechanics.agent import SIDES, Agent
from evodesign.records import AgentDetail
from evodesign.tree.frames import link_frames

Array = NDArray[np.float64]
Frames = Mapping[str, tuple[Array, Array]]

PELVIS, CHEST, NECK = "Pelvis", "T8", "Neck"
ARM = ("UpperArm", "ForeArm", "Hand")
"""Links whose origins are shoulder, elbow and wrist; the side's name stands before."""

SIDEWAYS = 70.0
"""Abduction [degrees] beyond which an arm has no flexion."""

EVEN = 1.0 / 3.0
"""Least share of the ground's force that a foot has which carries the person."""


def observed(person: Agent, posture: AgentDetail) -> tuple[tuple[ArmSeen, ...], BodySeen] | None:
    """Both arms, left first, and the rest of the body; None for a person whose links have other names.

    Args:
        person: as the problem names it, facing along x.
        posture: in the person's own frame.
    """
    needed = {PELVIS, CHEST, NECK, *(f"{side.title()}{part}" for side in SIDES for part in ARM)}
    if not needed <= {link.name for link in person.tree.links}:
        return None
    root = Placement.from_xyz_rpy(posture.base_position_m, posture.base_rpy_rad)
    placed = link_frames(person.tree, root, posture.joints_rad)
    at: Frames = {
        name: (np.array(placed[name].rotation), np.array(placed[name].translation)) for name in needed
    }
    arms = tuple(
        _arm(at, posture.joints_rad, side.title(), sign)
        for side, sign in zip(SIDES, (1.0, -1.0), strict=True)
    )
    return arms, _body(at, posture)


def _arm(at: Frames, joints: Mapping[str, float], side: str, outwards: float) -> ArmSeen:
    """An arm in the chest's axes.

    Args:
        at: rotations and origins of links.
        joints: positions [rad].
        side: as in names.
        outwards: sign of y away from the body.
    """
    turn, origin = at[CHEST]
    shoulder, elbow, wrist = (turn.T @ (at[f"{side}{part}"][1] - origin) for part in ARM)
    upper, fore = elbow - shoulder, wrist - elbow
    across, abduction = outwards * wrist[1] < 0.0, _rise(outwards * upper[1], upper)
    flexion = math.degrees(math.atan2(upper[0], -upper[2]))
    return ArmSeen(
        upper=90.0 + _rise(upper[2], upper) if abduction > SIDEWAYS else flexion,
        abduction=abduction,
        elbow=math.degrees(
            math.acos(np.clip(upper @ fore / np.linalg.norm(upper) / np.linalg.norm(fore), -1, 1))
        ),
        wrist=_degrees(joints, f"j{side}Wrist_rotx"),
        deviation=_degrees(joints, f"j{side}Wrist_rotz"),
        raised=abs(_degrees(joints, f"j{side}C7Shoulder_rotx")) > UNSEEN,
        aside=bool(across or _rise(outwards * fore[1], fore) > ABDUCTED),
    )


def _body(at: Frames, posture: AgentDetail) -> BodySeen:
    joints = posture.joints_rad
    spine = at[NECK][1] - at[PELVIS][1]
    shoulders = at["LeftUpperArm"][1] - at["RightUpperArm"][1]
    across = at[PELVIS][0][:, 1]
    pressed = [posture.wrenches[f"{side}_foot"][2] for side in SIDES]
    knees = [_degrees(joints, f"j{side.title()}Knee_roty") for side in SIDES]
    return BodySeen(
        neck=_degrees(joints, "jT1C7_roty", "jC1Head_roty"),
        trunk=math.degrees(math.atan2(spine[0], spine[2])),
        knee=max(knees),
        neck_bent=_degrees(joints, "jT1C7_rotx", "jC1Head_rotx"),
        neck_twisted=_degrees(joints, "jT1C7_rotz"),
        trunk_bent=_rise(spine[1], spine),
        trunk_twisted=_heading(shoulders) - _heading(across),
        balanced=min(pressed) >= EVEN * sum(pressed),
    )


def _degrees(joints: Mapping[str, float], *names: str) -> float:
    """The sum of joints' positions; those that do not move are at zero."""
    return math.degrees(math.fsum(joints.get(name, 0.0) for name in names))


def _rise(part: float, whole: Array) -> float:
    """Angle [degrees] of a vector out of a plane, from its part across the plane."""
    return math.degrees(math.asin(np.clip(part / np.linalg.norm(whole), -1.0, 1.0)))


def _heading(line: Array) -> float:
    """Angle of a line's horizontal part to the y axis [degrees]."""
    return math.degrees(math.atan2(-line[0], line[1]))
