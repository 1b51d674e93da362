"""Inertial forces of a tree that moves: with them among the external forces, statics is dynamics.

A link of mass m and inertia I about its centre, which accelerates by a and turns by w, is in balance with
what acts on it and with the force -m a and the moment -(I dw/dt + w x I w) about its centre (d'Alembert). So
what cuts a tree that stands still (`balance.cut`) cuts a moving one.

Source: Featherstone 2014, ch. 5.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import casadi as ca

from evodesign.mechanics.balance import AppliedWrench
from evodesign.mechanics.dynamics import LinkMotion, has_mass, link_motions, needed_wrench
from evodesign.tree.kinematics import Expression, Pose, euler_rotation
from evodesign.tree.model import Tree


def inertial_wrenches(
    tree: Tree,
    poses: Mapping[str, Pose],
    root: LinkMotion,
    rates: Mapping[str, Expression],
    changes: Mapping[str, Expression],
) -> Iterator[AppliedWrench]:
    """What the links' inertia does to a tree that moves, as external forces beside the weights (d'Alembert).

    Args:
        tree: numbers or expressions.
        poses: of all links, in the world.
        root: how the root link moves, in the world.
        rates: speed of joints [rad/s] by name; the others stand still.
        changes: their acceleration [rad/s^2].
    """
    motions = link_motions(tree, poses, root, rates, changes)
    for link in tree.links:
        if has_mass(link.inertia):
            pose = poses[link.name]
            force, moment = needed_wrench(link.inertia, pose.rotation, motions[link.name])
            yield AppliedWrench(link.name, pose.position, -force, -moment)


def euler_motion(
    angles: Expression, rates: Expression, changes: Expression, acceleration: Expression
) -> LinkMotion:
    """How a link moves whose place is given by roll, pitch and yaw, in the world.

    With w_1, w_2, w_3 the turns by yaw, pitch and roll about the axes at which they happen, each of which
    the ones before carry along:

        w = w_1 + w_2 + w_3        dw/dt = their own changes + w_1 x w_2 + (w_1 + w_2) x w_3

    Args:
        angles: roll, pitch, yaw [rad].
        rates: their time derivatives [rad/s].
        changes: of the rates [rad/s^2].
        acceleration: of the link's origin [m/s^2].
    """
    zero = ca.DM.zeros(2)
    yaw = euler_rotation(ca.vertcat(zero, angles[2]))
    pitch = euler_rotation(ca.vertcat(0.0, angles[1:]))
    axes = (ca.DM([0.0, 0.0, 1.0]), yaw[:, 1], pitch[:, 0])
    first, second, third = (axis * rates[2 - place] for place, axis in enumerate(axes))
    own = sum(axis * changes[2 - place] for place, axis in enumerate(axes))
    carried = ca.cross(first, second) + ca.cross(first + second, third)
    return LinkMotion(first + second + third, own + carried, acceleration)
