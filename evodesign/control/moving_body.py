"""An agent in the world as pinocchio sees it while it moves: what its equation of motion needs, at one state.

    M a + h = S' tau + sum over feet J' f + sum over hands J' f

Velocities are pinocchio's: linear and angular velocity of the root link in its own axes, then the speeds of
the joints, in pinocchio's order. Rotors turn with their joints: their reflected inertia is on M's diagonal.

Source: Featherstone 2008, Rigid Body Dynamics Algorithms, chapters 5, 6 and 9; pinocchio `computeAllTerms`,
`getFrameJacobian`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from evodesign.mechanics.agent import Agent
from evodesign.mechanics.floating_base import ROOT, FloatingBody
from evodesign.posture.results import AgentPosture
from evodesign.tree.equip import actuators_of
from evodesign.tree.model import Tree

Array = NDArray[np.float64]

LOCAL, ALIGNED = pin.LOCAL, pin.LOCAL_WORLD_ALIGNED


@dataclass(frozen=True, slots=True)
class FrameMotion:
    """How a frame of the body moves.

    Args:
        turn: its rotation in the world, shape (3, 3).
        place: its origin in the world [m], shape (3,).
        jacobian: of linear and angular velocity, shape (6, v).
        velocity: [m/s, rad/s], shape (6,).
        drift: its acceleration where the body's velocities do not change, shape (6,).
    """

    turn: Array
    place: Array
    jacobian: Array
    velocity: Array
    drift: Array


@dataclass(frozen=True, slots=True, eq=False)
class Leg:
    """Places of a leg's joints in the world [m], shape (3,) each.

    Args:
        top: of its first joint.
        hip: of its last joint before the knee.
        knee: of the joint that is far from both ends.
        ankle: of its last joint.
        knee_joint: the knee's place in the agent's order of joints.
    """

    top: Array
    hip: Array
    knee: Array
    ankle: Array
    knee_joint: int

    @property
    def length(self) -> float:
        """Of thigh and shank together [m]."""
        return float(np.linalg.norm(self.hip - self.knee) + np.linalg.norm(self.knee - self.ankle))

    @property
    def height(self) -> float:
        """Of the hip above a floor at zero on which the foot stands, with the leg straight [m]."""
        return self.length + float(self.ankle[2])

    def span(self, flexion: float) -> float:
        """Distance of hip and ankle with a knee that is bent by an angle [rad]."""
        thigh, shank = np.linalg.norm(self.hip - self.knee), np.linalg.norm(self.knee - self.ankle)
        return float(np.sqrt(thigh**2 + shank**2 + 2.0 * thigh * shank * np.cos(flexion)))


@dataclass(frozen=True, slots=True, eq=False)
class BodyMotion:
    """A body's equation of motion at one state, v velocities.

    Args:
        velocity: shape (v,).
        mass: M, shape (v, v).
        bias: h, shape (v,).
        center: centre of mass in the world, with its motion; three rows.
        spin: mean moment of inertia about the centre of mass, all joints locked [kg m^2].
        feet: soles in their own axes.
        hands: in world axes.
        trunk: in world axes.
    """

    velocity: Array
    mass: Array
    bias: Array
    center: FrameMotion
    spin: float
    feet: tuple[FrameMotion, ...]
    hands: tuple[FrameMotion, ...]
    trunk: FrameMotion


class MovingBody:
    """An agent's tree in the world.

    Args:
        agent: whose it is.
        tree: of numbers.
    Attributes:
        agent: whose it is.
        total: its mass [kg].
        places: index in pinocchio's configuration of each joint, in the agent's order, shape (j,).
        rates: index in pinocchio's velocities of each joint, likewise.
        rotors: reflected inertia of each velocity's rotor [kg m^2], zero for the root's, shape (v,).
    """

    def __init__(self, agent: Agent, tree: Tree) -> None:
        body = FloatingBody.of_tree(tree, agent.joints, np.eye(3))
        self.agent, self._model, self._data = agent, body.model, body.model.createData()
        self.total = float(sum(inertia.mass for inertia in body.model.inertias.tolist()))
        self.places, self.rates = body.places, body.order[ROOT:]
        frames = body.workspace.frames
        self._feet = [frames[name] for name in agent.foot_frames]
        self._hands = [frames[name] for name in agent.hand_frames]
        self._trunk = frames[agent.pushed_frame]
        self.rotors, self._still = np.zeros(body.model.nv), np.zeros(body.model.nv)
        driven = actuators_of(tree)
        for joint, rate in zip(agent.joints, self.rates, strict=True):
            self.rotors[rate] = float(driven[joint].inertia) if joint in driven else 0.0

    @property
    def size(self) -> int:
        """Number of velocities v."""
        return int(self._model.nv)

    def coordinates(self, root: Array, joints: Array) -> Array:
        """Pinocchio's configuration.

        Args:
            root: place [m] and quaternion wxyz of the root link in the world, shape (7,).
            joints: positions [rad], in the agent's order.
        """
        q = np.empty(self._model.nq)
        q[:3], q[3:6], q[6] = root[:3], root[4:7], root[3]
        q[self.places] = joints
        return q

    def posed(self, base_position: Array, base_angles: Array, joints: Mapping[str, float]) -> Array:
        """Pinocchio's configuration of a posture that is given in the agent's frame."""
        turn = self.agent.turn @ pin.rpy.rpyToMatrix(*base_angles)
        x, y, z, w = pin.Quaternion(turn).coeffs()
        root = np.concatenate([self.agent.turn @ base_position, [w, x, y, z]])
        return self.coordinates(root, np.array([joints[name] for name in self.agent.joints]))

    def moved(self, q: Array, step: Array) -> Array:
        """A configuration after a step in the directions of its velocities, shape (v,)."""
        return np.asarray(pin.integrate(self._model, q, step))

    def posture(self, q: Array, v: Array, torques: Array, feet: Array, hands: Array) -> AgentPosture:
        """A state as a posture in the agent's frame.

        Args:
            q: configuration.
            v: velocities.
            torques: of the joints, in the agent's order [N m].
            feet: wrenches on the feet in their sole frames, shape (feet, 6).
            hands: wrenches on the hands in world axes, shape (hands, 6).
        """
        agent, turn = self.agent, self.agent.turn.T
        root = pin.Quaternion(q[3:7]).toRotationMatrix()
        wrenches = {foot.name: wrench for foot, wrench in zip(agent.feet, feet, strict=True)}
        for hand, wrench in zip(agent.hands, hands, strict=True):
            wrenches[hand.name] = np.concatenate([turn @ wrench[:3], turn @ wrench[3:]])
        return AgentPosture(
            base_position=turn @ q[:3],
            base_angles=np.array(pin.rpy.matrixToRpy(turn @ root)),
            joints=dict(zip(agent.joints, q[self.places].tolist(), strict=True)),
            torques=dict(zip(agent.joints, torques.tolist(), strict=True)),
            wrenches=wrenches,
            speeds=dict(zip(agent.joints, v[self.rates].tolist(), strict=True)),
        )

    def legs(self, q: Array) -> list[Leg]:
        """Each foot's leg at a configuration."""
        model, legs = self._model, []
        pin.forwardKinematics(model, self._data, q)
        chains = [list(model.supports[model.frames[foot].parentJoint]) for foot in self._feet]
        for chain in chains:
            joints = [
                each for each in chain if not any(each in other for other in chains if other is not chain)
            ]
            places = np.array([self._data.oMi[each].translation for each in joints])
            to_hip, to_ankle = (np.linalg.norm(places - end, axis=1) for end in (places[0], places[-1]))
            knee = int(np.argmax(np.minimum(to_hip, to_ankle)))
            number = int(np.flatnonzero(self.rates == model.idx_vs[joints[knee]])[0])
            legs.append(Leg(places[0], places[knee - 1], places[knee], places[-1], number))
        return legs

    def inverse_dynamics(self, q: Array, v: Array, acceleration: Array, feet: Array, hands: Array) -> Array:
        """Forces that a motion takes beside those of feet and hands, by pinocchio's RNEA, shape (v,).

        Args:
            q: configuration.
            v: velocity.
            acceleration: of the velocities, shape (v,).
            feet: wrenches on the feet in their sole frames, shape (feet, 6).
            hands: wrenches on the hands in world axes about their origins, shape (hands, 6).
        """
        model, data = self._model, self._data
        pin.framesForwardKinematics(model, data, q)
        outer = [pin.Force.Zero() for _ in range(model.njoints)]
        for frame, wrench in [*zip(self._feet, feet, strict=True), *zip(self._hands, hands, strict=True)]:
            placed, carrier = model.frames[frame].placement, model.frames[frame].parentJoint
            if frame in self._hands:
                turn = data.oMf[frame].rotation.T
                wrench = np.concatenate([turn @ wrench[:3], turn @ wrench[3:]])
            outer[carrier] = outer[carrier] + placed.act(pin.Force(wrench))
        vector = pin.StdVec_Force()
        vector.extend(outer)
        return np.array(pin.rnea(model, data, q, v, acceleration, vector)) + self.rotors * acceleration

    def at(self, q: Array, v: Array) -> BodyMotion:
        """What the equation of motion needs at a state."""
        model, data = self._model, self._data
        pin.computeAllTerms(model, data, q, v)
        pin.forwardKinematics(model, data, q, v, self._still)
        pin.centerOfMass(model, data, pin.ACCELERATION, False)
        mass = data.M + np.diag(self.rotors)
        bias, spin = np.array(data.nle), float(np.trace(data.Ig.inertia)) / 3.0
        center = FrameMotion(
            np.eye(3),
            np.array(data.com[0]),
            np.array(data.Jcom),
            np.array(data.vcom[0]),
            np.array(data.acom[0]),
        )
        return BodyMotion(
            velocity=v,
            mass=mass,
            bias=bias,
            center=center,
            spin=spin,
            feet=tuple(self._frame(foot, LOCAL) for foot in self._feet),
            hands=tuple(self._frame(hand, ALIGNED) for hand in self._hands),
            trunk=self._frame(self._trunk, ALIGNED),
        )

    def _frame(self, frame: int, axes: object) -> FrameMotion:
        model, data = self._model, self._data
        pose = pin.updateFramePlacement(model, data, frame)
        velocity = pin.getFrameVelocity(model, data, frame, axes).vector
        drift = (
            pin.getFrameAcceleration(model, data, frame, axes)
            if axes is LOCAL
            else pin.getFrameClassicalAcceleration(model, data, frame, axes)
        ).vector
        return FrameMotion(
            np.array(pose.rotation),
            np.array(pose.translation),
            np.array(pin.getFrameJacobian(model, data, frame, axes)),
            np.array(velocity),
            np.array(drift),
        )
