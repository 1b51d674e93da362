"""A link of any form, made longer: the affine map of its points along its main axis.

    points          x' = S x about the parent joint, S = 1 + (l - 1) a a^T, a the main axis
    mass            m' = l m (rho' / rho)
    centre of mass  c' = S c
    second moments  E' = l S E S^T (rho' / rho), E = tr(I)/2 1 - I about the centre of mass
    child joints    their places are points

For a box that begins at its parent joint, or a cylinder, this is Table I of the paper; for a mesh it needs no
more than the file's own inertia.

    main axis       from the parent joint to the joints beyond, each weighted with the mass that it carries;
                    to the centre of mass if none moves; z up in a link that no joint moves

Source: Sartore et al. 2022, Table I (of which this is the generalisation); Traversaro et al. 2016, Section
III (second moments).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

from evodesign.body.inertia import Inertia
from evodesign.body.placement import (
    Matrix,
    Placement,
    Scalar,
    Vector,
    add,
    dot,
    multiply,
    rotate,
    scale,
    transpose,
)
from evodesign.body.shape import Shape, Sphere
from evodesign.tree.model import Joint, JointKind, Link, Look, Mesh, Tree

UP: Vector = (0.0, 0.0, 1.0)
"""The direction in which a root link grows, whose frame is z up (REP 103)."""

SHORTEST = 1e-3
"""Distance [m] below which a joint or a centre of mass gives no direction."""

ALONG = 0.9
"""Cosine between the main axis and that of a shape that is only seen from which it gets longer, too."""


def main_axis(tree: Tree, link: Link) -> tuple[Vector, float] | None:
    """The unit vector along which a link gets longer, in its frame, and how long it is that way [m].

    Returns:
        None if neither the joints beyond nor the centre of mass are away from its parent joint.
    """
    upright = _upright(tree, link)
    if upright is not None:
        reached = [dot(upright, joint.parent_from_child.translation) for joint in _moving(tree, link)]
        return upright, max(map(abs, reached), default=0.0)
    carried = {joint: _mass_beyond(tree, joint) for joint in _moving(tree, link)}
    whole = sum(carried.values())
    beyond: Vector = (0.0, 0.0, 0.0)
    for joint, mass in carried.items():
        beyond = add(beyond, scale(mass / whole, joint.parent_from_child.translation))
    for end in (beyond, link.own_inertia.center):
        length = math.sqrt(dot(end, end))
        if length > SHORTEST:
            return scale(1.0 / length, end), length
    return None


def _upright(tree: Tree, link: Link) -> Vector | None:
    """The root's z axis in a link that no joint moves and no mass is above; None in others."""
    joints, up_in_link = [tree.parent_joint[name] for name in tree.to_root(link.name)[:-1]], UP
    for joint in reversed(joints):
        if joint.kind is not JointKind.FIXED or tree.link_by_name[joint.parent].inertia.mass > 0.0:
            return None
        up_in_link = rotate(transpose(joint.parent_from_child.rotation), up_in_link)
    return up_in_link


def _moving(tree: Tree, link: Link) -> Iterator[Joint]:
    """The joints of a link beyond which something with mass moves."""
    for joint in tree.child_joints[link.name]:
        if _mass_beyond(tree, joint) > 0.0 and _moves(tree, joint):
            yield joint


def _moves(tree: Tree, joint: Joint) -> bool:
    return joint.kind is not JointKind.FIXED or any(
        _moves(tree, below) for below in tree.child_joints[joint.child]
    )


def _mass_beyond(tree: Tree, joint: Joint) -> float:
    own = float(tree.link_by_name[joint.child].inertia.mass)
    return own + sum(_mass_beyond(tree, below) for below in tree.child_joints[joint.child])


def stretched_point(point: Vector, axis: Vector, factor: Scalar) -> Vector:
    """S x for a point [m] in the link's frame."""
    return add(point, scale((factor - 1.0) * dot(axis, point), axis))


def stretched_inertia(inertia: Inertia, axis: Vector, factor: Scalar) -> Inertia:
    """Inertia of the longer link, of the same density."""
    rows = inertia.about_center
    trace = rows[0][0] + rows[1][1] + rows[2][2]
    moments = _plus_diagonal(scaled(-1.0, rows), trace / 2.0)
    stretch = _stretch(axis, factor)
    longer = scaled(factor, multiply(multiply(stretch, moments), stretch))
    whole = longer[0][0] + longer[1][1] + longer[2][2]
    about_center = _plus_diagonal(scaled(-1.0, longer), whole)
    return Inertia(factor * inertia.mass, stretched_point(inertia.center, axis, factor), about_center)


def _stretch(axis: Vector, factor: Scalar) -> Matrix:
    """S = 1 + (l - 1) a a^T, which is symmetric."""
    outer = tuple(scale(axis[i], axis) for i in range(3))
    return _plus_diagonal(scaled(factor - 1.0, outer), 1.0)  # type: ignore[arg-type]


def scaled(factor: Scalar, matrix: Matrix) -> Matrix:
    """A 3 x 3 matrix times a factor."""
    return tuple(scale(factor, row) for row in matrix)  # type: ignore[return-value]


def _plus_diagonal(matrix: Matrix, value: Scalar) -> Matrix:
    return tuple(  # type: ignore[return-value]
        tuple(entry + value if i == j else entry for j, entry in enumerate(row))
        for i, row in enumerate(matrix)
    )


def stretched_mesh(mesh: Mesh, axis: Vector, factor: Scalar, anchor: Vector) -> Mesh:
    """A mesh whose points move by the affine map about an anchor in the link's frame [m]."""
    place = mesh.link_from_mesh
    moved = _about(place.translation, axis, factor, anchor)
    return replace(
        mesh,
        link_from_mesh=Placement(place.rotation, moved),
        stretch=multiply(_stretch(axis, factor), mesh.stretch),
    )


def stretched_look(look: Look, axis: Vector, factor: Scalar, anchor: Vector) -> Look:
    """A shape that is only seen: its centre moves, and it gets longer if it stands along the axis."""
    place = look.link_from_look
    moved = Placement(place.rotation, _about(place.translation, axis, factor, anchor))
    in_shape = rotate(transpose(place.rotation), axis)
    shape: Shape = look.shape
    own = shape.principal_axis(in_shape)
    if not isinstance(shape, Sphere) and dot(own, in_shape) > ALONG:
        shape = shape.lengthened(factor, own)
    return Look(shape, moved)


def _about(point: Vector, axis: Vector, factor: Scalar, anchor: Vector) -> Vector:
    offset = add(point, scale(-1.0, anchor))
    return add(anchor, stretched_point(offset, axis, factor))
