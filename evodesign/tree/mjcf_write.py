"""A tree as MJCF text: MuJoCo's own format, floating over a ground plane, with postures as keyframes.

    body     <inertial> where there is mass, <geom> for each solid, look and mesh, <joint> when it moves
    asset    <mesh> for each mesh file
    key      position and quaternion of the root, then the joints in the order in which the file holds them

Moments that no body can have are balanced by MuJoCo, which refuses them otherwise (`balanceinertia`).

A link that is nothing but what lies between two joints is no body: its joint stands in the next one.

The robot's geoms touch the ground and not each other: neighbouring shapes overlap at the joints. A link of
solids that meshes show touches with its solids, which stand in group 3; one of meshes alone with their hulls.

Source: MuJoCo XML reference (compiler, body, joint, inertial, geom, keyframe).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from lxml import etree
from numpy.typing import NDArray

from evodesign.body.inertia import Inertia
from evodesign.body.placement import Placement, quaternion_wxyz, rotate
from evodesign.body.shape import Box, Cylinder, Shape, Sphere
from evodesign.errors import ModelError
from evodesign.tree.equip import actuators_of
from evodesign.tree.mesh_write import NO_MESHES, MeshNames, has_hull, named_meshes
from evodesign.tree.model import Joint, JointKind, Link, Tree
from evodesign.tree.urdf_write import numbers_text

KINDS = {JointKind.REVOLUTE: "hinge", JointKind.CONTINUOUS: "hinge", JointKind.PRISMATIC: "slide"}
TOUCHES_GROUND: dict[str, str] = {"contype": "0", "conaffinity": "1"}
TOUCHES_NOTHING: dict[str, str] = {"contype": "0", "conaffinity": "0"}
SMALL = 1e-3
"""Radius of gyration [m] that MuJoCo is given of a link that has a mass and no moments of inertia."""

COLOR = "0.36 0.52 0.70 1"


@dataclass(frozen=True, slots=True)
class KeyPosture:
    """A posture to be kept as a keyframe.

    Args:
        world_from_root: of the root link.
        joints: positions [rad or m] by name; joints left out stand at zero.
    """

    world_from_root: Placement
    joints: Mapping[str, float]


def mjcf_text(
    tree: Tree, gravity: float, postures: Mapping[str, KeyPosture], meshes: MeshNames = NO_MESHES
) -> str:
    """The tree as indented XML.

    Args:
        tree: of numbers.
        gravity: [m/s^2], along -z.
        postures: keyframes by name.
        meshes: files of the meshes that are to be seen.
    Raises:
        ModelError: MuJoCo cannot hold the tree: a link that moves has no mass, or one is called `world`.
    """
    _check(tree)
    model = etree.Element("mujoco", model=tree.name)
    compiler = etree.SubElement(model, "compiler", angle="radian", autolimits="true", inertiafromgeom="false")
    if any(link.inertia.mass and not _is_possible(link.inertia) for link in tree.links):
        compiler.set("balanceinertia", "true")
    etree.SubElement(model, "option", gravity=numbers_text([0.0, 0.0, -gravity]))
    if meshes:
        asset = etree.SubElement(model, "asset")
        for file in dict.fromkeys(meshes.values()):
            # the volume, which a mesh need not have, is not asked for
            etree.SubElement(asset, "mesh", name=_asset(file), file=file, inertia="shell")
    world = etree.SubElement(model, "worldbody")
    etree.SubElement(world, "light", pos="0 -2 4", dir="0 0.5 -1", directional="true")
    ground = {"contype": "1", "conaffinity": "0", "rgba": "0.9 0.9 0.9 1"}
    etree.SubElement(world, "geom", type="plane", size="3 3 0.1", **ground)
    _add_body(world, tree, tree.root, Placement(), (), meshes)
    driven = actuators_of(tree)
    if driven:
        motors = etree.SubElement(model, "actuator")
        for joint, actuator in driven.items():
            ends = numbers_text([-actuator.peak, actuator.peak])
            etree.SubElement(motors, "motor", name=joint, joint=joint, ctrlrange=ends)
    if postures:
        frame = etree.SubElement(model, "keyframe")
        for name, posture in postures.items():
            etree.SubElement(frame, "key", name=name, qpos=numbers_text(_coordinates(tree, posture)))
    text: bytes = etree.tostring(model, pretty_print=True, xml_declaration=True, encoding="utf-8")
    return text.decode("utf-8")


def _check(tree: Tree) -> None:
    if "world" in tree.link_by_name:
        raise ModelError(
            tree.name, "link world", "another name, as MuJoCo has a 'world' of its own", "'world'"
        )
    for joint in tree.joints:
        if joint.kind is JointKind.FIXED or _beyond_nothing(tree, joint.child):
            continue
        if not _carried_mass(tree, joint.child):
            wanted = "mass, which MuJoCo asks of every link that moves"
            raise ModelError(tree.name, f"link {joint.child}", wanted, "none")


def _beyond_nothing(tree: Tree, name: str) -> Joint | None:
    """The one joint of a link that has neither mass nor looks, if it moves."""
    link, below = tree.link_by_name[name], tree.child_joints[name]
    if len(below) != 1 or below[0].kind is JointKind.FIXED or link.looks or link.meshes:
        return None
    return None if float(link.inertia.mass) else below[0]


def _carried_mass(tree: Tree, link: str) -> float:
    """Mass [kg] of a link and of everything welded to it."""
    welded = [joint.child for joint in tree.child_joints[link] if joint.kind is JointKind.FIXED]
    return float(tree.link_by_name[link].inertia.mass) + sum(_carried_mass(tree, child) for child in welded)


PlacedJoints = tuple[tuple[Joint, Placement], ...]
"""Joints of a body, each with its frame's place in the body's."""


def _add_body(
    above: etree._Element, tree: Tree, name: str, place: Placement, joints: PlacedJoints, meshes: MeshNames
) -> None:
    link, following = tree.link_by_name[name], _beyond_nothing(tree, name)
    if joints and following:
        next_from_here = following.parent_from_child.inverse
        moved = tuple((joint, next_from_here @ at) for joint, at in joints)
        place = place @ following.parent_from_child
        _add_body(above, tree, following.child, place, (*moved, (following, Placement())), meshes)
        return
    body = etree.SubElement(above, "body", name=name, **_pose(place))
    if name == tree.root:
        etree.SubElement(body, "freejoint")
    for joint, at in joints:
        _add_joint(body, joint, at)
    _add_inertial(body, link.inertia)
    _add_geoms(body, link, meshes)
    for below in tree.child_joints[name]:
        own = () if below.kind is JointKind.FIXED else ((below, Placement()),)
        _add_body(body, tree, below.child, below.parent_from_child, own, meshes)


def _add_joint(body: etree._Element, joint: Joint, body_from_joint: Placement) -> None:
    element = etree.SubElement(body, "joint", name=joint.name, type=KINDS[joint.kind])
    if any(body_from_joint.translation):
        element.set("pos", numbers_text(body_from_joint.translation))
    element.set("axis", numbers_text(rotate(body_from_joint.rotation, joint.axis)))
    if joint.kind is not JointKind.CONTINUOUS and math.isfinite(joint.upper - joint.lower):
        element.set("range", numbers_text([joint.lower, joint.upper]))
    if math.isfinite(joint.effort) and joint.effort > 0.0:
        element.set("actuatorfrcrange", numbers_text([-joint.effort, joint.effort]))
    if joint.actuator is not None:
        element.set("armature", numbers_text([joint.actuator.inertia]))


def _principal(inertia: Inertia) -> NDArray[np.float64]:
    """Moments about the principal axes, the smallest first [kg m^2]."""
    return np.linalg.eigvalsh(np.array(inertia.about_center, float))


def _is_possible(inertia: Inertia) -> bool:
    """Whether a body could have these moments: none is larger than the other two together."""
    small, middle, large = _principal(inertia)
    return bool(small > 0.0 and small + middle >= large)


def _add_inertial(body: etree._Element, inertia: Inertia) -> None:
    if float(inertia.mass) == 0.0:
        return
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = inertia.about_center
    least = float(_principal(inertia)[0])
    more = 0.0 if least > 0.0 else float(inertia.mass) * SMALL**2 - least
    moments = numbers_text([xx + more, yy + more, zz + more, xy, xz, yz])
    etree.SubElement(
        body,
        "inertial",
        pos=numbers_text(inertia.center),
        mass=numbers_text([inertia.mass]),
        fullinertia=moments,
    )


def _add_geoms(body: etree._Element, link: Link, meshes: MeshNames) -> None:
    files = named_meshes(link, meshes)
    for mesh, file in files:
        touch = TOUCHES_GROUND if not link.solids and has_hull(mesh) else TOUCHES_NOTHING
        _add_geom(body, {"type": "mesh", "mesh": _asset(file)}, mesh.link_from_mesh, touch)
    beside = {"group": "3"} if files else {}
    for solid in link.solids:
        _add_geom(body, _form(solid.shape), solid.link_from_solid, TOUCHES_GROUND | beside)
    for look in () if files else link.looks:
        _add_geom(body, _form(look.shape), look.link_from_look, TOUCHES_NOTHING)


def _form(shape: Shape) -> dict[str, str]:
    match shape:
        case Sphere(radius):
            return {"type": "sphere", "size": numbers_text([radius])}
        case Cylinder(radius, length):
            return {"type": "cylinder", "size": numbers_text([radius, length / 2.0])}
        case Box():
            return {"type": "box", "size": numbers_text([side / 2.0 for side in shape.sides])}


def _add_geom(
    body: etree._Element, form: Mapping[str, str], place: Placement, touch: Mapping[str, str]
) -> None:
    etree.SubElement(body, "geom", {**form, **_pose(place), "rgba": COLOR, **touch})


def _asset(file: str) -> str:
    return file.rpartition("/")[2].removesuffix(".stl")


def _pose(place: Placement) -> dict[str, str]:
    return {"pos": numbers_text(place.translation), "quat": numbers_text(quaternion_wxyz(place.rotation))}


def _coordinates(tree: Tree, posture: KeyPosture) -> list[float]:
    place = posture.world_from_root
    joints = [posture.joints.get(name, 0.0) for name in _order(tree, tree.root)]
    return [*place.translation, *quaternion_wxyz(place.rotation), *joints]


def _order(tree: Tree, link: str) -> Iterator[str]:
    """Moving joints below a link, in the order in which bodies nest: depth first."""
    for joint in tree.child_joints[link]:
        if joint.kind is not JointKind.FIXED:
            yield joint.name
        yield from _order(tree, joint.child)
