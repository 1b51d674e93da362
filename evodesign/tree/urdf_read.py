"""A tree from URDF text.

`urdf_check` vets the XML first; here its elements become links and joints.

    shape of a link    its visuals; its collisions if there is none; no shape if there is a mesh among them:
                       what is seen beside a mesh is a mesh then, too
    capsule            a mesh of triangles with the capsule's own volume (`triangulation.capsule_surface`)
    robot's link       with a shape and mass: solids of one density, mass / volume (`InertiaRule.SHAPES`)
                       with a mesh, or no shape: the file's mass, centre of mass and tensor
                       with a shape alone: only seen
    person's link      the file's centre of mass and tensor (`InertiaRule.FILE`); its shape is only seen
    mimic joint        locked where its formula puts it (`urdf_mimic`)

What a file says and the tree does not take as it stands is told in `Tree.notes`: locked joints, shapes that
were left out, what is not read (`urdf_unread`), figures in what seem to be other units (`unit_doubts`), what
<note> elements say, and tensors that no body has (a principal moment is larger than the
sum of the others). Such a tensor is kept: holding a load asks for mass and centre of mass alone.

Source: wiki.ros.org/urdf/XML (link, joint); Traversaro et al. 2016, Section III (tensors that bodies have).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from lxml import etree

from evodesign.body.inertia import Inertia
from evodesign.body.placement import Placement, Vector, scale
from evodesign.body.shape import Box, Cylinder, Shape, Solid, Sphere
from evodesign.errors import ModelError, listed
from evodesign.tree.frames import parent_from_child
from evodesign.tree.model import Joint, JointKind, Link, Look, Mesh, Tree
from evodesign.tree.triangulation import capsule_surface, mesh_of_look
from evodesign.tree.unit_doubts import unit_doubts
from evodesign.tree.urdf_check import checked_urdf
from evodesign.tree.urdf_write import UNLIMITED

LEAST_MASS = 1e-9
"""A link below a microgram [kg] has no mass: some files give their frames a tiny one."""

ROUNDED, NO_MOMENT = 0.01, 1e-12
"""Share of the largest principal moment by which a file's figures may miss the triangle inequality, and a
moment [kg m^2] that counts as zero: some files give their links a mass and no tensor."""

LONGEST_CHAIN = 200
"""Joints from the root to a link; what is computed along a chain recurs."""


class InertiaRule(StrEnum):
    """Where a link's centre of mass and inertia come from.

    SHAPES: a link with primitive shapes and mass is made of solids of one density, mass / volume; the file's
    tensor gives way, and collision shapes stand in for visual meshes. FILE: as the file says, and shapes are
    only seen. AUTO: FILE for links with a mesh, SHAPES for the others.
    """

    AUTO = "auto"
    SHAPES = "shapes"
    FILE = "file"


def read_urdf(text: str, source: str, rule: InertiaRule) -> Tree:
    """The tree that a URDF describes.

    Args:
        text: the URDF.
        source: the file's name, for messages.
        rule: whether inertia follows from the shapes or from the file.
    Returns:
        A tree whose axes are of unit length, otherwise as given; limits that the file leaves out, or gives
        as the largest double, are infinite.
    Raises:
        ModelError: the text is not XML, not a URDF, or not a usable tree; says where and why.
    """
    notes: list[str] = []
    robot = checked_urdf(text, source, notes)
    links = tuple(_link(element, rule) for element in robot.findall("link"))
    held = held_positions(robot, source)
    joints = tuple(_joint(joint, held) for joint in robot.findall("joint"))
    notes += _strange(robot, links)
    notes += unit_doubts(links, joints)
    try:
        tree = Tree(robot.get("name", ""), links, joints, tuple(notes))
    except ModelError as error:
        raise ModelError(source, error.key, error.wanted, error.found) from error
    depth = {tree.root: 0}
    for joint in tree.joints:
        depth[joint.child] = depth[joint.parent] + 1
        if depth[joint.child] > LONGEST_CHAIN:
            key = f"joint {joint.name}"
            raise ModelError(source, key, f"chains of at most {LONGEST_CHAIN} joints", "a longer one")
    return tree


def links_by_rule(text: str, source: str, rules: Sequence[InertiaRule]) -> list[tuple[Link, ...]]:
    """The links of a URDF in file order, by each of several rules; otherwise as in `read_urdf`."""
    elements = checked_urdf(text, source, []).findall("link")
    return [tuple(_link(element, rule) for element in elements) for rule in rules]


@dataclass(frozen=True, slots=True)
class Shapes:
    """The shapes of a link under one role."""

    primitives: tuple[Look, ...]
    meshes: tuple[Mesh, ...]

    @property
    def known(self) -> bool:
        """Whether no mesh of a file is among them."""
        return all(mesh.surface is not None for mesh in self.meshes)

    @property
    def all_meshes(self) -> tuple[Mesh, ...]:
        """The meshes, and the primitives beside them as such."""
        return (*self.meshes, *map(mesh_of_look, self.primitives)) if self.meshes else ()


def _link(link: etree._Element, rule: InertiaRule) -> Link:
    seen, touched = (_shapes(link.findall(role)) for role in ("visual", "collision"))
    shapes = () if seen.meshes else seen.primitives
    if not shapes and (rule is not InertiaRule.AUTO or not seen.meshes):
        shapes = () if touched.meshes else touched.primitives
    inertia, name = _inertia(link.find("inertial")), link.get("name", "")
    if rule is not InertiaRule.FILE and shapes and inertia.mass > 0.0:
        density = inertia.mass / sum(look.shape.volume for look in shapes)
        solids = tuple(Solid(look.shape, look.link_from_look, density) for look in shapes)
        return Link(name, solids=solids, meshes=seen.all_meshes)
    capsules = touched.all_meshes if not (seen.primitives or seen.meshes) and touched.known else ()
    return Link(name, own_inertia=inertia, looks=shapes, meshes=seen.all_meshes or capsules)


def _shapes(looks: list[etree._Element]) -> Shapes:
    found = [(look.find("geometry")[0], _placement(look.find("origin"))) for look in looks]
    return Shapes(
        tuple(Look(_shape(shape), place) for shape, place in found if shape.tag not in ("mesh", "capsule")),
        tuple(_mesh(shape, place) for shape, place in found if shape.tag in ("mesh", "capsule")),
    )


def _mesh(shape: etree._Element, place: Placement) -> Mesh:
    if shape.tag == "mesh":
        return Mesh(shape.get("filename"), _vector(shape, "scale", (1.0, 1.0, 1.0)), place)
    surface = capsule_surface(_number(shape, "radius"), _number(shape, "length"))
    return Mesh("capsule", link_from_mesh=place, surface=surface)


def _shape(shape: etree._Element) -> Shape:
    if shape.tag == "sphere":
        return Sphere(_number(shape, "radius"))
    if shape.tag == "cylinder":
        return Cylinder(_number(shape, "radius"), _number(shape, "length"))
    return Box(*_vector(shape, "size", ()))


def _inertia(inertial: etree._Element | None) -> Inertia:
    """Inertia in the link's frame; a link without mass has none."""
    mass = 0.0 if inertial is None else _number(inertial.find("mass"), "value")
    if inertial is None or mass < LEAST_MASS:
        return Inertia()
    xx, xy, xz, yy, yz, zz = (
        _number(inertial.find("inertia"), name) for name in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    )
    here = Inertia(mass, about_center=((xx, xy, xz), (xy, yy, yz), (xz, yz, zz)))
    return here.moved(_placement(inertial.find("origin")))


def _strange(robot: etree._Element, links: Iterable[Link]) -> Iterator[str]:
    """Sentences for joints that are locked, and for kept tensors that no body has."""
    locked = [joint.get("name", "") for joint in robot.findall("joint") if joint.find("mimic") is not None]
    if locked:
        yield f"locked where they are while the joints that they mimic are at zero: {listed(locked)}"
    capsules = [each.getparent().getparent().getparent().get("name") for each in robot.iter("capsule")]
    if capsules:
        yield (
            "capsules are meshes of triangles, within 1 % of their radius; mass and inertia are the file's: "
            f"{listed(list(dict.fromkeys(capsules)))}"
        )
    impossible = [link.name for link in links if _is_impossible(link.own_inertia)]
    if impossible:
        yield (
            "no body has the inertia tensor (a principal moment is larger than the sum of the others; "
            f"postures ask for mass and centre of mass alone): {listed(impossible)}"
        )


def _is_impossible(inertia: Inertia) -> bool:
    if inertia.mass == 0.0:
        return False
    moments = [float(moment) for moment in np.linalg.eigvalsh(np.array(inertia.about_center))]
    return moments[2] > NO_MOMENT and moments[0] + moments[1] < (1.0 - ROUNDED) * moments[2]


def _joint(joint: etree._Element, held: Mapping[str, float]) -> Joint:
    name, kind = joint.get("name", ""), JointKind(joint.get("type"))
    parent, child = (joint.find(role).get("link") for role in ("parent", "child"))
    place = _placement(joint.find("origin"))
    if kind is JointKind.FIXED:
        return Joint(name, kind, parent, child, place)
    given = _vector(joint.find("axis"), "xyz", (1.0, 0.0, 0.0))
    axis = scale(1.0 / math.hypot(*given), given)
    if name in held:
        moving = Joint(name, kind, parent, child, place, axis)
        return Joint(name, JointKind.FIXED, parent, child, parent_from_child(moving, held[name]))
    limit = joint.find("limit")  # None for a continuous joint alone: the check asks the others for one
    ends = (-math.inf, math.inf)
    if kind is not JointKind.CONTINUOUS:
        ends = _limit(_number(limit, "lower", "0")), _limit(_number(limit, "upper", "0"))
    effort, velocity = (
        math.inf if limit is None or limit.get(key) is None else _limit(_number(limit, key))
        for key in ("effort", "velocity")
    )
    return Joint(name, kind, parent, child, place, axis, *ends, effort, velocity)


def _placement(origin: etree._Element | None) -> Placement:
    """The placement of an <origin>; the identity when it is left out."""
    nowhere = (0.0, 0.0, 0.0)
    xyz = _vector(origin, "xyz", nowhere)
    if origin is not None and origin.get("quat_xyzw"):
        x, y, z, w = map(float, origin.get("quat_xyzw").split())
        return Placement.from_xyz_wxyz(xyz, (w, x, y, z))
    return Placement.from_xyz_rpy(xyz, _vector(origin, "rpy", nowhere))


def _limit(value: float) -> float:
    return math.copysign(math.inf, value) if abs(value) >= UNLIMITED else value


def _number(element: etree._Element, name: str, otherwise: str = "") -> float:
    return float(element.get(name, otherwise))


def _vector(element: etree._Element | None, name: str, otherwise: tuple[float, ...]) -> Vector:
    """Three numbers of an attribute, or others when element or attribute are left out."""
    text = None if element is None else element.get(name)
    x, y, z = otherwise if text is None else map(float, text.split())
    return (x, y, z)


def held_positions(robot: etree._Element, source: str) -> dict[str, float]:
    """Positions [rad or m] of the mimic joints, by name, while every joint that moves by itself is at zero.

        q = multiplier q_leader + offset        q_leader = 0 where the leader follows nobody

    Leaders may follow others themselves.

    Args:
        robot: of a checked URDF.
        source: the file's name, for messages.
    Raises:
        ModelError: joints follow each other in a ring.
    Source: wiki.ros.org/urdf/XML/joint (mimic); pinocchio and MuJoCo place such chains likewise.
    """
    mimics = {joint.get("name"): joint.find("mimic") for joint in robot.findall("joint")}
    followers = {name: mimic for name, mimic in mimics.items() if mimic is not None}
    held: dict[str, float] = {}
    for name in followers:
        chain = [name]
        while (leader := followers[chain[-1]].get("joint")) in followers and leader not in held:
            if leader in chain:
                wanted = "a leader that does not follow its follower"
                raise ModelError(source, f"joint {name}.mimic.joint", wanted, f"'{leader}', which does")
            chain.append(leader)
        for each in reversed(chain):
            mimic = followers[each]
            slope, offset = float(mimic.get("multiplier", "1")), float(mimic.get("offset", "0"))
            held[each] = slope * held.get(mimic.get("joint"), 0.0) + offset
    return held
