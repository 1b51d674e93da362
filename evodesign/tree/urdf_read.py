"""A tree from URDF text.

`urdf_check` vets the XML first; yourdfpy then reads what was checked and nothing else (links, joints,
primitive shapes).

    shape of a link    its visuals; its collisions if there is no visual or a mesh among them; none if that is
                       so with the collisions too
    robot's link       with a shape and mass: solids of one density, mass / volume
                       with mass alone: the file's centre of mass and tensor, kept by every design
                       with a shape alone: only seen
    person's link      the file's centre of mass and tensor; its shape is only seen

So a mesh beside primitive shapes rules these out, because they are not the whole body. Mesh files are not
opened. A tensor is kept only if some body could have it: none of its principal moments is larger than the sum
of the others.

Source: wiki.ros.org/urdf/XML (link, joint); Traversaro et al. 2016, Section III (tensors that bodies have).
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from enum import StrEnum
from io import BytesIO
from typing import Any

import numpy as np
from lxml import etree

from evodesign.body.inertia import Inertia
from evodesign.body.placement import Placement, Vector
from evodesign.body.shape import Box, Cylinder, Shape, Solid, Sphere
from evodesign.errors import ModelError
from evodesign.tree.model import Joint, JointKind, Link, Look, Tree
from evodesign.tree.urdf_check import checked_urdf
from evodesign.tree.urdf_write import UNLIMITED

__all__ = ["MassRule", "read_urdf"]

LEAST_MASS = 1e-9
"""A link below a microgram [kg] has no mass: some files give their frames a tiny one."""

ROUNDED = 0.01
"""Share of the largest principal moment by which a file's figures may miss the triangle inequality."""


LONGEST_CHAIN = 200
"""Joints from the root to a link; what is computed along a chain recurs."""


class MassRule(StrEnum):
    """Where a link's centre of mass and inertia come from.

    SHAPES (robots): a link with primitive shapes and mass is made of solids of one density, mass / volume;
    the file's tensor gives way. FILE (persons): as the file says, and shapes are only seen.
    """

    SHAPES = "shapes"
    FILE = "file"


def read_urdf(text: str, source: str, masses: MassRule) -> Tree:
    """The tree that a URDF describes.

    Args:
        text: the URDF.
        source: the file's name, for messages.
        masses: whether inertia follows from the shapes (robots) or from the file (persons).
    Returns:
        A tree whose axes are of unit length, otherwise as given; limits that the file leaves out, or gives
        as the largest double, are infinite.
    Raises:
        ModelError: the text is not XML, not a URDF, or not a usable tree; says where and why.
    """
    robot = _loaded(checked_urdf(text, source), source)
    links = tuple(_link(link, masses) for link in robot.links)
    joints = tuple(_joint(joint) for joint in robot.joints)
    for link in links:
        _refuse_impossible(link, source)
    try:
        tree = Tree(robot.name, links, joints)
    except ModelError as error:
        raise ModelError(source, error.key, error.wanted, error.found) from error
    depth = {tree.root: 0}
    for joint in tree.joints:
        depth[joint.child] = depth[joint.parent] + 1
        if depth[joint.child] > LONGEST_CHAIN:
            key = f"joint {joint.name}"
            raise ModelError(source, key, f"chains of at most {LONGEST_CHAIN} joints", "a longer one")
    return tree


def _loaded(root: etree._Element, source: str) -> Any:
    """The Robot record that yourdfpy makes of the checked elements, without what a mesh rules out."""
    import yourdfpy  # here, because it loads trimesh: half a second that only a read of a robot should pay

    for role in ("visual", "collision"):
        for look in root.xpath(f"link[{role}/geometry/mesh]/{role}"):
            look.getparent().remove(look)
    file = BytesIO(etree.tostring(root))
    try:
        return yourdfpy.URDF.load(file, build_scene_graph=False, load_meshes=False).robot
    except (AttributeError, IndexError, KeyError, TypeError, ValueError) as error:
        # It has no error type of its own; the checks above should leave it nothing to stumble over.
        raise ModelError(
            source, "", "a URDF that yourdfpy reads", f"{type(error).__name__}: {error}"
        ) from error


def _link(link: Any, masses: MassRule) -> Link:
    shapes = _shapes(link.visuals) or _shapes(link.collisions)
    inertia = _inertia(link.inertial)
    if masses is MassRule.SHAPES and shapes and inertia.mass > 0.0:
        density = inertia.mass / sum(shape.volume for shape, _ in shapes)
        return Link(link.name, solids=tuple(Solid(shape, place, density) for shape, place in shapes))
    return Link(link.name, own_inertia=inertia, looks=tuple(Look(shape, place) for shape, place in shapes))


def _shapes(looks: Iterable[Any]) -> list[tuple[Shape, Placement]]:
    return [(_shape(look.geometry), _placement(look.origin)) for look in looks]


def _shape(geometry: Any) -> Shape:
    if geometry.sphere is not None:
        return Sphere(geometry.sphere.radius)
    if geometry.cylinder is not None:
        return Cylinder(geometry.cylinder.radius, geometry.cylinder.length)
    return Box(*(float(side) for side in geometry.box.size))


def _inertia(inertial: Any) -> Inertia:
    """Inertia in the link's frame; a link without mass has none."""
    if inertial is None or inertial.mass < LEAST_MASS:
        return Inertia()
    rows = [_vector(row) for row in inertial.inertia]
    here = Inertia(inertial.mass, about_center=(rows[0], rows[1], rows[2]))
    return here.moved(_placement(inertial.origin))


def _refuse_impossible(link: Link, source: str) -> None:
    """Refuse a kept tensor that no body has."""
    moments = [float(moment) for moment in np.linalg.eigvalsh(np.array(link.own_inertia.about_center))]
    if moments[0] + moments[1] < (1.0 - ROUNDED) * moments[2]:
        wanted = "principal moments of which none is larger than the sum of the others"
        found = ", ".join(f"{moment:.4g}" for moment in moments)
        raise ModelError(source, f"link {link.name}.inertial.inertia", wanted, found)


def _placement(matrix: Any) -> Placement:
    """Placement from a 4 x 4 matrix; the identity when an <origin> is left out."""
    if matrix is None:
        return Placement()
    rows = [_vector(row) for row in matrix[:3, :3]]
    return Placement((rows[0], rows[1], rows[2]), _vector(matrix[:3, 3]))


def _joint(joint: Any) -> Joint:
    kind = JointKind(joint.type)
    placement = _placement(joint.origin)
    if kind is JointKind.FIXED:
        return Joint(joint.name, kind, joint.parent, joint.child, placement)
    limit = joint.limit  # None for a continuous joint alone: the check asks the others for one
    ends = (-math.inf, math.inf) if kind is JointKind.CONTINUOUS else (limit.lower, limit.upper)
    effort, velocity = (None, None) if limit is None else (limit.effort, limit.velocity)
    length = math.hypot(*joint.axis)
    return Joint(
        name=joint.name,
        kind=kind,
        parent=joint.parent,
        child=joint.child,
        parent_from_child=placement,
        axis=_vector(joint.axis / length),
        lower=_limit(ends[0]),
        upper=_limit(ends[1]),
        effort=_limit(effort),
        velocity=_limit(velocity),
    )


def _limit(value: float | None) -> float:
    if value is None:
        return math.inf
    return math.copysign(math.inf, value) if abs(value) >= UNLIMITED else value


def _vector(numbers: Any) -> Vector:
    return (float(numbers[0]), float(numbers[1]), float(numbers[2]))
