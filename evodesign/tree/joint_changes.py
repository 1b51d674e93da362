"""Joints that a design moves, tilts, or gives other limits.

    offset   the joint's origin moves along an axis of its parent link, and all that hangs on it goes with it.
             A box or cylinder of the parent that ends at the joint and points along the axis gets as much
             longer at that end; with its density its mass follows
    tilt     the joint's axis turns about another axis of the joint's own frame; with the joint at zero
             everything stays where it is
    limits   the lower or the upper limit is what the design says

A pair of mirrored joints changes as one. In the frame of the root, all joints at zero, M = diag(1, -1, 1):

    offset axis of the image  M a        tilt axis of the image  -M w (a pseudovector)

Values may be symbolic. No offset, no tilt and the file's limits give the file's tree back, the same objects.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from enum import StrEnum

import casadi as ca

from evodesign.body.placement import (
    Matrix,
    Placement,
    Scalar,
    Vector,
    add,
    dot,
    mirrored_point,
    rotate,
    scale,
    transpose,
)
from evodesign.body.shape import Sphere
from evodesign.errors import ModelError
from evodesign.tree.frames import link_frames
from evodesign.tree.model import Joint, JointKind, Link, Tree

ALONG = math.cos(math.radians(15.0))
"""Least cosine between the axis of an offset and that of a solid that gets longer with it."""

AT_END = 0.25
"""Share of its length by which a joint is beyond a solid's centre that ends at it."""


class JointQuantity(StrEnum):
    """What of a joint changes."""

    OFFSET = "offset"
    TILT = "tilt"
    LOWER = "lower"
    UPPER = "upper"


@dataclass(frozen=True, slots=True)
class JointChange:
    """How a design's number changes one joint.

    Args:
        joint: its name.
        quantity: what of it.
        axis: unit vector: of an offset in the parent's frame, of a tilt in the joint's own; none for a limit.
        sign: of a limit: that of the number in it.
        solids: of the parent, that get longer with an offset: their places, and 1 if the joint is at the end
            to which the axis points, or -1.
    """

    joint: str
    quantity: JointQuantity
    axis: Vector = (0.0, 0.0, 0.0)
    sign: float = 1.0
    solids: tuple[tuple[int, float], ...] = ()


def pair_of_changes(
    tree: Tree, joints: tuple[str, ...], quantity: JointQuantity, axis: Vector = (0.0, 0.0, 0.0)
) -> tuple[JointChange, ...]:
    """The changes of a joint, and of its mirror image, by one number.

    Args:
        tree: unscaled.
        joints: one, or two that are each other's mirror images.
        quantity: what of them.
        axis: of the first one, of any length; none for limits.
    Raises:
        ModelError: an axis of no length, or a tilt about the joint's own axis.
    """
    first, *others = joints
    if quantity in (JointQuantity.LOWER, JointQuantity.UPPER):
        return (JointChange(first, quantity), *(_other_limit(tree, first, each, quantity) for each in others))
    size = math.sqrt(dot(axis, axis))
    if size == 0.0:
        raise ModelError(tree.name, f"{quantity} of {first}", "an axis of some length", "none")
    own = scale(1.0 / size, axis)
    if quantity is JointQuantity.TILT and abs(dot(own, tree.joint_by_name[first].axis)) > ALONG:
        wanted = "an axis across that of the joint, which turns about it"
        raise ModelError(tree.name, f"tilt of {first}", wanted, "one along it")
    frames = link_frames(tree, Placement(), {})

    def turn(name: str) -> Matrix:
        joint = tree.joint_by_name[name]
        return frames[joint.parent if quantity is JointQuantity.OFFSET else joint.child].rotation

    axes = {first: own}
    for other in others:
        image = mirrored_point(rotate(turn(first), own))
        if quantity is JointQuantity.TILT:
            image = scale(-1.0, image)
        axes[other] = rotate(transpose(turn(other)), image)
    if quantity is JointQuantity.TILT:
        return tuple(JointChange(name, quantity, each) for name, each in axes.items())
    longer: set[tuple[str, int, float]] = set()  # what ends at both joints at one end gets longer once
    changes = []
    for name, axis in axes.items():
        joint, way = tree.joint_by_name[name], math.copysign(1.0, dot(axis, own))
        ending = _solids_ending_at(tree, joint, axis)
        solids = tuple(each for each in ending if (joint.parent, each[0], way * each[1]) not in longer)
        longer |= {(joint.parent, number, way * away) for number, away in solids}
        changes.append(JointChange(name, quantity, axis, solids=solids))
    return tuple(changes)


def _other_limit(tree: Tree, first: str, other: str, quantity: JointQuantity) -> JointChange:
    """The limit of a mirror image: the same, or the other one with its sign turned."""
    frames = link_frames(tree, Placement(), {})
    one, image = tree.joint_by_name[first], tree.joint_by_name[other]
    mirrored = mirrored_point(rotate(frames[one.child].rotation, one.axis))
    if one.kind is not JointKind.PRISMATIC:
        mirrored = scale(-1.0, mirrored)
    if dot(mirrored, rotate(frames[image.child].rotation, image.axis)) > 0.0:
        return JointChange(other, quantity)
    turned = JointQuantity.UPPER if quantity is JointQuantity.LOWER else JointQuantity.LOWER
    return JointChange(other, turned, sign=-1.0)


def unchanged_value(tree: Tree, change: JointChange) -> float:
    """The number that leaves a joint as its file has it."""
    joint = tree.joint_by_name[change.joint]
    if change.quantity is JointQuantity.LOWER:
        return change.sign * joint.lower
    if change.quantity is JointQuantity.UPPER:
        return change.sign * joint.upper
    return 0.0


def with_changes(tree: Tree, changes: Iterable[tuple[JointChange, Scalar]]) -> Tree:
    """The tree with some joints changed.

    Args:
        tree: of a design, but for its joints.
        changes: with the numbers or expressions that they are made by.
    """
    joints: dict[str, Joint] = dict(tree.joint_by_name)
    links: dict[str, Link] = dict(tree.link_by_name)
    for change, value in changes:
        joint = joints[change.joint]
        if change.quantity is JointQuantity.OFFSET:
            if isinstance(value, float | int) and value == 0.0:
                continue
            if change.solids:
                links[joint.parent] = _following(links[joint.parent], change, value)
            place = joint.parent_from_child
            moved = add(place.translation, scale(value, change.axis))
            joints[joint.name] = replace(joint, parent_from_child=Placement(place.rotation, moved))
        elif change.quantity is JointQuantity.TILT:
            if not (isinstance(value, float | int) and value == 0.0):
                joints[joint.name] = replace(joint, axis=_turned(joint.axis, change.axis, value))
        else:
            limit = change.sign * value
            joints[joint.name] = replace(joint, **{change.quantity.value: limit})
    return tree.reshaped(
        tuple(links[link.name] for link in tree.links), tuple(joints[joint.name] for joint in tree.joints)
    )


def _turned(vector: Vector, axis: Vector, angle: Scalar) -> Vector:
    """A vector turned about a unit vector by an angle [rad], by Rodrigues' formula."""
    library = math if isinstance(angle, float | int) else ca
    cos, sin = library.cos(angle), library.sin(angle)
    across = (
        axis[1] * vector[2] - axis[2] * vector[1],
        axis[2] * vector[0] - axis[0] * vector[2],
        axis[0] * vector[1] - axis[1] * vector[0],
    )
    along = dot(axis, vector)
    return add(add(scale(cos, vector), scale(sin, across)), scale((1.0 - cos) * along, axis))


def _following(link: Link, change: JointChange, offset: Scalar) -> Link:
    """The link with the solids longer that end at a joint which moves away along an axis."""
    solids = list(link.solids)
    for number, away in change.solids:
        solid = solids[number]
        place, across = solid.link_from_solid, rotate(transpose(solid.link_from_solid.rotation), change.axis)
        own = solid.shape.principal_axis(across)
        factor = 1.0 + away * offset / solid.shape.principal_dimension(own)
        moved = add(place.translation, scale(offset / 2.0, change.axis))
        shape = solid.shape.lengthened(factor, own)
        solids[number] = replace(solid, shape=shape, link_from_solid=Placement(place.rotation, moved))
    return replace(link, solids=tuple(solids))


def _solids_ending_at(tree: Tree, joint: Joint, axis: Vector) -> tuple[tuple[int, float], ...]:
    """The parent's solids along an axis that end at a joint, with 1 for those that point to it, or -1."""
    found = []
    for number, solid in enumerate(tree.link_by_name[joint.parent].solids):
        if isinstance(solid.shape, Sphere):
            continue
        place = solid.link_from_solid
        own = solid.shape.principal_axis(rotate(transpose(place.rotation), axis))
        pointing = float(dot(rotate(place.rotation, own), axis))
        away = float(dot(add(joint.parent_from_child.translation, scale(-1.0, place.translation)), axis))
        if abs(pointing) > ALONG and abs(away) >= AT_END * float(solid.shape.principal_dimension(own)):
            found.append((number, math.copysign(1.0, away)))
    return tuple(found)


def widest_ranges(
    tree: Tree, bounds: Iterable[tuple[JointChange, float, float]]
) -> Mapping[str, tuple[float, float]]:
    """The widest limits of each joint that some design gives it [rad or m], by name.

    Args:
        tree: unscaled.
        bounds: each change of a limit with the bounds of its number.
    """
    found: dict[str, tuple[float, float]] = {}
    for change, low, high in bounds:
        joint = tree.joint_by_name[change.joint]
        lower, upper = found.get(joint.name, (joint.lower, joint.upper))
        ends = sorted((change.sign * low, change.sign * high))
        if change.quantity is JointQuantity.LOWER:
            lower = ends[0]
        if change.quantity is JointQuantity.UPPER:
            upper = ends[1]
        found[joint.name] = lower, upper
    return found
