"""How the torques of a robot at rest change with point masses that are added at some frames.

    d tau / d m = g (J_z of the masses - J_z of the soles, in equal parts)

The posture stays, and the moment that the feet would have to carry is left out: a first guess, quickly.

Source: gravity torques by pinocchio's joint Jacobians; v_z of a point p is v_z + w_x p_y - w_y p_x.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from evodesign.mechanics.balance import GRAVITY
from evodesign.mechanics.floating_base import ROOT, FloatingBody

__all__ = ["AddedMasses"]

Array = NDArray[np.float64]


class AddedMasses:
    """Groups of frames at whose origins a mass is added each.

    Args:
        body: of the robot, of any design.
        groups: names of frames.
    """

    def __init__(self, body: FloatingBody, groups: Sequence[Sequence[str]]) -> None:
        names = [name for group in groups for name in group]
        self._frames, self._moved = _frames(body, names)
        sizes = [len(group) for group in groups]
        self._group = np.repeat(np.eye(len(groups)), sizes, axis=0).T

    def slopes(self, body: FloatingBody, coordinates: Array, soles: Sequence[str]) -> Array:
        """D tau / d m of each group's mass per frame [N m/kg], shape (joints, groups).

        Args:
            body: of a design.
            coordinates: pinocchio's, the world's z axis upwards.
            soles: frames under the feet that carry.
        """
        model, data = body.model, body.workspace.data
        body.workspace.holds = None
        pin.computeJointJacobians(model, data, coordinates)
        feet, under = _frames(body, soles)
        masses = self._group @ _upwards(model, data, self._frames, self._moved)
        share = self._group.sum(axis=1)[:, None] / len(soles)
        carried = share * _upwards(model, data, feet, under).sum(axis=0)
        return np.asarray(GRAVITY * (masses - carried)[:, body.order[ROOT:]].T)


def _frames(body: FloatingBody, names: Sequence[str]) -> tuple[list[int], Array]:
    """Pinocchio's numbers of frames, and which velocities move each, shape (frames, velocities)."""
    model, frames = body.model, [body.workspace.frames[name] for name in names]
    moved = np.zeros((len(frames), model.nv))
    for row, frame in enumerate(frames):
        for joint in model.supports[model.frames[frame].parentJoint].tolist():
            first, count = model.joints[joint].idx_v, model.joints[joint].nv
            moved[row, first : first + count] = joint > 0
    return frames, moved


def _upwards(model: pin.Model, data: pin.Data, frames: Sequence[int], moved: Array) -> Array:
    """Vertical velocities of frames by all velocities, shape (frames, velocities)."""
    places = np.array([pin.updateFramePlacement(model, data, frame).translation for frame in frames])
    jacobian = data.J
    return np.asarray(moved * (jacobian[2] + places[:, 1:2] * jacobian[3] - places[:, 0:1] * jacobian[4]))
