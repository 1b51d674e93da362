"""Links of another section: thicker or thinner across the axis along which they would get longer.

    box        its sides across the axis, or the one that `across` names, times s
    cylinder   its radius times s, if it lies along the axis; one that lies across it keeps its size
    sphere     its radius times s
    others     a link without solids, and what is only seen: the affine map 1 + (s - 1) b b^T for each axis b
               across; its mass per volume stays, its centre of mass too

Joints stay where they are. A solid's place and density stay, so its mass follows its volume; a hollow one
keeps its wall. s = 1 gives the file's link back, the same object. Values may be symbolic.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace

from evodesign.body.inertia import Inertia
from evodesign.body.placement import Matrix, Scalar, Vector, dot, perpendicular, rotate, scale, transpose
from evodesign.body.shape import Box, Cylinder, Shape, Sphere
from evodesign.errors import ModelError
from evodesign.tree.model import Link, Tree
from evodesign.tree.resize import growth_of
from evodesign.tree.stretch import stretched_inertia, stretched_mesh

ALONG = math.cos(math.radians(15.0))
"""Least cosine of the angle between two axes that count as one."""


@dataclass(frozen=True, slots=True)
class SectionChange:
    """How one number changes a link's section.

    Args:
        link: its name.
        along: unit vector in the link's frame along which it does not change.
        across: those along which it does.
        anchor: a point on the axis, in the link's frame [m].
    """

    link: str
    along: Vector
    across: tuple[Vector, ...]
    anchor: Vector


def section_of(tree: Tree, name: str, across: Vector | None = None) -> SectionChange:
    """The section of a link: across the axis along which it would get longer.

    Args:
        tree: unscaled.
        name: of the link.
        across: the only axis along which it changes, of any length, in the link's frame; None for all.
    Raises:
        ModelError: a link without mass or form; an axis of no length, or along the link's own; one axis of a
            link that has cylinders or spheres.
    """
    growth = growth_of(tree, name)
    along, link = growth.axis, tree.link_by_name[name]
    if across is None:
        return SectionChange(name, along, perpendicular(along), growth.centre)
    size = math.sqrt(dot(across, across))
    if size == 0.0:
        raise ModelError(tree.name, f"section of {name}", "an axis of some length", "none")
    own = scale(1.0 / size, across)
    if abs(dot(own, along)) > math.sqrt(1.0 - ALONG**2):
        raise ModelError(tree.name, f"section of {name}", "an axis across the link's own", "one that is not")
    if any(not isinstance(solid.shape, Box) for solid in link.solids):
        raise ModelError(tree.name, f"section of {name}", "boxes, for one axis alone", "other shapes")
    return SectionChange(name, along, (own,), growth.centre)


def with_sections(tree: Tree, changes: Iterable[tuple[SectionChange, Scalar]]) -> Tree:
    """The tree with links of other sections.

    Args:
        tree: of a design, but for its sections.
        changes: each with its factor.
    """
    links = dict(tree.link_by_name)
    for change, factor in changes:
        if isinstance(factor, float | int) and factor == 1.0:
            continue
        links[change.link] = _widened(links[change.link], change, factor)
    return tree.reshaped(tuple(links[link.name] for link in tree.links), tree.joints)


def _widened(link: Link, change: SectionChange, factor: Scalar) -> Link:
    solids = tuple(
        replace(solid, shape=_wider(solid.shape, solid.link_from_solid.rotation, change, factor))
        for solid in link.solids
    )
    looks = tuple(
        replace(look, shape=_wider(look.shape, look.link_from_look.rotation, change, factor))
        for look in link.looks
    )
    inertia, meshes = link.own_inertia, link.meshes
    for axis in change.across:
        if not link.solids:
            wider = stretched_inertia(inertia, axis, factor)
            inertia = Inertia(wider.mass, inertia.center, wider.about_center)
        meshes = tuple(stretched_mesh(mesh, axis, factor, change.anchor) for mesh in meshes)
    return replace(link, solids=solids, looks=looks, own_inertia=inertia, meshes=meshes)


def _wider(shape: Shape, rotation: Matrix, change: SectionChange, factor: Scalar) -> Shape:
    """A shape that is turned so in the link."""
    back = transpose(rotation)
    if isinstance(shape, Sphere):
        return Sphere(shape.radius * factor)
    if isinstance(shape, Cylinder):
        lies_along = abs(float(dot(rotate(back, change.along), (0.0, 0.0, 1.0)))) > ALONG
        return Cylinder(shape.radius * factor, shape.length) if lies_along else shape
    sides = list(shape.sides)
    for place in _sides(back, change):
        sides[place] = sides[place] * factor
    return Box(*sides)


def _sides(back: Matrix, change: SectionChange) -> list[int]:
    """Which sides of a box change."""

    def nearest(axis: Vector) -> int:
        own = rotate(back, axis)
        return max(range(3), key=lambda place: abs(float(own[place])))

    kept = nearest(change.along)
    if len(change.across) == 1:
        return [place for place in (nearest(change.across[0]),) if place != kept]
    return [place for place in range(3) if place != kept]
