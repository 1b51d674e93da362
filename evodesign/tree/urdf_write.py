"""A tree as URDF text: what a viewer, a simulator or another library can open.

    link    <inertial> at the centre of mass, in the link's axes, when there is mass
            <visual> and <collision> for each solid, <visual> alone for a look; <visual> for each mesh with a
            file, and then none for shapes
    joint   <origin>, <parent>, <child>; <axis> and <limit> when it moves

The text is a function of the tree: names in its order, numbers as the shortest text that reads back to the
same double. `read_urdf` gives the tree back as long as URDF can tell: solids of one link share a density, and
a link with an inertia of its own beside looks is a person's (`InertiaRule.FILE`).

Source: wiki.ros.org/urdf/XML (link, joint).
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterable

from lxml import etree

from evodesign.body.inertia import Inertia
from evodesign.body.placement import Placement, Scalar, rpy_from_matrix
from evodesign.body.shape import Box, Cylinder, Shape, Sphere
from evodesign.tree.mesh_write import NO_MESHES, MeshNames, named_meshes
from evodesign.tree.model import Joint, JointKind, Link, Tree

UNLIMITED = sys.float_info.max
"""An infinite limit as URDF text. Effort and velocity must be given, and urdfdom (pinocchio's parser) refuses
`inf`; the largest double passes urdfdom, MuJoCo and yourdfpy, and is no joint's limit."""


def urdf_text(tree: Tree, meshes: MeshNames = NO_MESHES) -> str:
    """The tree as indented XML.

    Args:
        tree: of numbers.
        meshes: files of the meshes that are to be seen.
    Raises:
        TypeError: the tree holds an expression where URDF needs a number.
        ValueError: it holds a number that is not finite (beside a limit).
    """
    robot = etree.Element("robot", name=tree.name)
    for link in tree.links:
        _add_link(robot, link, meshes)
    for joint in tree.joints:
        add_joint(robot, joint)
    return robot_text(robot)


def robot_text(robot: etree._Element) -> str:
    """A <robot> as indented XML."""
    text: bytes = etree.tostring(robot, pretty_print=True, xml_declaration=True, encoding="utf-8")
    return text.decode("utf-8")


def _add_link(robot: etree._Element, link: Link, meshes: MeshNames) -> None:
    element = etree.SubElement(robot, "link", name=link.name)
    add_inertial(element, link.inertia)
    files = named_meshes(link, meshes)
    for mesh, file in files:
        add_mesh(element, "visual", file, mesh.link_from_mesh)
    if not files:
        for solid in link.solids:
            add_shape(element, "visual", solid.shape, solid.link_from_solid)
        for look in link.looks:
            add_shape(element, "visual", look.shape, look.link_from_look)
    for solid in link.solids:
        add_shape(element, "collision", solid.shape, solid.link_from_solid)


def add_inertial(link: etree._Element, inertia: Inertia) -> None:
    """What a <link> weighs, unless it has no mass."""
    mass = numbers_text([inertia.mass])
    if float(mass) == 0.0:
        return
    element = etree.SubElement(link, "inertial")
    _add_origin(element, Placement(translation=inertia.center))
    etree.SubElement(element, "mass", value=mass)
    upper = {f"i{'xyz'[i]}{'xyz'[j]}": inertia.about_center[i][j] for i in range(3) for j in range(i, 3)}
    etree.SubElement(element, "inertia", {name: numbers_text([moment]) for name, moment in upper.items()})


def add_mesh(link: etree._Element, role: str, file: str, link_from_mesh: Placement) -> None:
    """A mesh file as <visual> or <collision> of a <link>."""
    element = etree.SubElement(link, role)
    _add_origin(element, link_from_mesh)
    etree.SubElement(etree.SubElement(element, "geometry"), "mesh", filename=file)


def add_shape(link: etree._Element, role: str, shape: Shape, link_from_shape: Placement) -> None:
    """A shape as <visual> or <collision> of a <link>."""
    element = etree.SubElement(link, role)
    _add_origin(element, link_from_shape)
    geometry = etree.SubElement(element, "geometry")
    match shape:
        case Sphere(radius):
            etree.SubElement(geometry, "sphere", radius=numbers_text([radius]))
        case Cylinder(radius, length):
            etree.SubElement(
                geometry, "cylinder", radius=numbers_text([radius]), length=numbers_text([length])
            )
        case Box():
            etree.SubElement(geometry, "box", size=numbers_text(shape.sides))


def add_joint(robot: etree._Element, joint: Joint) -> etree._Element:
    """A joint of a <robot>, which is given back."""
    element = etree.SubElement(robot, "joint", name=joint.name, type=joint.kind.value)
    _add_origin(element, joint.parent_from_child)
    etree.SubElement(element, "parent", link=joint.parent)
    etree.SubElement(element, "child", link=joint.child)
    if joint.kind is JointKind.FIXED:
        return element
    etree.SubElement(element, "axis", xyz=numbers_text(joint.axis))
    limits = {"effort": joint.effort, "velocity": joint.velocity}
    if joint.kind is not JointKind.CONTINUOUS:
        limits = {"lower": joint.lower, "upper": joint.upper} | limits
    finite = {
        key: math.copysign(UNLIMITED, each) if math.isinf(each) else each for key, each in limits.items()
    }
    etree.SubElement(element, "limit", {key: numbers_text([each]) for key, each in finite.items()})
    return element


def _add_origin(element: etree._Element, placement: Placement) -> None:
    rpy = rpy_from_matrix(placement.rotation)
    etree.SubElement(element, "origin", xyz=numbers_text(placement.translation), rpy=numbers_text(rpy))


def numbers_text(numbers: Iterable[Scalar]) -> str:
    """Finite numbers separated by spaces, each as the shortest text that reads back to the same double.

    Raises:
        TypeError: one is an expression.
        ValueError: one is not finite.
    """
    return " ".join(_number(number) for number in numbers)


def _number(number: Scalar) -> str:
    if not isinstance(number, int | float):
        raise TypeError(
            f"a robot file holds numbers, not {type(number).__name__}: give the tree numbers first"
        )
    if not math.isfinite(number):
        raise ValueError(f"a robot file holds finite numbers, not {number}")
    without_negative_zero = float(number) + 0.0
    return repr(without_negative_zero)
