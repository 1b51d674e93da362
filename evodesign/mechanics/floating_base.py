"""A floating tree in pinocchio: mass matrix, bias and Jacobians at a configuration and velocity.

Velocities are pinocchio's: linear and angular velocity of the root link in the root link's frame [m/s,
rad/s], then the speeds of the moving joints, here in the order that the caller asks for.

Nothing of the CasADi graph is used: pinocchio is given placements, axes and inertias, and does the rest.

Beyond 300 lines: a tree's model and its states have the same order of joints.

Source: Sartore et al. 2022, Eq. 5; pinocchio `crba`, `nonLinearEffects`, `getFrameJacobian`.
"""

from __future__ import annotations

import threading
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from evodesign.body.inertia import Inertia
from evodesign.body.placement import Placement
from evodesign.body.shape import Solid
from evodesign.mechanics.balance import GRAVITY
from evodesign.tree.model import Joint, JointKind, Tree

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


class _Workspace(threading.local):
    """Pinocchio's memory, which takes longer to make than to fill, and whose kinematics it holds.

    Attributes:
        frames: pinocchio's number of each body's frame, by name, which no design changes.
    """

    def __init__(self, model: Any) -> None:
        self.data = model.createData()
        self.holds: BodyState | None = None
        bodies = model.frames.tolist()
        self.frames = {each.name: n for n, each in enumerate(bodies) if each.type == pin.FrameType.BODY}


@dataclass(frozen=True, slots=True, eq=False)
class _Built:
    """What a model was made of.

    Args:
        tree: of numbers.
        joints: of the tree, depth first.
        moving: names of the joints that move.
        carriers: of each link: pinocchio's joint, and the link's place in its frame.
        bodies: of each link: pinocchio's inertia.
    """

    tree: Tree
    joints: tuple[Joint, ...]
    moving: frozenset[str]
    carriers: Mapping[str, tuple[int, Any]]
    bodies: Mapping[str, Any]


@dataclass(frozen=True, slots=True, eq=False)
class FloatingBody:
    """A floating tree as pinocchio sees it.

    Args:
        model: pinocchio's model, without the joints that do not move.
        joints: names of the moving joints, in the order of our rows.
        order: pinocchio's velocity index of each of our rows.
        places: pinocchio's configuration index of each moving joint.
        world_from_given: rotation from the axes in which configurations are given to the world, (3, 3).
        workspace: memory that pinocchio computes in.
        built: what the model was made of; none where it cannot be made anew for another design.
    """

    model: Any
    joints: tuple[str, ...]
    order: NDArray[np.intp]
    places: NDArray[np.intp]
    world_from_given: Array
    workspace: _Workspace
    built: _Built | None

    @property
    def size(self) -> int:
        """Number of velocities: six, and one per moving joint."""
        return ROOT + len(self.joints)

    @classmethod
    def of_tree(cls, tree: Tree, joints: Sequence[str], world_from_given: Array) -> FloatingBody:
        """A tree of numbers, floating; joints that are not named are welded at zero."""
        model, moving = pin.Model(), frozenset(joints)
        root = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "root_joint")
        carriers = {tree.root: (root, pin.SE3.Identity())}
        ordered = tuple(_depth_first(tree, tree.root))
        for joint in ordered:
            carrier, carrier_from_parent = carriers[joint.parent]
            carrier_from_child = carrier_from_parent * _placement(joint.parent_from_child)
            if joint.name in moving:
                added = model.addJoint(carrier, _joint_model(joint), carrier_from_child, joint.name)
                carriers[joint.child] = (added, pin.SE3.Identity())
            else:
                carriers[joint.child] = (carrier, carrier_from_child)
        bodies = {link.name: _body(link.inertia) for link in tree.links}
        for name, body in bodies.items():
            carrier, carrier_from_link = carriers[name]
            model.appendBodyToJoint(carrier, body, carrier_from_link)
            model.addFrame(pin.Frame(name, carrier, carrier_from_link, pin.FrameType.BODY))
        return cls._of_model(model, joints, world_from_given, _Built(tree, ordered, moving, carriers, bodies))

    def resized(self, tree: Tree) -> FloatingBody:
        """The tree of another design: what differs is put in the place of what was in a copy of the model.

        Args:
            tree: of numbers, which has all unchanged links and joints in common with the one that this was
                made of.
        """
        built, model = self.built, pin.Model(self.model)
        if built is None:
            raise ValueError("a solid is not resized")
        carriers, moved, changed = dict(built.carriers), set(), set()
        joints = {joint.name: joint for joint in tree.joints}
        if any(joints[name].axis != before.axis for name, before in built.tree.joint_by_name.items()):
            return FloatingBody.of_tree(tree, self.joints, self.world_from_given)
        for unscaled in built.joints:
            joint = joints[unscaled.name]
            if joint is unscaled and joint.parent not in moved:
                continue
            carrier, carrier_from_parent = carriers[joint.parent]
            carrier_from_child = carrier_from_parent * _placement(joint.parent_from_child)
            if joint.name in built.moving:
                model.jointPlacements[carriers[joint.child][0]] = carrier_from_child
            else:
                carriers[joint.child] = (carrier, carrier_from_child)
                moved.add(joint.child)
        bodies = dict(built.bodies)
        for before, link in zip(built.tree.links, tree.links, strict=True):
            carrier, carrier_from_link = carriers[link.name]
            if link is not before:
                bodies[link.name] = _body(link.inertia)
            if link.name in moved:
                model.frames[model.getFrameId(link.name, pin.FrameType.BODY)].placement = carrier_from_link
            if link is not before or link.name in moved:
                changed.add(carrier)
        for carrier in changed:
            model.inertias[carrier] = pin.Inertia.Zero()
        for name, body in bodies.items():
            carrier, carrier_from_link = carriers[name]
            if carrier in changed:
                model.appendBodyToJoint(carrier, body, carrier_from_link)
        made_of = replace(built, tree=tree, carriers=carriers, bodies=bodies)
        return replace(self, model=model, built=made_of)

    def carrying(self, solids: Iterable[tuple[str, Solid]]) -> FloatingBody:
        """The same body with solids fixed to some links, such as actuators.

        Args:
            solids: numbers, in the frame of the link that is named.
        """
        built, model = self.built, pin.Model(self.model)
        if built is None:
            raise ValueError("a solid carries nothing")
        for name, solid in solids:
            carrier, carrier_from_link = built.carriers[name]
            model.appendBodyToJoint(carrier, _body(solid.inertia), carrier_from_link)
        return replace(self, model=model)

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
    def _of_model(
        cls, model: Any, joints: Sequence[str], world_from_given: Array, built: _Built | None = None
    ) -> FloatingBody:
        model.gravity.linear = np.array([0.0, 0.0, -GRAVITY])
        columns = [model.joints[model.getJointId(name)].idx_v for name in joints]
        places = np.array([model.joints[model.getJointId(name)].idx_q for name in joints], int)
        order = np.array([*range(ROOT), *columns])
        workspace = _Workspace(model)
        return cls(model, tuple(joints), order, places, world_from_given, workspace, built)

    def at(
        self, configuration: Configuration, velocity: Array, acceleration: Array | None = None
    ) -> BodyState:
        """The body at a configuration, moving with a velocity of shape (6 + joints,).

        Args:
            configuration: in the given axes.
            velocity: of the root link in its own axes, then of the joints.
            acceleration: its derivative, shape (6 + joints,); None: the velocity does not change.
        Raises:
            ValueError: the configuration places other joints than those that move.
        """
        model, data = self.model, self.workspace.data
        q, v = self._coordinates(configuration), np.empty(model.nv)
        v[self.order] = velocity
        self.workspace.holds = None
        if acceleration is None:
            return BodyState(self, q, v, np.array(pin.nonLinearEffects(model, data, q, v))[self.order])
        dv = np.empty(model.nv)
        dv[self.order] = acceleration
        return BodyState(self, q, v, np.array(pin.rnea(model, data, q, v, dv))[self.order])

    def _coordinates(self, configuration: Configuration) -> Array:
        """The configuration vector of pinocchio, in the world."""
        differing = set(configuration.joints) ^ set(self.joints)
        if differing:
            raise ValueError(f"a configuration places exactly the joints that move; see {sorted(differing)}")
        world_from_base = self.world_from_given @ pin.rpy.rpyToMatrix(*configuration.base_angles)
        q = np.empty(self.model.nq)
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
        speeds: pinocchio's velocity vector.
        bias: Coriolis, centrifugal and gravity terms h, shape (v,), and M dnu/dt where it accelerates.
    """

    body: FloatingBody
    coordinates: Array
    speeds: Array
    bias: Array

    @property
    def data(self) -> Any:
        """Pinocchio's, with this state's kinematics at zero acceleration, until another's are asked for."""
        body, q = self.body, self.coordinates
        model, workspace = body.model, body.workspace
        if workspace.holds is not self:
            pin.computeJointJacobians(model, workspace.data, q)
            pin.forwardKinematics(model, workspace.data, q, self.speeds, np.zeros(model.nv))  # last: dJ/dt nu
            pin.updateFramePlacements(model, workspace.data)
            workspace.holds = self
        return workspace.data

    @property
    def mass(self) -> Array:
        """Mass matrix M, shape (v, v)."""
        model, order = self.body.model, self.body.order
        return np.array(pin.crba(model, model.createData(), self.coordinates))[np.ix_(order, order)]

    def twist_in_frame(self, frame: str) -> tuple[Array, Array]:
        """J, shape (6, v), and dJ/dt nu of a frame's linear and angular velocity in the frame's own axes."""
        identity = self._identity(frame)
        drift = pin.getFrameAcceleration(self.body.model, self.data, identity, pin.LOCAL)
        return self.jacobian_in_frame(frame), np.array(drift.vector)

    def twist_in_world(self, frame: str) -> tuple[Array, Array]:
        """J, shape (6, v), and dJ/dt nu of a frame's linear and angular velocity in world axes."""
        identity, axes = self._identity(frame), pin.LOCAL_WORLD_ALIGNED
        drift = pin.getFrameClassicalAcceleration(self.body.model, self.data, identity, axes)
        return self.jacobian_in_world(frame), np.array(drift.vector)

    def jacobian_in_frame(self, frame: str) -> Array:
        """J, shape (6, v), of a frame's linear and angular velocity in the frame's own axes."""
        return self._jacobian(frame, pin.LOCAL)

    def jacobian_in_world(self, frame: str) -> Array:
        """J, shape (6, v), of a frame's linear and angular velocity in world axes."""
        return self._jacobian(frame, pin.LOCAL_WORLD_ALIGNED)

    def pose(self, frame: str) -> tuple[Array, Array]:
        """Rotation, shape (3, 3), and origin [m], shape (3,), of a frame in the world."""
        placement = self.data.oMf[self._identity(frame)]
        return np.array(placement.rotation), np.array(placement.translation)

    def poses(self, frames: Sequence[str]) -> Array:
        """Rotations and origins [m] of frames in the world, as matrices of shape (n, 4, 4)."""
        placements = self.data.oMf
        return np.array([placements[self._identity(frame)].homogeneous for frame in frames])

    def _identity(self, frame: str) -> int:
        return self.body.workspace.frames[frame]

    def _jacobian(self, frame: str, axes: Any) -> Array:
        jacobian = pin.getFrameJacobian(self.body.model, self.data, self._identity(frame), axes)
        return np.asarray(jacobian[:, self.body.order])
