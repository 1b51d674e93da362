"""The right side of a person, from the left: mirrored about the plane y = 0, M = diag(1, -1, 1).

    point M p        rotation M R M        inertia (about its centre) M I M

M on both sides keeps right-handed frames right-handed. Both sides turn about the same axes +x, +y, +z: the
mirror image of a turn by q about y is a turn by q, about x and z one by -q, so limits [a, b] become [-b, -a].
"""

from __future__ import annotations

from evodesign.body.inertia import Inertia
from evodesign.body.placement import Matrix, Placement, Vector
from evodesign.tree.model import Joint, JointKind, Link, Look

__all__ = ["LEFT", "mirrored_joint", "mirrored_link", "mirrored_point", "right_name"]

LEFT, RIGHT = "Left", "Right"
"""What names of the two sides hold."""


def mirrored_link(link: Link) -> Link:
    """The right side's link: a person's, with an inertia of its own and looks but no solids."""
    body = link.own_inertia
    inertia = Inertia(body.mass, mirrored_point(body.center), _mirrored_matrix(body.about_center))
    looks = tuple(Look(look.shape, _mirrored_placement(look.link_from_look)) for look in link.looks)
    return Link(right_name(link.name), own_inertia=inertia, looks=looks)


def mirrored_joint(joint: Joint) -> Joint:
    """The right side's joint: same axis, limits about x and z mirrored.

    A person's joint: fixed or revolute about one axis of its frame, without effort or velocity limits.
    """
    turns_alike = joint.axis[1] == 1.0 or joint.kind is JointKind.FIXED
    lower, upper = (joint.lower, joint.upper) if turns_alike else (-joint.upper, -joint.lower)
    return Joint(
        right_name(joint.name),
        joint.kind,
        right_name(joint.parent),
        right_name(joint.child),
        _mirrored_placement(joint.parent_from_child),
        axis=joint.axis,
        lower=lower,
        upper=upper,
    )


def right_name(name: str) -> str:
    """The right side's name; that of the middle is its own."""
    return name.replace(LEFT, RIGHT)


def mirrored_point(point: Vector) -> Vector:
    """The point on the other side; subtracted from zero, so that no negative zero reaches a file."""
    return (point[0], 0.0 - point[1], point[2])


def _mirrored_placement(placement: Placement) -> Placement:
    """The placement on the other side, of a frame that is itself mirrored."""
    return Placement(_mirrored_matrix(placement.rotation), mirrored_point(placement.translation))


def _mirrored_matrix(matrix: Matrix) -> Matrix:
    """M A M with M = diag(1, -1, 1)."""
    x, y, z = matrix
    return (mirrored_point(x), (0.0 - y[0], y[1], 0.0 - y[2]), mirrored_point(z))
