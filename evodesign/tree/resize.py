"""A tree whose links are longer or shorter, lighter or heavier.

A length multiplier l of a link whose solid has the principal dimension v adds e = (l - 1) v along the
principal axis, in the direction in which the chain grows from the link's parent joint:

    solid           centre moves by e/2, dimension v becomes l v
    child joint     at or beyond the solid's centre: moves by e (the end pieces keep their size);
                    before it by more than v/20: stays
    root link       grows about its centre: children above move by +e/2, below by -e/2, at it stay

Mass and inertia are those of the resized solid. l = 1 with the file's density gives the file's tree back.
Multipliers and densities are numbers or symbolic expressions.

Source: Sartore et al. 2022, Section III-A and IV; the rule for child joints is ours (docs/model.md).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from evodesign.body.placement import Placement, Scalar, Vector, add, dot, rotate, scale, transpose
from evodesign.body.shape import Solid
from evodesign.errors import ModelError
from evodesign.tree.model import Joint, Link, Tree

__all__ = ["Growth", "growth_of", "resize"]

AT_CENTRE = 1e-6
"""A child joint within this distance of a root solid's centre counts as at the centre [m]."""

UP: Vector = (0.0, 0.0, 1.0)
"""The chain's direction in a root link, whose frame is z up (REP 103)."""


@dataclass(frozen=True, slots=True)
class Growth:
    """How a link answers to a length multiplier.

    Args:
        link: its name.
        axis: unit vector in the link's frame along which it grows, away from the parent joint.
        dimension: unscaled principal dimension v [m].
        about_centre: whether it grows to both sides (a root link).
    """

    link: str
    axis: Vector
    dimension: Scalar
    about_centre: bool


def growth_of(tree: Tree, name: str) -> Growth:
    """The direction and dimension in which a link grows, read off its solid's placement.

    Raises:
        ModelError: the link is missing, has no solid, or several.
    """
    link = tree.link(name, "length parameter")
    if len(link.solids) != 1:
        found = f"{len(link.solids)} shapes in link '{name}'"
        raise ModelError(tree.name, f"length of link {name}", "a link with one primitive shape", found)
    solid = link.solids[0]
    is_root = name not in tree.parent_joint
    chain = UP if is_root else _chain_direction(tree, link, solid)
    rotation = solid.link_from_solid.rotation
    axis_in_solid = solid.shape.principal_axis(rotate(transpose(rotation), chain))
    dimension = solid.shape.principal_dimension(axis_in_solid)
    return Growth(name, rotate(rotation, axis_in_solid), dimension, is_root)


def _chain_direction(tree: Tree, link: Link, solid: Solid) -> Vector:
    """From the parent joint to the solid's centre, or to the mean child joint when they coincide."""
    children = [joint.parent_from_child.translation for joint in tree.child_joints[link.name]]
    mean = (0.0, 0.0, 0.0)
    for child in children:
        mean = add(mean, scale(1.0 / len(children), child))
    for direction in (solid.link_from_solid.translation, mean, UP):
        if dot(direction, direction) > AT_CENTRE**2:
            return direction
    return UP


def resize(tree: Tree, lengths: Mapping[str, Scalar], densities: Mapping[str, Scalar]) -> Tree:
    """The tree with some links lengthened and some of another density.

    Args:
        tree: unscaled, with numbers.
        lengths: length multiplier [-] by link name.
        densities: density [kg/m^3] by link name, for all solids of the link.
    Returns:
        A tree of the same form; links and joints that do not change are the same objects.
    Raises:
        ModelError: a named link is missing or cannot change.
    """
    growths = {name: growth_of(tree, name) for name in lengths}
    for name in densities:
        if not tree.link(name, "density parameter").solids:
            raise ModelError(tree.name, f"density of link {name}", "a link with a primitive shape", "none")
    links = tuple(_resized_link(link, growths, lengths, densities) for link in tree.links)
    joints = tuple(_moved_joint(joint, tree, growths, lengths) for joint in tree.joints)
    return replace(tree, links=links, joints=joints)


def _resized_link(
    link: Link, growths: Mapping[str, Growth], lengths: Mapping[str, Scalar], densities: Mapping[str, Scalar]
) -> Link:
    if link.name not in lengths and link.name not in densities:
        return link
    solids = link.solids
    if link.name in densities:
        solids = tuple(replace(solid, density=densities[link.name]) for solid in solids)
    if link.name in lengths:
        solids = (_lengthened(solids[0], growths[link.name], lengths[link.name]),)
    return replace(link, solids=solids)


def _lengthened(solid: Solid, growth: Growth, factor: Scalar) -> Solid:
    placement = solid.link_from_solid
    axis_in_solid = rotate(transpose(placement.rotation), growth.axis)
    shape = solid.shape.lengthened(factor, axis_in_solid)
    if not growth.about_centre:
        half = (factor - 1.0) * growth.dimension / 2.0
        moved = add(placement.translation, scale(half, growth.axis))
        placement = Placement(placement.rotation, moved)
    return Solid(shape, placement, solid.density)


def _moved_joint(
    joint: Joint, tree: Tree, growths: Mapping[str, Growth], lengths: Mapping[str, Scalar]
) -> Joint:
    if joint.parent not in lengths:
        return joint
    growth = growths[joint.parent]
    centre = tree.link_by_name[joint.parent].solids[0].link_from_solid.translation
    origin = joint.parent_from_child.translation
    beyond = dot(add(origin, scale(-1.0, centre)), growth.axis)
    share = _share(beyond, growth)
    if share == 0.0:
        return joint
    extension = (lengths[joint.parent] - 1.0) * growth.dimension
    moved = add(origin, scale(share * extension, growth.axis))
    return replace(joint, parent_from_child=Placement(joint.parent_from_child.rotation, moved))


def _share(beyond: float, growth: Growth) -> float:
    """The part of a link's extension by which a child joint moves.

    The margin of v/20 is for stacked trunk boxes whose next joint stands a hair below the middle (2.4 mm
    of 134 mm in the reference robot): a trunk that grows lifts what it carries.

    Args:
        beyond: distance of the joint past the solid's centre, along the growth axis [m].
        growth: of the link that holds the joint.
    """
    if growth.about_centre:
        return 0.0 if abs(beyond) <= AT_CENTRE else 0.5 if beyond > 0.0 else -0.5
    return 1.0 if beyond > -growth.dimension / 20.0 else 0.0
