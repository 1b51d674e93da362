"""A tree whose links are longer or shorter, lighter or heavier.

A length multiplier l of a link with the principal dimension v adds e = (l - 1) v along the principal axis, in
the direction in which the chain grows from the link's parent joint. It is as if the link were cut across at
its main solid's centre and a piece of length e put in: end pieces keep their size, the middle gets longer.

    chain           from the parent joint to the centre of the link's volume; if there is none (or a cylinder
                    lies across it), from the parent joint to the middle of the child joints
    main solid      of several, the one that spans most along the chain: v |axis . chain|; the first of equals
    main solid      centre moves by e/2, dimension v becomes l v
    solid beside    one that reaches from end to end of the main solid, each end within v/20, along the same
    it              axis (two rods, four walls): as the main solid
    other solids    centre more than v/20 beyond the main one's: moves by e; more than v/20 before: stays;
                    between: moves by e/2; size kept
    child joint     at or beyond the main solid's centre: moves by e; before it by more than v/20: stays
    root link       z up is its chain, and it grows about its centre: child joints and other solids above move
                    by +e/2, below by -e/2, at it stay
    no chain        a link centred on its joints, or a cylinder across both directions: about its centre too

Mass and inertia are those of the resized solids, so a link has one density, also when made of several solids.
A link without solids, whose inertia is the file's, is stretched whole (`stretch`); its density can change if
it has shapes or watertight meshes, whose volume is known. l = 1 with the file's density gives the file's tree
back. A link that keeps its mass m has the density rho m / m', m' its mass at rho. Values may be symbolic.

Source: Sartore et al. 2022, Section III-A and IV; the rules for child joints and composites are ours
(docs/model.md).
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, replace

from evodesign.body.inertia import Inertia
from evodesign.body.placement import Placement, Scalar, Vector, add, dot, rotate, scale, transpose
from evodesign.body.shape import Solid, Sphere
from evodesign.errors import ModelError
from evodesign.tree.model import Joint, Link, Tree
from evodesign.tree.stretch import (
    UP,
    main_axis,
    scaled,
    stretched_inertia,
    stretched_look,
    stretched_mesh,
    stretched_point,
)

AT_CENTRE = 1e-6
"""A point within this distance of a centre counts as at the centre [m]."""

ACROSS = 0.01
"""Cosine between axis and chain below which a solid lies across the chain: 0.6 degrees off a right angle."""

MARGIN = 1.0 / 20.0
"""Of v. For stacked trunk boxes whose next joint stands a hair below the middle (2.4 mm of 134 mm in the
reference robot): a trunk that grows lifts what it carries."""


@dataclass(frozen=True, slots=True)
class Growth:
    """How a link answers to a length multiplier.

    Args:
        link: its name.
        axis: unit vector in the link's frame along which it grows, away from the parent joint.
        dimension: unscaled principal dimension v [m].
        centre: of the main solid, in the link's frame [m].
        stretched: indices of the solids that get longer: the main one and those beside it.
        about_centre: whether it grows to both sides (a root link, or one without a chain).
        whole: whether all its points move by the affine map of `stretch`, about its parent joint.
    """

    link: str
    axis: Vector
    dimension: float
    centre: Vector
    stretched: frozenset[int]
    about_centre: bool
    whole: bool = False

    @property
    def anchor(self) -> Vector:
        """The point that stays while what is only seen gets longer, in the link's frame [m]."""
        if self.whole or self.about_centre:
            return self.centre
        return add(self.centre, scale(-self.dimension / 2.0, self.axis))


def growth_of(tree: Tree, name: str) -> Growth:
    """The direction and dimension in which a link grows, read off its solids, or off its joints.

    Raises:
        ModelError: the link is missing, or has no mass or no direction to grow in.
    """
    link = _changeable(tree, name, "length")
    if not link.solids:
        found = main_axis(tree, link)
        if found is None:
            wanted = "a link with a joint or a centre of mass away from its parent joint"
            raise ModelError(tree.name, f"length of link {name}", wanted, "none")
        return Growth(name, *found, (0.0, 0.0, 0.0), frozenset(), about_centre=False, whole=True)
    is_root = name not in tree.parent_joint
    for chain in [UP] if is_root else _chains(tree, link):
        main = max(link.solids, key=lambda solid: _span(solid, chain))
        axis, dimension = _principal(main, chain)
        if abs(dot(axis, chain)) > ACROSS:
            return _growth(link, main, axis, dimension, about_centre=is_root)
    main = max(link.solids, key=lambda solid: _principal(solid, UP)[1])
    return _growth(link, main, *_principal(main, UP), about_centre=True)


def _changeable(tree: Tree, name: str, what: str) -> Link:
    """The link of a name, if a design can change it."""
    link = tree.link(name, f"{what} parameter")
    if link.mass == 0.0:
        found = "a shape that is only seen, without mass" if link.looks or link.meshes else "none"
        raise ModelError(tree.name, f"{what} of link {name}", "a link with mass", found)
    if what == "density" and not link.volume:
        wanted = (
            "a link in the shape of spheres, cylinders, boxes or watertight meshes, whose volume is known"
        )
        found = "a mesh without volume (not watertight)" if link.meshes else "no shape"
        raise ModelError(tree.name, f"{what} of link {name}", wanted, found)
    return link


def _chains(tree: Tree, link: Link) -> Iterator[Vector]:
    """Unit vectors from the parent joint to the volume's centre and to the mean child joint, if not there."""
    children = [joint.parent_from_child.translation for joint in tree.child_joints[link.name]]
    volumes = [solid.shape.volume for solid in link.solids]
    centres = [solid.link_from_solid.translation for solid in link.solids]
    for weights, points in ((volumes, centres), ([1.0] * len(children), children)):
        mean: Vector = (0.0, 0.0, 0.0)
        for weight, point in zip(weights, points, strict=True):
            mean = add(mean, scale(weight / sum(weights), point))
        distance = math.sqrt(dot(mean, mean))
        if distance > AT_CENTRE:
            yield scale(1.0 / distance, mean)


def _principal(solid: Solid, chain: Vector) -> tuple[Vector, float]:
    """Principal axis of a solid in the link's frame, along the chain, and its dimension [m]."""
    rotation = solid.link_from_solid.rotation
    axis = solid.shape.principal_axis(rotate(transpose(rotation), chain))
    return rotate(rotation, axis), solid.shape.principal_dimension(axis)


def _span(solid: Solid, chain: Vector) -> float:
    """How much a solid spans along the chain, v |axis . chain| [m].

    It is rounded to the nanometre, so that rounding errors do not choose among equals.
    """
    axis, dimension = _principal(solid, chain)
    return round(dimension * abs(float(dot(axis, chain))), 9)


def _growth(link: Link, main: Solid, axis: Vector, dimension: float, *, about_centre: bool) -> Growth:
    centre = main.link_from_solid.translation
    stretched = frozenset(
        number for number, solid in enumerate(link.solids) if _reaches_as_far(solid, main, axis, dimension)
    )
    return Growth(link.name, axis, dimension, centre, stretched, about_centre)


def _reaches_as_far(solid: Solid, main: Solid, axis: Vector, dimension: float) -> bool:
    """Whether a solid reaches from end to end of the main one, along the same axis."""
    own_axis, own_dimension = _principal(solid, axis)
    offset = abs(_beyond(solid.link_from_solid.translation, main.link_from_solid.translation, axis))
    return (
        isinstance(solid.shape, Sphere) == isinstance(main.shape, Sphere)
        and dot(own_axis, axis) > math.cos(ACROSS)
        and offset + abs(own_dimension - dimension) / 2.0 <= MARGIN * dimension
    )


def resize(
    tree: Tree,
    lengths: Mapping[str, Scalar],
    densities: Mapping[str, Scalar],
    growths: Mapping[str, Growth] | None = None,
    kept: Collection[str] = (),
) -> Tree:
    """The tree with some links lengthened and some of another density.

    Args:
        tree: unscaled, with numbers.
        lengths: length multiplier [-] by link name.
        densities: density [kg/m^3] by link name, for all solids of the link.
        growths: of the links that are lengthened, if they are known already.
        kept: links that keep their masses.
    Returns:
        A tree of the same form; links and joints that do not change are the same objects.
    Raises:
        ModelError: a named link is missing or cannot change.
    """
    if growths is None:
        growths = {name: growth_of(tree, name) for name in lengths}
    for name in densities:
        _changeable(tree, name, "density")
    links = tuple(_resized_link(link, growths, lengths, densities) for link in tree.links)
    links = tuple(
        _of_mass(link, old.mass) if link is not old and link.name in kept else link
        for link, old in zip(links, tree.links, strict=True)
    )
    joints = tuple(_moved_joint(joint, growths, lengths) for joint in tree.joints)
    return tree.reshaped(links, joints)


def _resized_link(
    link: Link, growths: Mapping[str, Growth], lengths: Mapping[str, Scalar], densities: Mapping[str, Scalar]
) -> Link:
    if link.name not in lengths and link.name not in densities:
        return link
    solids, inertia, looks, meshes = link.solids, link.own_inertia, link.looks, link.meshes
    if link.name in densities:
        if not solids:
            lighter = densities[link.name] * link.volume / inertia.mass
            inertia = Inertia(lighter * inertia.mass, inertia.center, scaled(lighter, inertia.about_center))
        density = densities[link.name]
        solids = tuple(replace(solid, density=density) for solid in solids)
    if link.name in lengths:
        growth, factor = growths[link.name], lengths[link.name]
        solids = tuple(
            _stretched(solid, growth, factor)
            if number in growth.stretched
            else _carried(solid, growth, factor)
            for number, solid in enumerate(solids)
        )
        if growth.whole:
            inertia = stretched_inertia(inertia, growth.axis, factor)
        looks = tuple(stretched_look(look, growth.axis, factor, growth.anchor) for look in looks)
        meshes = tuple(stretched_mesh(mesh, growth.axis, factor, growth.anchor) for mesh in meshes)
    return replace(link, solids=solids, own_inertia=inertia, looks=looks, meshes=meshes)


def _of_mass(link: Link, mass: Scalar) -> Link:
    """The link at densities that give it a mass [kg]."""
    share, own = mass / link.mass, link.own_inertia
    inertia = Inertia(share * own.mass, own.center, scaled(share, own.about_center))
    solids = tuple(replace(solid, density=share * solid.density) for solid in link.solids)
    return replace(link, solids=solids, own_inertia=inertia)


def _stretched(solid: Solid, growth: Growth, factor: Scalar) -> Solid:
    """The main solid, or one beside it: longer, and moved by half of what the link grows."""
    axis_in_solid = rotate(transpose(solid.link_from_solid.rotation), growth.axis)
    share = 0.0 if growth.about_centre else 0.5
    place = _moved(solid.link_from_solid, share, growth, factor)
    return replace(solid, shape=solid.shape.lengthened(factor, axis_in_solid), link_from_solid=place)


def _carried(solid: Solid, growth: Growth, factor: Scalar) -> Solid:
    """A solid that keeps its size."""
    beyond = _beyond(solid.link_from_solid.translation, growth.centre, growth.axis)
    at_centre = not growth.about_centre and abs(beyond) <= MARGIN * growth.dimension
    share = 0.5 if at_centre else _share(beyond, growth)
    return replace(solid, link_from_solid=_moved(solid.link_from_solid, share, growth, factor))


def _moved_joint(joint: Joint, growths: Mapping[str, Growth], lengths: Mapping[str, Scalar]) -> Joint:
    if joint.parent not in lengths:
        return joint
    growth = growths[joint.parent]
    if growth.whole:
        place = joint.parent_from_child
        moved = stretched_point(place.translation, growth.axis, lengths[joint.parent])
        return replace(joint, parent_from_child=Placement(place.rotation, moved))
    share = _share(_beyond(joint.parent_from_child.translation, growth.centre, growth.axis), growth)
    if share == 0.0:
        return joint
    place = _moved(joint.parent_from_child, share, growth, lengths[joint.parent])
    return replace(joint, parent_from_child=place)


def _moved(place: Placement, share: float, growth: Growth, factor: Scalar) -> Placement:
    """The placement, moved by a share of e = (l - 1) v along the growth axis."""
    if share == 0.0:
        return place
    extension = (factor - 1.0) * growth.dimension
    return Placement(place.rotation, add(place.translation, scale(share * extension, growth.axis)))


def _beyond(point: Vector, centre: Vector, axis: Vector) -> float:
    """Distance of a point past a centre, along an axis [m]."""
    return float(dot(add(point, scale(-1.0, centre)), axis))


def _share(beyond: float, growth: Growth) -> float:
    """The part of a link's extension by which a child joint or a solid that keeps its size moves.

    Args:
        beyond: its distance past the main solid's centre, along the growth axis [m].
        growth: of the link that holds it.
    """
    if growth.about_centre:
        return 0.0 if abs(beyond) <= AT_CENTRE else 0.5 if beyond > 0.0 else -0.5
    return 1.0 if beyond > -MARGIN * growth.dimension else 0.0
