"""How the deflection of a robot's hands moves with its design, its posture and the load's wrenches.

The virtual work of `mechanics.link_beams`, over CasADi: with values v in the tree, angles of base and joints
q and wrenches w of the load,

    d = sum over beams of L / (6 E I) (2 M0 m0 + M0 mL + ML m0 + 2 ML mL) + L T t / (G J) + ... = d(v, q, w)

whose gradient one reverse sweep gives. Which solid of a link is its beam, along which axis, of which
material, and what lies beyond it, are those of the design; each such plan is made into a function once.

Source: `hardware.structure`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from evodesign.body.placement import Scalar
from evodesign.hardware.structure import bending_work, torsion_work
from evodesign.mechanics.agent import Agent
from evodesign.mechanics.beams import BeamPlan, beam_along, beam_plans
from evodesign.tree.equip import actuators_of
from evodesign.tree.kinematics import Expression, Pose, euler_rotation, forward, vector
from evodesign.tree.model import Tree

Array = NDArray[np.float64]

Wrenches = Mapping[str, tuple[Expression, Expression]]
"""Force [N] and moment [N m] by frame, in the world's axes."""


@dataclass(frozen=True, slots=True)
class DeflectionSlopes:
    """The derivatives of a deflection [m].

    Args:
        values: by what programs are given, shape (n,).
        base_angles: by roll, pitch and yaw [m/rad].
        joints: by joint [m/rad].
        wrenches: by the wrench of each hand, by name of the contact, shape (6,).
    """

    values: Array
    base_angles: Array
    joints: Mapping[str, float]
    wrenches: Mapping[str, Array]


class DeflectionGradient:
    """The derivatives of the deflection of one robot's hands, for any design.

    Args:
        tree: of the robot, expressions of the design's values.
        values: these, shape (n,).
        agent: whose hands they are.
    """

    def __init__(self, tree: Tree, values: Expression, agent: Agent) -> None:
        self._tree, self._values, self._agent = tree, values, agent
        self._known: dict[tuple[BeamPlan, ...], ca.Function] = {}

    def at(
        self,
        tree: Tree,
        values: Sequence[float],
        base_angles: Array,
        joints: Mapping[str, float],
        wrenches: Mapping[str, Array],
    ) -> DeflectionSlopes:
        """The derivatives at a design and a posture.

        Args:
            tree: of the design, numbers.
            values: of the design.
            base_angles: roll, pitch and yaw of the root link [rad].
            joints: positions [rad] of the agent's joints.
            wrenches: of the load on each hand, by name of the contact.
        """
        plans = tuple(beam_plans(tree))
        if plans not in self._known:
            self._known[plans] = self._function(plans)
        names, hands = self._agent.joints, self._agent.hands
        given = [joints[name] for name in names], np.concatenate([wrenches[hand.name] for hand in hands])
        found = self._known[plans](list(values), base_angles, *given)
        by_value, by_base, by_joint, by_wrench = (np.array(each).ravel() for each in found)
        split = np.split(by_wrench, len(hands))
        return DeflectionSlopes(
            by_value,
            by_base,
            dict(zip(names, by_joint.tolist(), strict=True)),
            {hand.name: each for hand, each in zip(hands, split, strict=True)},
        )

    def _function(self, plans: Sequence[BeamPlan]) -> ca.Function:
        agent, hands = self._agent, self._agent.hands
        base, joints = ca.SX.sym("base", 3), ca.SX.sym("joints", len(agent.joints))
        load = ca.SX.sym("load", 6, len(hands))
        positions = dict(zip(agent.joints, ca.vertsplit(joints), strict=True))
        poses = forward(self._tree, Pose(euler_rotation(base), ca.DM.zeros(3)), positions)
        real = {hand.frame: (load[:3, k], load[3:, k]) for k, hand in enumerate(hands)}
        share = ca.DM([0.0, 0.0, -1.0 / len(hands)])
        virtual = {hand.frame: (share, ca.DM.zeros(3)) for hand in hands}
        moved = self._moved(plans, poses, *(self._balanced(poses, each) for each in (real, virtual)))
        given = [self._values, base, joints, ca.vec(load)]
        return ca.Function("deflection", given, [ca.gradient(moved, each) for each in given])

    def _balanced(self, poses: Mapping[str, Pose], wrenches: Wrenches) -> Wrenches:
        """Wrenches, and what the feet answer in equal parts."""
        soles = self._agent.foot_frames
        middle = sum((poses[sole].position for sole in soles), ca.DM.zeros(3)) / len(soles)
        force = sum((each for each, _ in wrenches.values()), ca.DM.zeros(3))
        moment = _moment(poses, wrenches, wrenches, middle)
        return {**wrenches, **dict.fromkeys(soles, (-force / len(soles), -moment / len(soles)))}

    def _moved(
        self, plans: Sequence[BeamPlan], poses: Mapping[str, Pose], real: Wrenches, virtual: Wrenches
    ) -> Expression:
        """The work of the real wrenches along the virtual ones' deflections [m]."""
        work: Scalar = 0.0
        for plan in plans:
            ends, axes, section, length = beam_along(self._tree.link_by_name[plan.link], plan)
            pose = poses[plan.link]
            frames = [frame for frame in real if self._is_beyond(frame, plan)]
            places = [pose.point(vector(end)) for end in ends]
            big, small = (
                [_moment(poses, each, frames, place) for place in places] for each in (real, virtual)
            )
            along, *across = (pose.rotation @ vector(axis) for axis in axes)
            for axis, inertia in zip(across, section.second_moments, strict=True):
                load, unit = ((ca.dot(m0, axis), ca.dot(ml, axis)) for m0, ml in (big, small))
                work += bending_work(length, plan.material.young * inertia, load, unit)
            twists = (ca.dot(each[0], along) for each in (big, small))
            work += torsion_work(length, plan.material.shear * section.torsion_constant, *twists)
        for name, actuator in actuators_of(self._tree).items():
            joint = self._tree.joint_by_name[name]
            pose = poses[joint.child]
            frames = [frame for frame in real if joint.child in self._tree.to_root(frame)]
            axis = pose.rotation @ vector(joint.axis)
            one, other = (
                ca.dot(axis, _moment(poses, each, frames, pose.position)) for each in (real, virtual)
            )
            work += one * other / actuator.stiffness
        return work

    def _is_beyond(self, frame: str, plan: BeamPlan) -> bool:
        """Whether a frame hangs on one of the links that follow a beam."""
        return any(child in self._tree.to_root(frame) for child in plan.beyond)


def _moment(
    poses: Mapping[str, Pose], wrenches: Wrenches, frames: Sequence[str] | Wrenches, point: Expression
) -> Expression:
    """Moment about a point of the wrenches on some frames [N m]."""
    moments = (wrenches[f][1] + ca.cross(poses[f].position - point, wrenches[f][0]) for f in frames)
    return sum(moments, ca.DM.zeros(3))
