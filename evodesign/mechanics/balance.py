"""Static equilibrium by cutting.

Cut the tree at a joint: what lies beyond is held by the joint, so the joint's torque balances the moment
about the joint of all external forces (weights, contact wrenches) on that part, and the whole tree's
external force and moment vanish:

    tau_j = -a_j . n_j          0 = F_tree          0 = n_tree

with a_j the axis and n_j the moment of the part beyond joint j about the joint. This equals
tau = g_joint(q, pi) - J_joint^T f and 0 = g_base - J_base^T f without Jacobians or a mass matrix, and is
linear in the wrenches.

Source: equivalent to Sartore et al. 2022, Eq. 12, as docs/model.md, section 3, shows.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass

import casadi as ca

from evodesign.tree.kinematics import Expression, Pose, forward, vector
from evodesign.tree.model import JointKind, Tree

GRAVITY = 9.81
"""Gravitational acceleration [m/s^2], along -z of the world."""


@dataclass(frozen=True, slots=True)
class AppliedWrench:
    """An external force on a link.

    Args:
        link: its name.
        point: where the force acts, in the world [m].
        force: in world axes [N].
        moment: about the point, in world axes [N m].
    """

    link: str
    point: Expression
    force: Expression
    moment: Expression


@dataclass(frozen=True, slots=True)
class Balance:
    """What holds a tree still.

    Args:
        torques: joint torque [N m] (force [N] for prismatic joints) by joint name, for every joint that
            can move.
        force: sum of external forces on the tree, world axes [N]; zero at equilibrium.
        moment: sum of external moments about the root's origin, world axes [N m]; zero at equilibrium.
    """

    torques: Mapping[str, Expression]
    force: Expression
    moment: Expression


def cut(
    tree: Tree,
    poses: Mapping[str, Pose],
    applied: Sequence[AppliedWrench],
    doubled: Set[str] = frozenset(),
) -> Balance:
    """Joint torques and base residuals of a tree under its weight and the applied wrenches.

    Args:
        tree: numbers or expressions.
        poses: of all links.
        applied: external wrenches beside the weights.
        doubled: joints of the middle line (in the plane y = 0) whose branch stands for its mirror image
            too: what both pass on is (2 F_x, 0, 2 F_z) and (0, 2 n_y, 0).
    """
    forces: dict[str, Expression] = {}
    moments: dict[str, Expression] = {}
    for link in tree.links:
        forces[link.name], moments[link.name] = _external(tree, poses, link.name, applied)
    torques: dict[str, Expression] = {}
    for joint in reversed(tree.joints):
        force, moment = forces[joint.child], moments[joint.child]
        axis = poses[joint.child].rotation @ vector(joint.axis)
        if joint.kind is JointKind.PRISMATIC:
            torques[joint.name] = -ca.dot(axis, force)
        elif joint.kind is not JointKind.FIXED:
            torques[joint.name] = -ca.dot(axis, moment)
        lever = poses[joint.child].position - poses[joint.parent].position
        moment = moment + ca.cross(lever, force)
        if joint.name in doubled:
            force, moment = force * ca.DM([2.0, 0.0, 2.0]), moment * ca.DM([0.0, 2.0, 0.0])
        forces[joint.parent] += force
        moments[joint.parent] += moment
    ordered = {name: torques[name] for name in tree.actuated}
    return Balance(ordered, forces[tree.root], moments[tree.root])


def _external(
    tree: Tree, poses: Mapping[str, Pose], name: str, applied: Sequence[AppliedWrench]
) -> tuple[Expression, Expression]:
    """Force and moment about the link's origin of everything outside that acts on one link."""
    pose = poses[name]
    force, moment = ca.DM.zeros(3), ca.DM.zeros(3)
    inertia = tree.link_by_name[name].inertia
    if not (isinstance(inertia.mass, int | float) and inertia.mass == 0.0):
        weight = ca.vertcat(0.0, 0.0, -GRAVITY * inertia.mass)
        force = force + weight
        moment = moment + ca.cross(pose.rotation @ vector(inertia.center), weight)
    for wrench in applied:
        if wrench.link == name:
            force = force + wrench.force
            moment = moment + wrench.moment + ca.cross(wrench.point - pose.position, wrench.force)
    return force, moment


def center_of_mass(tree: Tree, poses: Mapping[str, Pose]) -> tuple[Expression, Expression]:
    """Total mass [kg] and centre of mass in the world [m]."""
    mass: Expression = 0.0
    first: Expression = ca.DM.zeros(3)
    for link in tree.links:
        inertia = link.inertia
        mass = mass + inertia.mass
        first = first + inertia.mass * poses[link.name].point(vector(inertia.center))
    return mass, first / mass


def standing_height_of_mass(tree: Tree, soles: tuple[str, ...]) -> Expression:
    """Height [m] of a tree's centre of mass above its lowest sole frame, all joints at zero.

    The tree holds numbers or expressions, and so does the result.

    Source: Sartore et al. 2022, task t4 (centre-of-mass height at the null configuration).
    """
    poses = forward(tree, Pose(ca.DM.eye(3), ca.DM.zeros(3)), {})
    _, center = center_of_mass(tree, poses)
    return center[2] - ca.mmin(ca.vertcat(*[poses[sole].position[2] for sole in soles]))
