"""What a robot that stands alone is asked to do: its posture, its feet, its loads and what moves to balance.

`mechanics.stance_torques` finds the torques that its joints need for it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from evodesign.body.placement import Scalar, Vector

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class RaisedHand:
    """A hand that is brought to a height.

    Args:
        frame: of the hand.
        height: above the first sole [m].
        joints: that move by the same offset until it is there.
        limits: least and largest position [rad] of each of these joints.
    """

    frame: str
    height: float
    joints: tuple[str, ...]
    limits: tuple[tuple[float, float], ...]


@dataclass(frozen=True, slots=True)
class StanceCase:
    """A posture in which a robot stands alone, and what it asks of actuators.

    Args:
        name: of the case.
        joints: position [rad] of joints that are not at zero, by name.
        soles: frames under the feet that carry.
        balance: groups of joints that move by the same offset each, until the robot is balanced.
        factor: how many times the torques of the case the peak torque must be.
        loads: force [N] on frames of the robot, ahead, to the left and upwards.
        friction: largest horizontal force of a foot, as a share of its vertical one.
        raised: a hand at a height; None: where the joints put it.
        dropped: height [m] from which the loads fall, or without any the robot.
    """

    name: str
    joints: Mapping[str, float]
    soles: tuple[str, ...]
    balance: tuple[tuple[str, ...], ...]
    factor: float
    loads: tuple[tuple[str, Vector], ...] = ()
    friction: float = math.inf
    raised: RaisedHand | None = None
    dropped: float = 0.0

    @property
    def groups(self) -> tuple[tuple[str, ...], ...]:
        """The groups of joints that move, those that raise a hand last."""
        return self.balance if self.raised is None else (*self.balance, self.raised.joints)

    def positions(self, offsets: Sequence[Scalar]) -> dict[str, Scalar]:
        """Joints that are not at zero [rad], their groups moved by offsets."""
        found: dict[str, Scalar] = dict(self.joints)
        for group, offset in zip(self.groups, offsets, strict=True):
            for joint in group:
                found[joint] = found.get(joint, 0.0) + offset
        return found


@dataclass(frozen=True, slots=True)
class StanceTorques:
    """What became of a case.

    Args:
        torques: [N m] of every joint that moves; none where the robot cannot stand so.
        offsets: of the groups of joints that balance [rad].
        slopes: of what is balanced by the offsets, about [m/rad].
        feet: force [N] of each foot, in the axes of the first sole; of a single foot the moment about z [N m]
            comes last.
        reason: a sentence; empty where it stands.
    """

    torques: Mapping[str, float]
    offsets: tuple[float, ...] = ()
    slopes: Array | None = None
    feet: tuple[tuple[float, ...], ...] = ()
    reason: str = ""
