"""Hollow links as beams: which solid of a link is one, along which axis, of which section and material.

A link with walls whose main solid is a cylinder or a box along the link is a beam from end to end of it;
others, and what lies beside the main solid, are rigid.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from evodesign.body.material import CATALOGUE
from evodesign.body.placement import Placement, Scalar, Vector, add, rotate, scale, transpose
from evodesign.body.shape import Box, Cylinder, Solid
from evodesign.hardware.structure import STRENGTHS, MaterialStrength, RectangularTube, RoundTube, Section
from evodesign.tree.model import Link, Tree

Array = NDArray[np.float64]

ALONG = 0.7
"""Cosine between a solid's axis and the direction of its link from which on the solid is a beam."""

MIDDLE = 1e-9
"""How far above a beam's middle [m] a joint counts as above it: hips may sit at the pelvis's middle."""

STRONG = {round(CATALOGUE[name].density, 6): strength for name, strength in STRENGTHS.items()}
"""Stiffness and strength by density [kg/m^3]."""


@dataclass(frozen=True, slots=True)
class Beam:
    """A link as a beam, in the axes in which its tree stands.

    Args:
        link: its name.
        ends: of the main solid [m]; the second is on the far side.
        axes: along it, and the section's first and second axis; unit vectors.
        section: all along it.
        material: of its wall.
        beyond: the links that it carries.
    """

    link: str
    ends: tuple[Array, Array]
    axes: tuple[Array, Array, Array]
    section: Section
    material: MaterialStrength
    beyond: tuple[str, ...]

    @property
    def length(self) -> float:
        """From end to end [m]."""
        return float(np.linalg.norm(self.ends[1] - self.ends[0]))


@dataclass(frozen=True, slots=True)
class BeamPlan:
    """Which part of a link is a beam, and what follows it.

    Args:
        link: its name.
        solid: number of its main solid.
        axis: of that solid, along which the beam goes: 1 to 3, negative for backwards.
        material: of its wall.
        beyond: the links that it carries.
    """

    link: str
    solid: int
    axis: int
    material: MaterialStrength
    beyond: tuple[str, ...]


def beam_plans(tree: Tree) -> Iterator[BeamPlan]:
    """The links of a tree of numbers that are beams."""
    for link in tree.links:
        hollow = [number for number, solid in enumerate(link.solids) if solid.wall is not None]
        material = STRONG.get(round(float(link.solids[hollow[0]].density), 6)) if hollow else None
        if not hollow or material is None:
            continue
        main = max(hollow, key=lambda number: float(link.solids[number].shape.volume))
        axis = _axis(link.solids[main], _direction(tree, link.name))
        if axis:
            beyond = _beyond(tree, link, main, axis)
            yield BeamPlan(link.name, main, axis, material, beyond)


def _beyond(tree: Tree, link: Link, main: int, axis: int) -> tuple[str, ...]:
    """The child links of a beam, of the root those above its middle."""
    joints = tree.child_joints[link.name]
    if link.name == tree.root:
        place = link.solids[main].link_from_solid
        up = np.sign(axis) * np.array(place.rotation, float)[:, abs(axis) - 1]
        middle = np.array(place.translation, float)
        places = [np.array(joint.parent_from_child.translation, float) for joint in joints]
        return tuple(j.child for j, p in zip(joints, places, strict=True) if (p - middle) @ up > MIDDLE)
    return tuple(joint.child for joint in joints)


def beam_along(
    link: Link, plan: BeamPlan
) -> tuple[tuple[Vector, Vector], tuple[Vector, Vector, Vector], Section, Scalar]:
    """A beam in its link's frame: its ends [m], unit vectors along and across it, section and length.

    Args:
        link: of numbers or expressions.
        plan: of the link.
    """
    solid, place = link.solids[plan.solid], abs(plan.axis) - 1
    columns = transpose(solid.link_from_solid.rotation)
    others = [number for number in range(3) if number != place]
    along = scale(math.copysign(1.0, plan.axis), columns[place])
    section, length = _section(solid, place)
    middle = solid.link_from_solid.translation
    ends = add(middle, scale(-0.5 * length, along)), add(middle, scale(0.5 * length, along))
    return ends, (along, columns[others[0]], columns[others[1]]), section, length


def beams_of(tree: Tree, places: Mapping[str, Placement]) -> list[Beam]:
    """The links of a tree of numbers that are beams, where they are."""
    found = []
    for plan in beam_plans(tree):
        ends, axes, section, _ = beam_along(tree.link_by_name[plan.link], plan)
        place = places[plan.link]
        first, second = (np.array(place.apply(end), float) for end in ends)
        turned = [np.array(rotate(place.rotation, axis), float) for axis in axes]
        along = turned[0], turned[1], turned[2]
        found.append(Beam(plan.link, (first, second), along, section, plan.material, plan.beyond))
    return found


def _direction(tree: Tree, name: str) -> Array:
    """From a link's parent joint to the middle of its child joints; upwards in the root."""
    if name == tree.root:
        return np.array([0.0, 0.0, 1.0])
    children = [joint.parent_from_child.translation for joint in tree.child_joints[name]]
    middle = np.mean(np.array(children, float), axis=0) if children else np.zeros(3)
    size = float(np.linalg.norm(middle))
    return middle / size if size > 1e-6 else middle


def _axis(solid: Solid, direction: Array) -> int:
    """Which of its axes a solid's beam is along (1 to 3, negative for backwards); 0 for none."""
    in_solid = np.array(solid.link_from_solid.rotation, float).T @ direction
    place = 2 if isinstance(solid.shape, Cylinder) else int(np.argmax(np.abs(in_solid)))
    if abs(in_solid[place]) < ALONG or not isinstance(solid.shape, Cylinder | Box):
        return 0
    return int(np.copysign(place + 1, in_solid[place]))


def _section(solid: Solid, place: int) -> tuple[Section, Scalar]:
    """The section of a tube along one of its axes, and its length [m]."""
    shape = solid.shape
    if isinstance(shape, Cylinder):
        return RoundTube(shape.radius, solid.wall), shape.length
    if not isinstance(shape, Box):
        raise TypeError(f"{shape} is no tube")
    width, height = (side for number, side in enumerate(shape.sides) if number != place)
    return RectangularTube(width, height, solid.wall), shape.sides[place]
