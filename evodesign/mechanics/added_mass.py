"""How the torques of a robot at rest change with point masses that are added at some frames.

    d tau / d m = g J_z - J_feet^T f,       g J_z,base = J_feet,base^T f,   |f| least

in the same posture.

Source: gravity torques by pinocchio's joint Jacobians; v_z of a point p is v_z + w_x p_y - w_y p_x.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from evodesign.body.placement import Vector
from evodesign.mechanics.balance import GRAVITY
from evodesign.mechanics.floating_base import ROOT, FloatingBody

Array = NDArray[np.float64]


class AddedMasses:
    """Groups of frames at whose origins a mass is added each.

    Args:
        body: of the robot, of any design.
        groups: names of frames.
    Attributes:
        groups: which frames are each group's, shape (groups, frames).
    """

    def __init__(self, body: FloatingBody, groups: Sequence[Sequence[str]]) -> None:
        names = [name for group in groups for name in group]
        self._frames, self._moved = _frames(body, names)
        frames = [body.model.frames[frame] for frame in self._frames]
        numbers = [number for number, group in enumerate(groups) for _ in group]
        self._carriers = [
            (number, int(frame.parentJoint), None if frame.placement.isIdentity() else place)
            for number, frame, place in zip(numbers, frames, self._frames, strict=True)
        ]
        sizes = [len(group) for group in groups]
        self.groups = np.repeat(np.eye(len(groups)), sizes, axis=0).T

    def rows(self, body: FloatingBody, coordinates: Array) -> Array:
        """Gravity torques of each group per mass at each of its frames [m/s^2 m], shape (velocities, groups).

        Args:
            body: of a design.
            coordinates: pinocchio's, the world's z axis upwards; rows are in pinocchio's order.
        """
        model, data = body.model, body.workspace.data
        body.workspace.holds = None
        jacobian = pin.computeJointJacobians(model, data, coordinates)
        x, y, _ = self.places(body).T[:, :, None]
        upwards = self._moved * (jacobian[2] + y * jacobian[3] - x * jacobian[4])
        return np.asarray(GRAVITY * (self.groups @ upwards).T)

    def loaded(self, body: FloatingBody, masses: Sequence[float], aside: Sequence[Vector]) -> FloatingBody:
        """The body with a point of each group's mass at each of its frames, or aside.

        Args:
            body: of a design.
            masses: one per group [kg].
            aside: of each frame, in its axes: where the mass lies [m]. Slopes do not know of it.
        """
        model, nothing, zero = pin.Model(body.model), pin.SE3.Identity(), np.zeros((3, 3))
        for (number, carrier, frame), lies in zip(self._carriers, aside, strict=True):
            place = nothing if frame is None else model.frames[frame].placement
            model.appendBodyToJoint(carrier, pin.Inertia(masses[number], np.array(lies), zero), place)
        return replace(body, model=model)

    def places(self, body: FloatingBody) -> Array:
        """Where the frames are in pinocchio's latest posture [m], shape (frames, 3)."""
        model, data = body.model, body.workspace.data
        return np.array([pin.updateFramePlacement(model, data, frame).translation for frame in self._frames])


def joint_slopes(rows: Array, feet: Array, order: NDArray[np.intp]) -> Array:
    """What is left to the joints of rows that feet carry by the least wrenches, shape (joints, groups).

    Args:
        rows: of added masses.
        feet: transposed Jacobians of what feet pass, shape (velocities, wrenches).
        order: pinocchio's velocity index of each row that is wanted, the root's first.
    """
    wrenches = np.linalg.lstsq(feet[:ROOT], rows[:ROOT], rcond=1e-10)[0]
    return np.asarray((rows - feet @ wrenches)[order][ROOT:])


def _frames(body: FloatingBody, names: Sequence[str]) -> tuple[list[int], Array]:
    """Pinocchio's numbers of frames, and which velocities move each, shape (frames, velocities)."""
    model, frames = body.model, [body.workspace.frames[name] for name in names]
    moved = np.zeros((len(frames), model.nv))
    for row, frame in enumerate(frames):
        for joint in model.supports[model.frames[frame].parentJoint].tolist():
            first, count = model.joints[joint].idx_v, model.joints[joint].nv
            moved[row, first : first + count] = joint > 0
    return frames, moved
