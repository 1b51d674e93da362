"""How the torques of a robot that stands alone move with its design.

The statics of `mechanics.stance_torques`, over CasADi: with the design's values v in the tree, and offsets
d of the joints that balance,

    0 = L(v, d)        tau = T(v, d)        d tau = (T_v - T_d L_d^-1 L_v) dv

Everything is in the axes of the root link, and the first sole says which way is up. Weights and loads beyond
a joint, and what the feet pass there, act on it; of two feet's forces those that are least carry the rest,

    f = S / 2 +- h,    h = N x r / |r|^2    with S = -sum of forces,  N = -moment left,  r between the soles

Source: implicit function theorem; statics by cutting the tree, as everywhere.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from evodesign.mechanics.balance import GRAVITY
from evodesign.mechanics.dynamics import has_mass
from evodesign.mechanics.stance_case import StanceCase
from evodesign.tree.kinematics import Expression, Pose, forward, vector
from evodesign.tree.model import Joint, JointKind, Tree

Array = NDArray[np.float64]


class StanceGradient:
    """The derivatives of one case's torques.

    Args:
        case: posture and feet.
        tree: of the robot, expressions of the design's values.
        values: these, shape (n,).
        joints: whose torques are asked for.
    """

    def __init__(self, case: StanceCase, tree: Tree, values: Expression, joints: Sequence[str]) -> None:
        self._joints = tuple(joints)
        offsets, weights = ca.SX.sym("offsets", len(case.groups)), ca.SX.sym("weights", len(joints))
        lever, torques = _statics(case, tree, offsets)
        asked = ca.dot(weights, ca.vertcat(*[torques[name] for name in joints]))
        given = (values, offsets)
        slopes = [
            *(ca.jacobian(asked, each) for each in given),
            *(ca.jacobian(lever, each) for each in given),
        ]
        self._function = ca.Function("stance_gradient", [*given, weights], slopes)

    def along(self, values: Sequence[float], offsets: Sequence[float], weights: Mapping[str, float]) -> Array:
        """The derivatives of a weighted sum of torques by the values, the robot balanced again, shape (n,).

        Args:
            values: of the design.
            offsets: of the groups of joints that balance [rad].
            weights: of the torques, by joint; those left out do not count.
        """
        counted = [weights.get(name, 0.0) for name in self._joints]
        found = [np.array(each) for each in self._function(list(values), list(offsets), counted)]
        by_value, by_offset, lever_by_value, lever_by_offset = found
        return np.asarray(by_value - by_offset @ np.linalg.solve(lever_by_offset, lever_by_value)).ravel()


def _statics(case: StanceCase, tree: Tree, offsets: Expression) -> tuple[Expression, dict[str, Expression]]:
    """The lever that balances at zero [m], and the torque of every joint [N m]."""
    positions = case.positions(ca.vertsplit(offsets))
    poses = forward(tree, Pose(ca.DM.eye(3), ca.DM.zeros(3)), positions)
    soles = [poses[sole] for sole in case.soles]
    upright, up = soles[0].rotation.T, soles[0].rotation[:, 2]
    middle = sum((sole.position for sole in soles), ca.DM.zeros(3)) / len(soles)
    acting = [
        (link.name, poses[link.name].point(vector(link.inertia.center)), -GRAVITY * link.inertia.mass * up)
        for link in tree.links
        if has_mass(link.inertia)
    ]
    weight = -sum(ca.dot(up, force) for _, _, force in acting)
    for frame, load in case.loads:
        acting.append((frame, poses[frame].position, soles[0].rotation @ ca.DM(list(load))))
    force, moment = _sums(acting, middle)
    lever = (upright @ ca.cross(moment, up))[:2] / weight
    acting += _passed(case.soles, soles, force, moment, middle)
    if len(soles) == 1:
        twist = {case.soles[0]: -ca.dot(up, moment) * up}
    else:
        twist, across = {}, (upright @ (soles[0].position - soles[1].position))[:2]
        lever = (across[1] * lever[0] - across[0] * lever[1]) / ca.norm_2(across)
    if case.raised is not None:
        above = ca.dot(up, poses[case.raised.frame].position - middle) - case.raised.height
        lever = ca.vertcat(lever, above)
    return lever, _torques(tree, poses, acting, twist)


def _sums(acting: Sequence[tuple[str, Expression, Expression]], about: Expression) -> tuple[Expression, ...]:
    """Force and moment about a point of what acts at places."""
    force = sum((each for _, _, each in acting), ca.DM.zeros(3))
    return force, sum((ca.cross(place - about, each) for _, place, each in acting), ca.DM.zeros(3))


def _passed(
    names: Sequence[str], soles: Sequence[Pose], force: Expression, moment: Expression, middle: Expression
) -> list[tuple[str, Expression, Expression]]:
    """What the ground passes at the origins of the soles."""
    if len(soles) == 1:
        return [(names[0], middle, -force)]
    apart = soles[0].position - soles[1].position
    couple = -ca.cross(moment, apart) / ca.dot(apart, apart)
    return [
        (names[0], soles[0].position, couple - force / 2.0),
        (names[1], soles[1].position, -couple - force / 2.0),
    ]


def _torques(
    tree: Tree,
    poses: Mapping[str, Pose],
    acting: Sequence[tuple[str, Expression, Expression]],
    twist: Mapping[str, Expression],
) -> dict[str, Expression]:
    """What holds each joint against all that acts beyond it; moments are about the root's origin."""
    forces: dict[str, Expression] = {link.name: ca.DM.zeros(3) for link in tree.links}
    moments: dict[str, Expression] = {**forces, **twist}
    for name, place, force in acting:
        forces[name] += force
        moments[name] += ca.cross(place, force)
    held: dict[str, Expression] = {}
    for joint in reversed(tree.joints):
        force, moment = forces[joint.child], moments[joint.child]
        held[joint.name] = _held(joint, poses[joint.child], force, moment)
        forces[joint.parent] += force
        moments[joint.parent] += moment
    return held


def _held(joint: Joint, pose: Pose, force: Expression, moment: Expression) -> Expression:
    axis = pose.rotation @ vector(joint.axis)
    if joint.kind is JointKind.PRISMATIC:
        return -ca.dot(axis, force)
    return -ca.dot(axis, moment - ca.cross(pose.position, force))
