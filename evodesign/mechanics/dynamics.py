"""Dynamics of a floating tree, written once over CasADi (numbers as DM, expressions as SX).

    M(q, pi) dnu/dt + h(q, nu, pi) = (0, tau) + J^T f

Everything is written in the axes of the root link, at the moment in question: the root's pose then enters
through the direction of gravity alone. Columns nu, dnu/dt and generalised forces are pinocchio's, beside the
order of the joints:

    nu      linear and angular velocity of the root link in its own axes [m/s, rad/s]; speed of each joint
    dnu/dt  time derivative of these numbers: the root's origin accelerates with a = dv/dt + omega x v
    force   force and moment about the root's origin in its own axes [N, N m]; torque or force of each joint

Joints that are not asked for stand still at their positions.

Inverse dynamics cuts the tree at a joint, as statics does, with the inertial forces among the external ones
(d'Alembert): outwards come velocities and accelerations, inwards forces (Luh, Walker and Paul 1980). The mass
matrix adds composite bodies: M_ij = s_i^T I_j s_j, with s_i the unit motion of joint i and I_j the inertia of
all that moves with joint j, if j is i or beyond i, and zero if neither is beyond the other.

Source: Sartore et al. 2022, Eq. 1, 4 and 5; Featherstone 2014, ch. 5 and 6.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import casadi as ca

from evodesign.body.inertia import Inertia
from evodesign.body.placement import Matrix
from evodesign.tree.kinematics import Expression, Pose, forward, vector
from evodesign.tree.model import Joint, JointKind, Tree

ROOT_ROWS = 6
"""Rows of nu that belong to the root link; the joints follow."""

LINEAR, ANGULAR = slice(0, 3), slice(3, 6)
"""Rows of a twist or wrench: velocity or force first, as in the paper."""


def mass_matrix(tree: Tree, joints: Sequence[str], positions: Mapping[str, Expression]) -> Expression:
    """Mass matrix M(q, pi); the root's pose does not enter.

    Args:
        tree: numbers or expressions.
        joints: names of the joints that move, in the order of the rows.
        positions: joint positions [rad or m] by name; joints left out stand at zero.
    Returns:
        Shape (6 + n, 6 + n).
    Source: Sartore et al. 2022, Eq. 5 (the composite-rigid-body algorithm of Featherstone 2014, ch. 6.2).
    """
    poses = forward(tree, _root_pose(), positions)
    composite = {
        link.name: _spatial_inertia(link.inertia, poses[link.name]) if has_mass(link.inertia) else ca.DM(6, 6)
        for link in tree.links
    }
    for joint in reversed(tree.joints):
        composite[joint.parent] = composite[joint.parent] + composite[joint.child]
    motions = {name: _unit_motion(tree.joint_by_name[name], poses) for name in joints}
    rows = {name: ROOT_ROWS + number for number, name in enumerate(joints)}
    size = ROOT_ROWS + len(joints)
    entries: list[list[Expression]] = [[0.0] * size for _ in range(size)]
    _put(entries, range(ROOT_ROWS), range(ROOT_ROWS), composite[tree.root])
    for name, row in rows.items():
        child = tree.joint_by_name[name].child
        force = composite[child] @ motions[name]
        _put(entries, range(ROOT_ROWS), [row], force)
        _put(entries, [row], range(ROOT_ROWS), force.T)
        for above in _moving_above(tree, child, rows):
            entries[row][rows[above]] = entries[rows[above]][row] = ca.dot(motions[above], force)
    return ca.vertcat(*[ca.horzcat(*row) for row in entries])


def bias(
    tree: Tree,
    joints: Sequence[str],
    positions: Mapping[str, Expression],
    velocity: Expression,
    gravity: Expression,
) -> Expression:
    """Coriolis, centrifugal and gravity terms h(q, nu, pi): the forces that keep nu constant.

    Args:
        tree: numbers or expressions.
        joints: names of the joints that move, in the order of the rows.
        positions: joint positions [rad or m] by name; joints left out stand at zero.
        velocity: nu, shape (6 + n,).
        gravity: gravitational acceleration in the root link's axes [m/s^2], shape (3,).
    Returns:
        Shape (6 + n,).
    Source: Sartore et al. 2022, Eq. 5.
    """
    still = ca.DM.zeros(ROOT_ROWS + len(joints))
    return inverse_dynamics(tree, joints, positions, velocity, still, gravity)


def inverse_dynamics(
    tree: Tree,
    joints: Sequence[str],
    positions: Mapping[str, Expression],
    velocity: Expression,
    acceleration: Expression,
    gravity: Expression,
) -> Expression:
    """Forces that make the tree accelerate: M(q, pi) dnu/dt + h(q, nu, pi).

    Args:
        tree: numbers or expressions.
        joints: names of the joints that move, in the order of the rows.
        positions: joint positions [rad or m] by name; joints left out stand at zero.
        velocity: nu, shape (6 + n,).
        acceleration: dnu/dt, shape (6 + n,).
        gravity: gravitational acceleration in the root link's axes [m/s^2], shape (3,).
    Returns:
        Shape (6 + n,).
    Source: Sartore et al. 2022, Eq. 4 for each link and Eq. 5 for the tree.
    """
    poses = forward(tree, _root_pose(), positions)
    rates = {name: velocity[ROOT_ROWS + number] for number, name in enumerate(joints)}
    changes = {name: acceleration[ROOT_ROWS + number] for number, name in enumerate(joints)}
    motions = link_motions(tree, poses, _root_motion(velocity, acceleration, gravity), rates, changes)
    forces, moments = {}, {}
    for link in tree.links:
        forces[link.name], moments[link.name] = needed_wrench(
            link.inertia, poses[link.name].rotation, motions[link.name]
        )
    held: dict[str, Expression] = {}
    for joint in reversed(tree.joints):
        force, moment = forces[joint.child], moments[joint.child]
        held[joint.name] = ca.dot(_axis(joint, poses), force if _slides(joint) else moment)
        lever = poses[joint.child].position - poses[joint.parent].position
        forces[joint.parent] += force
        moments[joint.parent] += moment + ca.cross(lever, force)
    return ca.vertcat(forces[tree.root], moments[tree.root], *[held[name] for name in joints])


@dataclass(frozen=True, slots=True)
class LinkMotion:
    """How a link moves, in the axes in which the tree's poses are given.

    Args:
        turning: angular velocity [rad/s].
        spin_up: angular acceleration [rad/s^2].
        acceleration: of the link's origin, in inverse dynamics less gravity (the paper's proper
            acceleration) [m/s^2].
    """

    turning: Expression
    spin_up: Expression
    acceleration: Expression

    def at(self, lever: Expression) -> Expression:
        """Acceleration of a point of the link, at a lever from its origin [m]."""
        swing = ca.cross(self.spin_up, lever) + ca.cross(self.turning, ca.cross(self.turning, lever))
        return self.acceleration + swing


def _root_motion(velocity: Expression, acceleration: Expression, gravity: Expression) -> LinkMotion:
    turning = velocity[ANGULAR]
    of_origin = acceleration[LINEAR] + ca.cross(turning, velocity[LINEAR])
    return LinkMotion(turning, acceleration[ANGULAR], of_origin - gravity)


def link_motions(
    tree: Tree,
    poses: Mapping[str, Pose],
    root: LinkMotion,
    rates: Mapping[str, Expression],
    changes: Mapping[str, Expression],
) -> dict[str, LinkMotion]:
    """Motions of all links, from the root outwards."""
    motions = {tree.root: root}
    for joint in tree.joints:
        rate, change = rates.get(joint.name, 0.0), changes.get(joint.name, 0.0)
        motions[joint.child] = _child_motion(motions[joint.parent], joint, poses, rate, change)
    return motions


def _child_motion(
    parent: LinkMotion, joint: Joint, poses: Mapping[str, Pose], rate: Expression, change: Expression
) -> LinkMotion:
    start = parent.at(poses[joint.child].position - poses[joint.parent].position)
    axis = _axis(joint, poses)
    if _slides(joint):
        sliding = axis * change + 2.0 * ca.cross(parent.turning, axis * rate)
        return LinkMotion(parent.turning, parent.spin_up, start + sliding)
    spin_up = parent.spin_up + axis * change + ca.cross(parent.turning, axis * rate)
    return LinkMotion(parent.turning + axis * rate, spin_up, start)


def needed_wrench(
    inertia: Inertia, root_from_link: Expression, motion: LinkMotion
) -> tuple[Expression, Expression]:
    """Force, and moment about the link's origin, that one link's motion takes (Newton and Euler)."""
    if not has_mass(inertia):
        return ca.DM.zeros(3), ca.DM.zeros(3)
    center = root_from_link @ vector(inertia.center)
    force = inertia.mass * motion.at(center)
    about_center, turning = _columns(inertia.about_center), root_from_link.T @ motion.turning
    own = about_center @ (root_from_link.T @ motion.spin_up) + ca.cross(turning, about_center @ turning)
    return force, root_from_link @ own + ca.cross(center, force)


def _spatial_inertia(inertia: Inertia, pose: Pose) -> Expression:
    """6 x 6 inertia about the root's origin in the root's axes (paper, Eq. 2)."""
    mass, cross = inertia.mass, ca.skew(pose.point(vector(inertia.center)))
    about_center = pose.rotation @ _columns(inertia.about_center) @ pose.rotation.T
    upper = ca.horzcat(mass * ca.DM.eye(3), -mass * cross)
    lower = ca.horzcat(mass * cross, about_center - mass * (cross @ cross))
    return ca.vertcat(upper, lower)


def _unit_motion(joint: Joint, poses: Mapping[str, Pose]) -> Expression:
    """Twist that a joint at unit speed gives to what it carries, taken at the root's origin."""
    axis = _axis(joint, poses)
    if _slides(joint):
        return ca.vertcat(axis, ca.DM.zeros(3))
    return ca.vertcat(ca.cross(poses[joint.child].position, axis), axis)


def _moving_above(tree: Tree, link: str, moving: Mapping[str, int]) -> list[str]:
    """Names of the moving joints between a link and the root, nearest first."""
    names = []
    while link != tree.root:
        joint = tree.parent_joint[link]
        if joint.name in moving:
            names.append(joint.name)
        link = joint.parent
    return names


def _put(
    entries: list[list[Expression]], rows: Sequence[int], columns: Sequence[int], block: Expression
) -> None:
    """Write a block into a matrix of scalars."""
    for i, row in enumerate(rows):
        for j, column in enumerate(columns):
            entries[row][column] = block[i, j]


def _root_pose() -> Pose:
    return Pose(ca.DM.eye(3), ca.DM.zeros(3))


def _axis(joint: Joint, poses: Mapping[str, Pose]) -> Expression:
    return poses[joint.child].rotation @ vector(joint.axis)


def _slides(joint: Joint) -> bool:
    return joint.kind is JointKind.PRISMATIC


def has_mass(inertia: Inertia) -> bool:
    """Whether a body has a mass, or may have one in a design."""
    return not (isinstance(inertia.mass, int | float) and inertia.mass == 0.0)


def _columns(matrix: Matrix) -> Expression:
    """A 3 x 3 matrix given by rows, as CasADi's."""
    return ca.vertcat(*[ca.horzcat(*row) for row in matrix])
