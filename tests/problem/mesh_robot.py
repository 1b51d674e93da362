"""Point-grasp's robot with meshes in place of some shapes, written with a problem file of its own.

chest                an open box, in metres, by a relative path: it encloses nothing
upper arms           one watertight file in millimetres, tilted, mirrored for the right arm, in a package
thighs               a finely cut capsule as COLLADA
"""

from __future__ import annotations

from pathlib import Path

import trimesh
from lxml import etree

REPOSITORY = Path(__file__).parents[2]
PACKAGE = "clad"
ARM_SIZE = (0.03, 0.05, 0.15)
"""Sides of the upper arm's wedge [m], which encloses half of their product."""

MESHES = {
    "chest": ("../meshes/chest.stl", "1 1 1"),
    "l_upper_arm": (f"package://{PACKAGE}/meshes/arm.STL", "0.001 0.001 0.001"),
    "r_upper_arm": (f"package://{PACKAGE}/meshes/arm.STL", "0.001 -0.001 0.001"),
    "l_hip_3": (f"package://{PACKAGE}/meshes/thigh.dae", "1 1 1"),
    "r_hip_3": (f"package://{PACKAGE}/meshes/thigh.dae", "1 1 1"),
}


def wedge() -> trimesh.Trimesh:
    """A prism over a right triangle [mm]: no two of its mirror images are alike."""
    x, y, z = (1000.0 * side for side in ARM_SIZE)
    low, high = ([(0, 0, z * k), (x, 0, z * k), (0, y, z * k)] for k in (-0.5, 0.5))
    return trimesh.convex.convex_hull([*low, *high])


def capsule() -> trimesh.Trimesh:
    return trimesh.creation.capsule(height=0.12, radius=0.04, count=(60, 60))


def open_box() -> trimesh.Trimesh:
    box = trimesh.creation.box((0.1, 0.2, 0.15))
    return trimesh.Trimesh(box.vertices, box.faces[2:], process=False)


def write_mesh_problem(folder: Path, robot: str = "") -> Path:
    """The problem file in a folder, with robot and meshes beside it.

    Args:
        folder: is filled.
        robot: further lines of `[robot]`.
    """
    package = folder / PACKAGE
    (package / "meshes").mkdir(parents=True)
    (package / "urdf").mkdir()
    open_box().export(package / "meshes" / "chest.stl")
    wedge().export(package / "meshes" / "arm.STL", file_type="stl")
    capsule().export(package / "meshes" / "thigh.dae")
    (package / "urdf" / "clad.urdf").write_bytes(mesh_urdf())
    text = (REPOSITORY / "problems" / "point_grasp.toml").read_text(encoding="utf-8")
    before, *tables = text.split("[[design.")
    lengths = [table for table in tables if table.startswith("length]]")]
    dense = [table for table in tables if table.startswith('density]]\nname = "upper_arm"')]
    before = before.replace('"robots/icub_shapes.urdf"', f'"{PACKAGE}/urdf/clad.urdf"\n{robot}')
    before = before.replace('start = "../populations/icub.toml"', "")
    solver = '[solver]\nsymmetry = "off"\nstart_portfolio = false\ncompile = false\n\n'
    path = folder / "problem.toml"
    path.write_text("[[design.".join([before + solver, *lengths, *dense]), encoding="utf-8")
    return path


def mesh_urdf() -> bytes:
    """The robot's file."""
    robot = etree.parse(REPOSITORY / "problems" / "robots" / "icub_shapes.urdf").getroot()
    for link in robot.findall("link"):
        if link.get("name") in MESHES:
            name, scale = MESHES[link.get("name")]
            for collision in link.findall("collision"):
                link.remove(collision)
            if link.get("name").endswith("_arm"):
                link.find("visual/origin").set("rpy", "0.2 0.4 -0.3")
            geometry = link.find("visual/geometry")
            geometry.remove(geometry[0])
            etree.SubElement(geometry, "mesh", filename=name, scale=scale)
    text: bytes = etree.tostring(robot)
    return text
