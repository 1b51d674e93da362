"""A robot that stands alone in a given posture, and what it carries there: which torques its joints need.

Feet are flat on the ground and pass forces at the origins of their soles. Weights and loads L have a moment
that such forces cannot carry: about the line between the soles on both feet, about every level line through
the sole on one. Some joints move until there is none,

    0 = a . sum over weights and loads of (p(q + d) - middle of the soles) x F     for each such axis a
    tau = g_joint(q) - J_joint^T L - J_feet^T f,       g_base - J_base^T L = J_feet,base^T f,   |f| least

with as many groups of joints as there are axes; one foot may twist the ground, too. A hand that is to be at
a height has a group of its own. The offsets d are found by Newton from zero, with differences. Axes of loads
are those of the first sole: ahead, to the left, upwards.

Source: statics, as everywhere; pinocchio's centre of mass, Jacobians and gravity torques.
"""

from __future__ import annotations

import math

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from evodesign.mechanics.added_mass import AddedMasses, joint_slopes
from evodesign.mechanics.balance import GRAVITY
from evodesign.mechanics.floating_base import ROOT, FloatingBody
from evodesign.mechanics.stance_case import StanceCase, StanceTorques

Array = NDArray[np.float64]

STEPS, DIFFERENCE, OVER = 30, 1e-6, 1e-10
"""Most steps of Newton; step of its differences [rad]; lever [m] of the moment that counts as none."""

UNEVEN = 1e-3
"""Difference in height [m] of two soles that stand on the same ground."""

FURTHEST = math.radians(40.0)
"""Largest offset of a joint that balances [rad]."""

FEWER, FLAT, LONGEST = 0.1, 1e-12, 0.7
"""Share of the lever that a step leaves with slopes good enough for the next; determinant [m/rad] below
which joints balance nothing; longest step [rad]."""


def stance_torques(body: FloatingBody, case: StanceCase, near: StanceTorques | None = None) -> StanceTorques:
    """The joint torques of a robot that stands as a case says.

    Args:
        body: of the robot, with a design's masses; configurations are given in the world's axes.
        case: posture and feet.
        near: a similar robot, whose offsets are where they are sought first; zero if left out.
    """
    posture = _Stance(body, case)
    offsets, slopes = posture.balanced(near)
    if offsets is None and near is not None:
        return stance_torques(body, case)
    if offsets is None:
        where = "" if case.raised is None else f", or its hand not at {case.raised.height:g} m"
        return _fallen(case, f"its centre of mass is not over its soles{where}")
    if (apart := posture.unevenness(offsets)) > UNEVEN:
        return _fallen(case, f"one sole is {apart:.3f} m above the other")
    if beyond := _beyond_limits(case, offsets):
        return _fallen(case, beyond)
    torques, feet = posture.held(offsets)
    for sole, force in zip(case.soles, feet, strict=True):
        if force[2] <= 0.0:
            return _fallen(case, f"it tips, as {sole} would have to pull")
        if math.hypot(force[0], force[1]) > case.friction * force[2]:
            return _fallen(case, f"{sole} slips")
    pairs = zip(body.joints, torques.tolist(), strict=True)
    passed = tuple(tuple(force.tolist()) for force in feet)
    return StanceTorques(dict(pairs), tuple(offsets.tolist()), slopes, passed)


def _fallen(case: StanceCase, why: str) -> StanceTorques:
    return StanceTorques({}, reason=f"the robot cannot stand as in '{case.name}': {why}")


def _beyond_limits(case: StanceCase, offsets: Array) -> str:
    """Which joint that raises a hand would be beyond its limits; empty where none is."""
    if case.raised is None:
        return ""
    for joint, (lower, upper) in zip(case.raised.joints, case.raised.limits, strict=True):
        position = case.joints.get(joint, 0.0) + float(offsets[-1])
        if not lower <= position <= upper:
            angle, height = f"{math.degrees(position):.0f} degrees", f"{case.raised.height:g} m"
            return f"its hand at {height} needs {joint} at {angle}, beyond its limits"
    return ""


def stance_slopes(body: FloatingBody, case: StanceCase, found: StanceTorques, added: AddedMasses) -> Array:
    """How the torques change with added masses [N m/kg], the robot balanced again; shape (joints, groups).

    Args:
        body: as in `stance_torques`.
        case: likewise.
        found: what became of it.
        added: groups of masses.
    """
    return _Stance(body, case).slopes(np.array(found.offsets), added)


class _Stance:
    """The posture of a case for any offsets, in pinocchio's own terms."""

    def __init__(self, body: FloatingBody, case: StanceCase) -> None:
        self._body, self._model, self._data = body, body.model, body.workspace.data
        body.workspace.holds = None
        places = dict(zip(body.joints, body.places.tolist(), strict=True))
        self._q = pin.neutral(self._model)
        for joint, position in case.joints.items():
            self._q[places[joint]] = position
        self._groups = [[places[joint] for joint in group] for group in case.groups]
        self._furthest = np.array([FURTHEST] * len(case.balance) + [math.pi] * (case.raised is not None))
        frames = body.workspace.frames
        self._soles = [frames[sole] for sole in case.soles]
        self._loads = [(frames[frame], np.array(force)) for frame, force in case.loads]
        self._raised = None if case.raised is None else (frames[case.raised.frame], case.raised.height)
        self._weight = GRAVITY * pin.computeTotalMass(self._model)

    def balanced(self, near: StanceTorques | None) -> tuple[Array | None, Array | None]:
        """The offsets [rad] of the groups, and slopes; None where there are none that are small."""
        offsets, slopes, before = np.zeros(len(self._groups)), None, np.inf
        if near is not None and near.offsets:
            offsets, slopes = np.array(near.offsets), near.slopes
        for _ in range(STEPS):
            lever = self._lever(offsets)
            size = max(abs(each) for each in lever.tolist())
            if size < OVER:
                return offsets, slopes
            if slopes is None or size > FEWER * before:
                slopes = self._slopes(offsets, lever)
            before = size
            if abs(float(np.linalg.det(slopes))) < FLAT:
                break
            offsets = offsets - np.clip(np.linalg.solve(slopes, lever), -LONGEST, LONGEST)
            if not (np.abs(offsets) < self._furthest).all():
                break
        return None, None

    def _slopes(self, offsets: Array, lever: Array) -> Array:
        """D lever / d offsets [m/rad], by differences."""
        units = DIFFERENCE * np.eye(len(offsets))
        return np.column_stack([(self._lever(offsets + unit) - lever) / DIFFERENCE for unit in units])

    def _moved(self, offsets: Array) -> Array:
        q: Array = self._q.copy()
        for group, offset in zip(self._groups, offsets.tolist(), strict=True):
            q[group] += offset
        return q

    def _lever(self, offsets: Array) -> Array:
        """The moment that the feet cannot carry, over the weight [m]: ahead, and on one foot to the left.

        Without loads it is how far the centre of mass is from over the middle of the soles. Where a hand is
        at a height, how far it is above comes last.
        """
        model, data = self._model, self._data
        center = pin.centerOfMass(model, data, self._moved(offsets), False)
        upright, middle, axes = self._ground()
        lever: Array = (upright @ (center - middle))[:2]
        for frame, force in self._loads:
            x, y, z = upright @ (pin.updateFramePlacement(model, data, frame).translation - middle)
            lever += np.array([z * force[0] - x * force[2], z * force[1] - y * force[2]]) / self._weight
        left = lever @ axes
        if self._raised is None:
            return np.asarray(left)
        frame, height = self._raised
        above = upright[2] @ (pin.updateFramePlacement(model, data, frame).translation - middle) - height
        return np.append(left, above)

    def _ground(self) -> tuple[Array, Array, Array]:
        """Axes of the first sole by rows, middle of the soles [m], and what the feet cannot carry.

        That is the parts of a lever ahead and to the left, by columns; all of pinocchio's latest posture.
        """
        model, data = self._model, self._data
        soles = [pin.updateFramePlacement(model, data, sole) for sole in self._soles]
        upright, places = np.array(soles[0].rotation.T), [sole.translation for sole in soles]
        if len(soles) == 1:
            return upright, np.array(places[0]), np.eye(2)
        x, y, _ = upright @ (places[0] - places[1])
        return upright, 0.5 * (places[0] + places[1]), np.array([[y], [-x]]) / math.hypot(x, y)

    def unevenness(self, offsets: Array) -> float:
        """How far soles are above each other, along the normal of the first one [m]."""
        pin.forwardKinematics(self._model, self._data, self._moved(offsets))
        soles = [pin.updateFramePlacement(self._model, self._data, sole) for sole in self._soles]
        heights = [float(soles[0].rotation[:, 2] @ sole.translation) for sole in soles]
        return max(heights) - min(heights)

    def _upright(self, offsets: Array) -> Array:
        """Pinocchio's coordinates, with the first sole level."""
        model, data, q = self._model, self._data, self._moved(offsets)
        pin.forwardKinematics(model, data, q)
        upright = pin.updateFramePlacement(model, data, self._soles[0]).rotation.T
        q[3:7] = pin.Quaternion(np.array(upright)).coeffs()
        return q

    def held(self, offsets: Array) -> tuple[Array, list[Array]]:
        """Torques of the joints [N m], and the force of each foot [N], of a single one its moment too."""
        model, data, q = self._model, self._data, self._upright(offsets)
        rows = np.array(pin.computeGeneralizedGravity(model, data, q))
        for frame, force in self._loads:
            rows -= self._jacobian(q, frame)[:3].T @ force
        feet = self._feet(q)
        forces = np.linalg.lstsq(feet[:ROOT], rows[:ROOT], rcond=1e-10)[0]
        torques = (rows - feet @ forces)[self._body.order][ROOT:]
        return torques, np.split(forces, len(self._soles))

    def _feet(self, q: Array) -> Array:
        """Transposed Jacobians of what feet pass: forces, and of a single foot the moment about z."""
        feet = [self._jacobian(q, sole) for sole in self._soles]
        passed = [foot[:3] for foot in feet] if len(feet) > 1 else [feet[0][[0, 1, 2, 5]]]
        return np.vstack(passed).T

    def slopes(self, offsets: Array, added: AddedMasses) -> Array:
        """How torques change with added masses [N m/kg], the robot balanced again; shape (joints, groups)."""
        q, (torques, _) = self._upright(offsets), self.held(offsets)
        fixed = joint_slopes(added.rows(self._body, q), self._feet(q), self._body.order)
        upright, middle, axes = self._ground()
        places = added.groups @ (added.places(self._body) - middle) @ upright.T
        moved = np.zeros((len(offsets), len(places)))
        moved[: axes.shape[1]] = (places[:, :2] @ axes).T * GRAVITY / self._weight
        units = DIFFERENCE * np.eye(len(offsets))
        turned = [(self.held(offsets + unit)[0] - torques) / DIFFERENCE for unit in units]
        again = np.linalg.solve(self._slopes(offsets, self._lever(offsets)), moved)
        return np.asarray(fixed - np.column_stack(turned) @ again)

    def _jacobian(self, q: Array, frame: int) -> Array:
        axes = pin.LOCAL_WORLD_ALIGNED
        return np.array(pin.computeFrameJacobian(self._model, self._data, q, frame, axes))
