"""Force through the disc L5/S1 of a person, from below.

What the legs and the pelvis pass on to the spine is what the ground does to the feet, less their weight:

    F = sum over feet of R_sole f - m g z        (x, y, z) = R_L5^T F        [N]

with m the mass below the disc. At rest it equals the weight above the disc and what the hands hold, and it
holds what a push on the trunk adds. In a lift, what accelerates the legs and the pelvis is left out of it.

    compression = |tau| / lever + z        shear = -x

with tau the torque of the joint of flexion (`human.back`).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from evodesign.human.back import FLEXION, LUMBAR, MUSCLE_LEVER
from evodesign.mechanics.agent import Agent
from evodesign.mechanics.balance import GRAVITY
from evodesign.tree.kinematics import Pose, euler_rotation, forward
from evodesign.tree.model import Tree

Array = NDArray[np.float64]


def has_lumbar_disc(person: Agent) -> bool:
    """Whether a person's joint of flexion at L5/S1 moves, so that it has a torque."""
    return FLEXION in person.joints


@lru_cache(maxsize=32)
def _through_disc(tree: Tree, joints: tuple[str, ...], soles: tuple[str, ...]) -> ca.Function:
    """From base angles, joints [rad] and both feet's wrenches to the force F in L5's axes, and its Jacobian.

    The Jacobian is by all three, shape (3, 15 + joints).
    """
    angles, turns = ca.SX.sym("angles", 3), ca.SX.sym("joints", len(joints))
    feet = ca.SX.sym("feet", 6 * len(soles))
    base = Pose(euler_rotation(angles), ca.DM.zeros(3))
    poses = forward(tree, base, dict(zip(joints, ca.vertsplit(turns), strict=True)))
    vertebra = [joint.child for joint in tree.joints if joint.name.startswith(LUMBAR)][-1]
    below = [link for link in tree.links if vertebra not in tree.to_root(link.name)]
    force = ca.vertcat(0.0, 0.0, -GRAVITY * sum(float(link.mass) for link in below))
    for place, sole in enumerate(soles):
        force += poses[sole].rotation @ feet[6 * place : 6 * place + 3]
    found = poses[vertebra].rotation.T @ force
    slopes = ca.jacobian(found, ca.vertcat(angles, turns, feet))
    return ca.Function("through_disc", [angles, turns, feet], [found, slopes])


@dataclass(frozen=True, slots=True)
class LumbarLoad:
    """What the disc bears.

    Args:
        moment: of the muscles that extend the trunk [N m]; negative: of those that bend it.
        force: in the axes of the vertebra above [N], shape (3,).
        slopes: derivatives of the force's axial part by base angles, joints and both feet's wrenches, shape
            (15 + joints,).
    """

    moment: float
    force: Array
    slopes: Array

    @property
    def compression(self) -> float:
        """Of the disc [N]."""
        return abs(self.moment) / MUSCLE_LEVER + float(self.force[2])

    @property
    def shear(self) -> float:
        """Force that would push the vertebra above forwards on the sacrum [N]."""
        return -float(self.force[0])


def lumbar_load(person: Agent, angles: Array, joints: Array, feet: Array, torque: float) -> LumbarLoad:
    """What a person's disc L5/S1 bears.

    Args:
        person: with a tree of numbers that has the disc.
        angles: roll, pitch, yaw of the pelvis in the person's frame [rad], shape (3,).
        joints: positions in the person's order [rad].
        feet: wrenches on them in the soles' frames, foot after foot, shape (6 x feet,).
        torque: of the joint of flexion [N m].
    """
    soles = person.foot_frames
    force, slopes = _through_disc(person.tree, person.joints, soles)(angles, joints, feet)
    return LumbarLoad(-float(torque), np.array(force).ravel(), np.array(slopes)[2])
