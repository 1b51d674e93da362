"""The right side of a person, from the left: mirrored about the plane y = 0.

Both sides turn about the same axes +x, +y, +z: the mirror image of a turn by q about y is a turn by q, about
x and z one by -q, so limits [a, b] become [-b, -a].
"""

from __future__ import annotations

from evodesign.tree.model import Joint, JointKind, Link, Look

__all__ = ["LEFT", "mirrored_joint", "mirrored_link", "right_name"]

LEFT, RIGHT = "Left", "Right"
"""What names of the two sides hold."""


def mirrored_link(link: Link) -> Link:
    """The right side's link: a person's, with an inertia of its own and looks but no solids."""
    looks = tuple(Look(look.shape, look.link_from_look.mirrored()) for look in link.looks)
    return Link(right_name(link.name), own_inertia=link.own_inertia.mirrored(), looks=looks)


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
        joint.parent_from_child.mirrored(),
        axis=joint.axis,
        lower=lower,
        upper=upper,
    )


def right_name(name: str) -> str:
    """The right side's name; that of the middle is its own."""
    return name.replace(LEFT, RIGHT)
