"""An exported robot of meshes: its files are beside it, stretched with their links, and open elsewhere."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pinocchio
import pytest
import trimesh
import yourdfpy

from evodesign.body.placement import Placement
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.source import read_source
from evodesign.report.export.design import ExportedDesign
from evodesign.report.export.folder import export_design
from evodesign.tree.frames import link_frames
from evodesign.tree.mesh_write import has_hull, mesh_files, vertices_of
from evodesign.tree.mjcf_write import mjcf_text
from evodesign.tree.model import Mesh
from evodesign.tree.resize import growth_of
from evodesign.tree.surface import surface_of
from evodesign.tree.urdf_read import InertiaRule, read_urdf
from tests.problem.mesh_robot import MESHES, wedge, write_mesh_problem
from tests.report.export.test_folder import design_of, welded_root_mass
from tests.report.scenes import random_detail

CLOSE = 2e-5
"""[m] of what 16 bits and single precision tell of a mesh's vertices."""


@pytest.fixture(scope="module")
def clad(tmp_path_factory: pytest.TempPathFactory) -> DesignProblem:
    return build_problem(read_source(write_mesh_problem(tmp_path_factory.mktemp("clad"))))


@pytest.fixture(scope="module")
def exported(clad: DesignProblem, tmp_path_factory: pytest.TempPathFactory) -> tuple[ExportedDesign, Path]:
    design = design_of(clad, random_detail(clad, 2))
    folder = tmp_path_factory.mktemp("export") / "clad"
    done = export_design(design, folder, on_front=True)
    assert not done.left_out
    return design, folder


def test_the_folder_holds_each_mesh_as_its_readme_says(exported: tuple[ExportedDesign, Path]) -> None:
    _, folder = exported
    named = re.findall(r'<mesh filename="([^"]*)"', (folder / "robot.urdf").read_text())
    assert len(named) == len(MESHES)
    assert {str(path.relative_to(folder)) for path in folder.glob("meshes/*")} == set(named)
    readme = (folder / "README.md").read_text()
    assert "- `meshes`: " in readme
    assert "needs no other file" not in readme
    assert "chest.stl" not in readme


def test_an_arms_vertices_are_those_of_its_file_scaled_turned_and_stretched(
    clad: DesignProblem, exported: tuple[ExportedDesign, Path]
) -> None:
    """By hand: the affine map along the link's main axis, of the vertices that trimesh made."""
    design, folder = exported
    factor = design.evaluation.assessment.design["length.upper_arm"]
    robot = yourdfpy.URDF.load(str(folder / "robot.urdf"))
    for name, mirror in (("l_upper_arm", 1.0), ("r_upper_arm", -1.0)):
        axis = np.array(growth_of(clad.scene.robot.tree, name).axis)
        place = clad.scene.robot.tree.link_by_name[name].meshes[0].link_from_mesh
        before = (
            wedge().vertices * 0.001 * (1.0, mirror, 1.0) @ np.array(place.rotation).T + place.translation
        )
        wanted = before + (factor - 1.0) * np.outer(before @ axis, axis)
        (visual,) = robot.link_map[name].visuals
        written = trimesh.load_mesh(folder / visual.geometry.mesh.filename)
        found = trimesh.transform_points(written.vertices, visual.origin)
        np.testing.assert_allclose(in_order(found), in_order(wanted), atol=CLOSE)
        assert written.is_volume, "and its normals point outwards"
        assert written.volume == pytest.approx(factor * wedge().volume * 1e-9, rel=1e-3)


def in_order(points: np.ndarray) -> np.ndarray:
    """Points by their distances from three corners of nowhere, whatever order they came in."""
    return points[np.argsort(points @ (1.0, 0.1234, 0.01))]


def test_pinocchio_and_yourdfpy_show_each_mesh_where_its_link_is(
    exported: tuple[ExportedDesign, Path],
) -> None:
    design, folder = exported
    tree = design.scene_set.robot
    path = str(folder / "robot.urdf")
    model, _, visual = pinocchio.buildModelsFromUrdf(path, str(folder), pinocchio.JointModelFreeFlyer())
    mass = sum(link.inertia.mass for link in tree.links)
    assert pinocchio.computeTotalMass(model) == pytest.approx(mass, abs=1e-9)
    robot = yourdfpy.URDF.load(path)
    assert sum(link.inertial.mass for link in robot.link_map.values() if link.inertial) == pytest.approx(mass)
    data, drawn = model.createData(), visual.createData()
    pinocchio.updateGeometryPlacements(model, data, visual, drawn, pinocchio.neutral(model))
    frames = link_frames(tree, Placement(), {})
    for name in MESHES:
        (mesh,) = tree.link_by_name[name].meshes
        wanted = vertices_of(mesh) @ np.array(frames[name].rotation).T + frames[name].translation
        (index,) = (i for i, each in enumerate(visual.geometryObjects) if each.name.startswith(f"{name}_"))
        hull = visual.geometryObjects[index].geometry
        points = np.array([hull.vertex(i) for i in range(hull.num_vertices)])
        place = drawn.oMg[index]
        check_box(points @ place.rotation.T + place.translation, wanted)
        (node,) = (
            n for n in robot.scene.graph.nodes_geometry if robot.scene.graph.transforms.parents[n] == name
        )
        pose, geometry = robot.scene.graph.get(node, tree.root)
        check_box(trimesh.transform_points(robot.scene.geometry[geometry].vertices, pose), wanted)


def check_box(points: np.ndarray, wanted: np.ndarray) -> None:
    np.testing.assert_allclose(points.min(axis=0), wanted.min(axis=0), atol=CLOSE)
    np.testing.assert_allclose(points.max(axis=0), wanted.max(axis=0), atol=CLOSE)


def test_mujoco_shows_each_mesh_where_its_link_is(exported: tuple[ExportedDesign, Path]) -> None:
    design, folder = exported
    tree = design.scene_set.robot
    model = mujoco.MjModel.from_xml_path(str(folder / "robot.xml"))
    mass = sum(link.inertia.mass for link in tree.links)
    assert float(model.body_mass.sum()) == pytest.approx(mass, abs=1e-9)
    assert model.nmesh == len(list(folder.glob("meshes/*")))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    meshes = [i for i in range(model.ngeom) if model.geom_type[i] == mujoco.mjtGeom.mjGEOM_MESH]
    assert len(meshes) == len(MESHES)
    for geom in meshes:
        body = model.body(model.geom_bodyid[geom])
        (mesh,) = tree.link_by_name[body.name].meshes
        begin, count = (
            model.mesh_vertadr[model.geom_dataid[geom]],
            model.mesh_vertnum[model.geom_dataid[geom]],
        )
        points = model.mesh_vert[begin : begin + count]
        in_world = points @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom]
        pose = data.body(body.name)
        check_box((in_world - pose.xpos) @ pose.xmat.reshape(3, 3), vertices_of(mesh))
        assert model.geom_conaffinity[geom] == 1, "it stands on the ground"
    fixed = mujoco.MjModel.from_xml_path(str(folder / "robot.urdf"))
    assert float(fixed.body_mass.sum()) == pytest.approx(mass - welded_root_mass(design), abs=1e-9)


def test_the_exported_robot_reads_back_with_its_inertias(exported: tuple[ExportedDesign, Path]) -> None:
    design, folder = exported
    again = read_urdf((folder / "robot.urdf").read_text(), "robot.urdf", InertiaRule.AUTO)
    for link, before in zip(again.links, design.scene_set.robot.links, strict=True):
        assert link.inertia.mass == pytest.approx(before.inertia.mass, rel=1e-12)
        np.testing.assert_allclose(link.inertia.center, before.inertia.center, atol=1e-12)
        np.testing.assert_allclose(link.inertia.about_center, before.inertia.about_center, atol=1e-12)
        assert [mesh.link_from_mesh.translation for mesh in link.meshes] == [
            pytest.approx(mesh.link_from_mesh.translation) for mesh in before.meshes
        ]


def test_a_link_of_solids_keeps_them_to_be_touched(clad: DesignProblem, tmp_path: Path) -> None:
    tree = clad.scene.robot.tree
    (mesh,) = tree.link_by_name["chest"].meshes
    links = tuple(replace(link, meshes=(mesh,)) if link.name == "l_forearm" else link for link in tree.links)
    both = replace(tree, links=links)
    names, contents = mesh_files(both, "meshes")
    assert names["l_forearm", 0] == names["chest", 0] == "meshes/chest.stl"
    model = mujoco.MjModel.from_xml_string(mjcf_text(both, 9.81, {}, names), assets=contents)
    forearm = [i for i in range(model.ngeom) if model.body(model.geom_bodyid[i]).name == "l_forearm"]
    assert [int(model.geom_conaffinity[i]) for i in forearm] == [0, 1]
    assert [int(model.geom_group[i]) for i in forearm] == [0, 3]


@pytest.mark.parametrize("thickness", [0.0, 1e-7])
def test_a_flat_mesh_is_seen_and_not_touched(clad: DesignProblem, thickness: float) -> None:
    tree = clad.scene.robot.tree
    corners = np.array([(0, 0, 0), (0.1, 0, 0), (0.1, 0.1, thickness), (0, 0.1, 0)])
    sheet = Mesh("../my sheet.v2.stl", surface=surface_of(corners, np.array([(0, 1, 2), (0, 2, 3)]), 0.0))
    assert not has_hull(sheet)
    other = replace(sheet, scale=(2.0, 1.0, 1.0))
    changed = {"chest": (sheet, other), "l_upper_arm": (sheet,)}
    links = tuple(replace(link, meshes=changed.get(link.name, link.meshes), solids=()) for link in tree.links)
    names, contents = mesh_files(replace(tree, links=links), "meshes")
    assert names["chest", 0] == names["l_upper_arm", 0] == "meshes/my_sheet_v2.stl"
    assert names["chest", 1] == "meshes/my_sheet_v2_2.stl"
    links = tuple(replace(link, meshes=changed.get(link.name, link.meshes)) for link in tree.links)
    model = mujoco.MjModel.from_xml_string(
        mjcf_text(replace(tree, links=links), 9.81, {}, names), assets=contents
    )
    sheets = [i for i in range(model.ngeom) if model.body(model.geom_bodyid[i]).name == "chest"]
    assert [int(model.geom_conaffinity[i]) for i in sheets] == [0, 0]
