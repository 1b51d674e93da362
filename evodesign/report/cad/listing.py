"""The bill of materials of a drawing: links and motors, equal ones in one row.

Mirror images are equal: section, wall, material, mass and the distance to the next joint decide.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from evodesign.body.shape import Box, Cylinder, Shape, Solid, Sphere
from evodesign.report.cad.parts import LinkPart, MotorPart, Parts
from evodesign.tree.mesh_write import vertices_of
from evodesign.tree.model import JointKind, Link, Tree


@dataclass(frozen=True, slots=True)
class LinkRow:
    """Equal links.

    Args:
        item: number in the list, from 1.
        names: of the links.
        section: outer dimensions of each solid [mm], as text; of meshes those of the box around them.
        wall: thickness of each solid's wall [mm], as text.
        material: name, or the density.
        length: from the link's own joint to the farthest one that it holds [mm]; None without one of them.
        mass: of one, without motors [kg].
    """

    item: int
    names: tuple[str, ...]
    section: str
    wall: str
    material: str
    length: float | None
    mass: float


@dataclass(frozen=True, slots=True)
class MotorRow:
    """Equal motors.

    Args:
        item: `M` and a number in the list, from 1.
        joints: that they drive.
        model: of the catalogue; `any of this size` where the design has a law's.
        rated, peak: torque [N m].
        housing: diameter and length [mm], as text.
        mass: of one [kg].
    """

    item: str
    joints: tuple[str, ...]
    model: str
    rated: float
    peak: float
    housing: str
    mass: float


def millimetres(length: float) -> str:
    """A length [m] in millimetres with at most one decimal."""
    return f"{1000.0 * float(length):.1f}".removesuffix(".0")


def section_text(shape: Shape) -> str:
    """Outer dimensions of a shape [mm]."""
    match shape:
        case Sphere(radius):
            return f"ball Ø{millimetres(2.0 * radius)}"
        case Cylinder(radius, length):
            return f"Ø{millimetres(2.0 * radius)} x {millimetres(length)}"
        case Box():
            return " x ".join(millimetres(side) for side in shape.sides)


def wall_text(solid: Solid) -> str:
    """Thickness of a solid's wall [mm]."""
    return "full" if solid.wall is None else millimetres(float(solid.wall))


def material_text(part: LinkPart) -> str:
    """The material's name, or the densities of the solids."""
    if part.material:
        return part.material
    densities = dict.fromkeys(f"{float(solid.density):.0f} kg/m³" for solid in part.link.solids)
    return ", ".join(densities)


def link_rows(parts: Parts) -> tuple[LinkRow, ...]:
    """Links with solids in the tree's order, then those of meshes alone; equal ones together."""
    lengths = {name: round(1000.0 * each, 1) for name, each in joint_distances(parts.tree).items()}
    rows: dict[tuple[object, ...], list[str]] = {}
    for part in parts.links:
        solids = part.link.solids
        key = (
            " + ".join(section_text(solid.shape) for solid in solids),
            ", ".join(dict.fromkeys(wall_text(solid) for solid in solids)),
            material_text(part),
            lengths.get(part.name),
            round(float(sum(solid.mass for solid in solids)), 3),
        )
        rows.setdefault(key, []).append(part.name)
    for link in (parts.tree.link_by_name[name] for name in parts.meshes):
        mass = round(float(link.own_inertia.mass), 3)
        rows.setdefault((_mesh_text(link), "-", "-", lengths.get(link.name), mass), []).append(link.name)
    return tuple(
        LinkRow(item, tuple(names), *key)  # type: ignore[arg-type]
        for item, (key, names) in enumerate(rows.items(), 1)
    )


def _mesh_text(link: Link) -> str:
    """The box around the meshes of a link, along the link's axes [mm]."""
    vertices = np.concatenate([vertices_of(mesh) for mesh in link.meshes])
    return "mesh " + " x ".join(f"{1000.0 * side:.0f}" for side in np.ptp(vertices, axis=0))


def joint_distances(tree: Tree) -> Mapping[str, float]:
    """From each link's own joint to the farthest one that moves and that it holds [m]; the root has none."""
    found = {}
    for link in tree.links:
        below = [joint for joint in tree.child_joints[link.name] if joint.kind is not JointKind.FIXED]
        if below and link.name != tree.root:
            found[link.name] = max(
                math.sqrt(sum(float(x) ** 2 for x in joint.parent_from_child.translation)) for joint in below
            )
    return found


def motor_rows(parts: Parts) -> tuple[MotorRow, ...]:
    """Motors in the tree's order, equal ones together."""
    rows: dict[tuple[object, ...], list[str]] = {}
    for motor in parts.motors:
        rows.setdefault(_motor_key(motor), []).append(motor.joint.name)
    return tuple(
        MotorRow(f"M{item}", tuple(joints), *key)  # type: ignore[arg-type]
        for item, (key, joints) in enumerate(rows.items(), 1)
    )


def _motor_key(motor: MotorPart) -> tuple[object, ...]:
    actuator = motor.actuator
    diameter, length = actuator.size
    return (
        actuator.model or "any of this size",
        round(float(actuator.rated), 2),
        round(float(actuator.peak), 2),
        f"Ø{millimetres(diameter)} x {millimetres(length)}",
        round(float(actuator.mass), 3),
    )
