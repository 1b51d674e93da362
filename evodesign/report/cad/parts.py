"""The parts of a robot as a workshop counts them: links of solids, motors, axes of joints.

All numbers are SI, places those at joint angles of zero in the root link's frame.

    root_from_motor = root_from_parent  parent_from_child  R        R z = the joint's axis

A motor is the cylinder of its housing about the joint's axis: where it is mounted, or, where the mass model
has a ball, with its centre in the joint.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

from evodesign.body.placement import Matrix, Placement, Vector, perpendicular, transpose
from evodesign.body.shape import Cylinder, Solid
from evodesign.hardware.actuators import Actuator
from evodesign.tree.frames import link_frames
from evodesign.tree.model import Joint, JointKind, Link, Tree
from evodesign.tree.triangulation import mesh_of_look

AXIS_LENGTH = 0.2
"""Length of the line [m] that stands for the axis of a joint, half on each side."""


@dataclass(frozen=True, slots=True)
class LinkPart:
    """A link that is made of solids.

    Args:
        link: with its solids, in its own frame.
        file: stem of its files, of plain letters.
        root_from_link: its place.
        material: name, empty where the design names none.
    """

    link: Link
    file: str
    root_from_link: Placement
    material: str = ""

    @property
    def name(self) -> str:
        """That of the link."""
        return self.link.name


@dataclass(frozen=True, slots=True)
class MotorPart:
    """The housing of an actuator.

    Args:
        joint: which it drives.
        actuator: of numbers.
        link_from_motor: its place in the joint's parent link, the cylinder's axis along z.
        child_from_motor: likewise in the child link.
        root_from_motor: its place in the root link's frame.
    """

    joint: Joint
    actuator: Actuator
    link_from_motor: Placement
    child_from_motor: Placement
    root_from_motor: Placement

    @property
    def name(self) -> str:
        """`motor_` and the joint."""
        return f"motor_{self.joint.name}"

    @property
    def solid(self) -> Solid:
        """The cylinder in the parent link, with the mass of the actuator."""
        diameter, length = self.actuator.size
        shape = Cylinder(float(diameter) / 2.0, float(length))
        return Solid(shape, self.link_from_motor, float(self.actuator.mass) / shape.volume)


@dataclass(frozen=True, slots=True)
class AxisPart:
    """The axis of a joint that moves: along z of its place, with the origin in the joint."""

    joint: Joint
    root_from_axis: Placement

    @property
    def name(self) -> str:
        """`axis_` and the joint."""
        return f"axis_{self.joint.name}"


@dataclass(frozen=True, slots=True)
class Parts:
    """All parts of a robot.

    Args:
        tree: of the robot, numbers; shapes without mass are meshes.
        links: those with solids.
        motors: of joints with actuators.
        axes: of joints that move.
        meshes: stems of files of links that meshes alone show, or shapes without mass, by link.
        left_out: names of links that have mass and no shape.
    """

    tree: Tree
    links: tuple[LinkPart, ...]
    motors: tuple[MotorPart, ...]
    axes: tuple[AxisPart, ...]
    meshes: Mapping[str, str]
    left_out: tuple[str, ...]

    def motors_of(self, link: str) -> tuple[MotorPart, ...]:
        """The motors that a link holds."""
        return tuple(motor for motor in self.motors if motor.joint.parent == link)


def parts_of(tree: Tree, materials: Mapping[str, str]) -> Parts:
    """The parts of a robot.

    Args:
        tree: of a design, numbers.
        materials: names by link, of those that have one.
    """
    tree = replace(tree, links=tuple(_with_meshes(link) for link in tree.links))
    frames = link_frames(tree, Placement(), {})
    stems = _stems(link.name for link in tree.links)
    solid = [link for link in tree.links if link.solids]
    shown = {link.name: stems[link.name] for link in tree.links if link.shown and not link.solids}
    motors, axes = [], []
    for joint in tree.joints:
        if joint.kind is JointKind.FIXED:
            continue
        child_from_axis = Placement(rotation=turned_to(joint.axis))
        link_from_axis = joint.parent_from_child @ child_from_axis
        root_from_axis = frames[joint.parent] @ link_from_axis
        axes.append(AxisPart(joint, root_from_axis))
        if joint.actuator is not None:
            along = _along(joint.actuator)
            places = (each @ along for each in (link_from_axis, child_from_axis, root_from_axis))
            motors.append(MotorPart(joint, joint.actuator, *places))
    return Parts(
        tree=tree,
        links=tuple(
            LinkPart(link, stems[link.name], frames[link.name], materials.get(link.name, ""))
            for link in solid
        ),
        motors=tuple(motors),
        axes=tuple(axes),
        meshes=shown,
        left_out=tuple(
            link.name
            for link in tree.links
            if not link.solids and link.name not in shown and float(link.mass) > 0.0
        ),
    )


def _with_meshes(link: Link) -> Link:
    """A link whose shapes have no mass with meshes in their place; any other as it is."""
    seen = () if link.solids or link.meshes else link.looks
    return replace(link, meshes=tuple(map(mesh_of_look, seen)), looks=()) if seen else link


def _along(actuator: Actuator) -> Placement:
    """From the joint's axis to the middle of the housing."""
    if actuator.mounting is None:
        return Placement()
    return Placement(translation=(0.0, 0.0, actuator.mounting.share * float(actuator.size[1])))


def _stems(names: Iterable[str]) -> dict[str, str]:
    """File names of plain letters, whatever links are called, and each once on any file system."""
    stems: dict[str, str] = {}
    taken = {"assembly", "drawing", "readme"}
    for name in names:
        plain = re.sub(r"[^A-Za-z0-9_-]+", "_", name)[:60].strip("_") or "link"
        stem, number = plain, 1
        while stem.lower() in taken:
            number += 1
            stem = f"{plain}_{number}"
        taken.add(stem.lower())
        stems[name] = stem
    return stems


def turned_to(axis: Vector) -> Matrix:
    """A rotation whose third column is a unit vector: it takes z there."""
    return transpose((*perpendicular(axis), axis))
