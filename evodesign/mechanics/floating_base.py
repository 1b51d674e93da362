"""A floating tree in pinocchio: mass matrix, bias and Jacobians at a configuration and velocity.

Velocities are pinocchio's: linear and angular velocity of the root link in the root link's frame [m/s,
rad/s], then the speeds of the moving joints, here in the order that the caller asks for.

Nothing of the CasADi graph is used: pinocchio is given placements, axes and inertias, and does the rest.

Source: Sartore et al. 2022, Eq. 5; pinocchio `crba`, `nonLinearEffects`, `getFrameJacobian`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from evodesign.body.inertia import Inertia
from evodesign.body.placement import Placement
from evodesign.mechanics.balance import GRAVITY
from evodesign.tree.model import Joint, JointKind, Tree

__all__ = ["ROOT", "BodyState", "Configuration", "FloatingBody"]

Array = NDArray[np.float64]

ROOT = 6
"""Velocities of the root link; those of the joints follow."""


@dataclass(frozen=True, slots=True, eq=False)
class Configuration:
    """Where a floating tree is.

    Args:
        base_position: origin of the root link [m], shape (3,).
        base_angles: roll, pitch, yaw of the root link [rad], shape (3,).
        joints: position [rad or m] of every joint that moves, by name.
    """

    base_position: Array
    base_angles: Array
    joints: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, eq=False)
class FloatingBody:
    """A floating tree as pinocchio sees it.

    Args:
        model: pinocchio's model, without the joints that do not move.
        joints: names of the moving joints, in the order of our rows.
        order: pinocchio's velocity index of each of our rows.
        places: pinocchio's configuration index of each moving joint.
        world_from_given: rotation from the axes in which configurations are given to the world, (3, 3).
    """

    model: Any
    joints: tuple[str, ...]
    order: NDArray[np.intp]
    places: NDArray[np.intp]
    world_from_given: Array

    @property
    def size(self) -> int:
        """Number of velocities: six, and one per moving joint."""
        return ROOT + len(self.joints)

    @classmethod
    def of_tree(cls, tree: Tree, joints: Sequence[str], world_from_given: Array) -> FloatingBody:
        """A tree of numbers, floating; joints that are not named are welded at zero."""
        model = pin.Model()
        root = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "root_joint")
        carriers = {tree.root: (root, pin.SE3.Identity())}
        for joint in _depth_first(tree, tree.root):
            carrier, carrier_from_parent = carriers[joint.parent]
            carrier_from_child = carrier_from_parent * _placement(joint.parent_from_child)
            if joint.name in joints:
                moving = model.addJoint(carrier, _joint_model(joint), carrier_from_child, joint.name)
                carriers[joint.child] = (moving, pin.SE3.Identity())
            else:
                carriers[joint.child] = (carrier, carrier_from_child)
        for link in tree.links:
            carrier, carrier_from_link = carriers[link.name]
            model.appendBodyToJoint(carrier, _body(link.inertia), carrier_from_link)
            model.addFrame(pin.Frame(link.name, carrier, carrier_from_link, pin.FrameType.BODY))
        return cls._of_model(model, joints, world_from_given)

    @classmethod
    def of_solid(cls, inertia: Inertia, points: Mapping[str, Array]) -> FloatingBody:
        """One rigid body with frames at the given points, configured in the world.

        Args:
            inertia: in the body's frame, numbers.
            points: in the body's frame [m], by frame name.
        """
        model = pin.Model()
        joint = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "root_joint")
        model.appendBodyToJoint(joint, _body(inertia), pin.SE3.Identity())
        for name, point in points.items():
            model.addFrame(pin.Frame(name, joint, pin.SE3(np.eye(3), point), pin.FrameType.BODY))
        return cls._of_model(model, (), np.eye(3))

    @classmethod
    def _of_model(cls, model: Any, joints: Sequence[str], world_from_given: Array) -> FloatingBody:
        model.gravity.linear = np.array([0.0, 0.0, -GRAVITY])
        columns = [model.joints[model.getJointId(name)].idx_v for name in joints]
        places = np.array([model.joints[model.getJointId(name)].idx_q for name in joints], int)
        return cls(model, tuple(joints), np.array([*range(ROOT), *columns]), places, world_from_given)

    def at(self, configuration: Configuration, velocity: Array) -> BodyState:
        """The body at a configuration, moving with a velocity of shape (6 + joints,).

        Raises:
            ValueError: the configuration places other joints than those that move.
        """
        model, data = self.model, self.model.createData()
        q, v = self._coordinates(configuration), np.empty(model.nv)
        v[self.order] = velocity
        bias = np.array(pin.nonLinearEffects(model, data, q, v))[self.order]
        pin.computeJointJacobians(model, data, q)
        pin.forwardKinematics(model, data, q, v, np.zeros(model.nv))  # last: it leaves dJ/dt nu in `data`
        pin.updateFramePlacements(model, data)
        return BodyState(self, q, bias, data)

    def _coordinates(self, configuration: Configuration) -> Array:
        """The configuration vector of pinocchio, in the world."""
        differing = set(configuration.joints) ^ set(self.joints)
        if differing:
            raise ValueError(f"a configuration places exactly the joints that move; see {sorted(differing)}")
        world_from_base = self.world_from_given @ pin.rpy.rpyToMatrix(*configuration.base_angles)
        q = np.array(pin.neutral(self.model))
        q[:3] = self.world_from_given @ configuration.base_position
        q[3:7] = pin.Quaternion(world_from_base).coeffs()
        q[self.places] = [configuration.joints[name] for name in self.joints]
        return q


def _depth_first(tree: Tree, link: str) -> Iterator[Joint]:
    """The joints below a link in the order that pinocchio relies on: every subtree without a gap."""
    for joint in tree.child_joints[link]:
        yield joint
        yield from _depth_first(tree, joint.child)


def _placement(placement: Placement) -> Any:
    return pin.SE3(np.array(placement.rotation), np.array(placement.translation))


def _body(inertia: Inertia) -> Any:
    body = pin.Inertia.Zero()  # whose constructor would refuse tensors that no body has, but files do
    body.mass, body.lever = float(inertia.mass), np.array(inertia.center, dtype=float)
    body.inertia = np.array(inertia.about_center, dtype=float)
    return body


def _joint_model(joint: Joint) -> Any:
    axis = np.array(joint.axis)
    prismatic = joint.kind is JointKind.PRISMATIC
    return pin.JointModelPrismaticUnaligned(axis) if prismatic else pin.JointModelRevoluteUnaligned(axis)


@dataclass(frozen=True, slots=True, eq=False)
class BodyState:
    """A floating body at one configuration and velocity, v velocities.

    Args:
        body: the body.
        coordinates: pinocchio's configuration vector.
        bias: Coriolis, centrifugal and gravity terms h, shape (v,).
        data: pinocchio's, with kinematics at zero acceleration.
    """

    body: FloatingBody
    coordinates: Array
    bias: Array
    data: Any

    @property
    def mass(self) -> Array:
        """Mass matrix M, shape (v, v)."""
        model, order = self.body.model, self.body.order
        return np.array(pin.crba(model, model.createData(), self.coordinates))[np.ix_(order, order)]

    def twist_in_frame(self, frame: str) -> tuple[Array, Array]:
        """J, shape (6, v), and dJ/dt nu of a frame's linear and angular velocity in the frame's own axes."""
        identity = self._identity(frame)
        drift = pin.getFrameAcceleration(self.body.model, self.data, identity, pin.LOCAL)
        return self._jacobian(identity, pin.LOCAL), np.array(drift.vector)

    def twist_in_world(self, frame: str) -> tuple[Array, Array]:
        """J, shape (6, v), and dJ/dt nu of a frame's linear and angular velocity in world axes."""
        identity, axes = self._identity(frame), pin.LOCAL_WORLD_ALIGNED
        drift = pin.getFrameClassicalAcceleration(self.body.model, self.data, identity, axes)
        return self._jacobian(identity, axes), np.array(drift.vector)

    def pose(self, frame: str) -> tuple[Array, Array]:
        """Rotation, shape (3, 3), and origin [m], shape (3,), of a frame in the world."""
        placement = self.data.oMf[self._identity(frame)]
        return np.array(placement.rotation), np.array(placement.translation)

    def _identity(self, frame: str) -> int:
        return int(self.body.model.getFrameId(frame, pin.FrameType.BODY))

    def _jacobian(self, identity: int, axes: Any) -> Array:
        jacobian = np.array(pin.getFrameJacobian(self.body.model, self.data, identity, axes))
        return jacobian[:, self.body.order]
