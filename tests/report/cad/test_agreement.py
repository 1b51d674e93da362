"""STEP files of designs, read back, weigh what pinocchio reads from the URDF; another library opens them."""

from __future__ import annotations

from pathlib import Path

import cascadio
import numpy as np
import pinocchio
import pytest
import trimesh
from OCP.BRep import BRep_Tool
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopoDS import TopoDS

from evodesign.report.cad.agreement import agreements
from evodesign.report.cad.folder import cad_files
from evodesign.report.cad.parts import parts_of
from evodesign.report.cad.seats import seated_links
from evodesign.tree.equip import actuators_of
from evodesign.tree.model import Tree
from tests.report.cad.reread import Part, explored, measured, parts_in
from tests.report.cad.robots import axes_at_zero, designed, frames_at_zero, in_pinocchio

pytestmark = pytest.mark.slow

WITHIN = 0.02
"""By how much STEP files and URDF may differ; without seats they differ by less than 1e-6."""

STAMP = "2024-01-01T00:00:00"


ROBOTS = [("icub_lifting", 7), ("icub_geometry", 5, (2.0, 12.0))]


@pytest.fixture(scope="module", params=ROBOTS, ids=lambda each: each[0])
def robot(request: pytest.FixtureRequest, repository: Path) -> tuple[Tree, dict[str, bytes]]:
    tree, materials = designed(repository, *request.param)
    return tree, cad_files(tree, materials, "a design", STAMP)


@pytest.fixture(scope="module")
def assembly(robot: tuple[Tree, dict[str, bytes]]) -> dict[str, Part]:
    return parts_in(robot[1]["assembly.step"])


def inertia_of(part: Part, mass: float) -> pinocchio.Inertia:
    """Of a mass [kg] that fills a body evenly."""
    volume, center, about_center = measured(part.body)
    return pinocchio.Inertia(mass, center, about_center * (mass / volume))


def test_links_read_back_weigh_what_the_urdf_says(robot: tuple[Tree, dict[str, bytes]]) -> None:
    """Walls at their density from STEP, filling over the outer shape, motors as the mass model has them.

    Bodies that one joint carries are compared together, as pinocchio welds them. What seats add to the walls
    is taken from the filling.
    """
    tree, files = robot
    seated = {name for name, link in seated_links(parts_of(tree, {})).items() if link.seats}
    joints = set()
    model = in_pinocchio(tree)
    found = [pinocchio.Inertia.Zero() for _ in model.joints]
    for frame in (each for each in model.frames if each.type == pinocchio.FrameType.BODY):
        link = tree.link_by_name[frame.name]
        if not link.solids:
            assert link.mass == 0.0
            continue
        (solid,), (part,) = link.solids, parts_in(files[f"{link.name}.step"]).values()
        assert BRepCheck_Analyzer(part.body).IsValid()
        shells = explored(part.body, TopAbs_ShapeEnum.TopAbs_SHELL)
        volume, *_ = measured(part.body)
        if frame.name in seated:
            joints.add(frame.parentJoint)
        else:
            assert len(shells) == (1 if solid.wall is None else 2)  # outside and cavity
        bodies = [inertia_of(part, float(solid.density) * volume)]
        place = pinocchio.SE3(
            np.array(solid.link_from_solid.rotation), np.array(solid.link_from_solid.translation)
        )
        seats = float(solid.mass - solid.filling - solid.density * volume) if frame.name in seated else 0.0
        filling = float(solid.filling) + seats
        outer = solid.shape.moments(filling)
        bodies.append(place.act(pinocchio.Inertia(filling, np.zeros(3), np.diag(outer))))
        for held in link.mounted:
            own = pinocchio.Inertia(
                float(held.mass), np.zeros(3), np.diag(held.shape.moments(float(held.mass)))
            )
            turn, center = np.array(held.link_from_solid.rotation), np.array(held.link_from_solid.translation)
            bodies.append(pinocchio.SE3(turn.astype(float), center.astype(float)).act(own))
        for body in bodies:
            found[frame.parentJoint] = found[frame.parentJoint] + frame.placement.act(body)
    compared = 0
    for number, (mine, urdf) in enumerate(zip(found, model.inertias, strict=True)):
        if urdf.mass > 0.0:
            compared += 1
            assert mine.mass == pytest.approx(urdf.mass, rel=1e-6)
            off = np.linalg.norm(mine.inertia - urdf.inertia) / np.linalg.norm(urdf.inertia)
            assert off < (WITHIN if number in joints else 1e-6)  # a wall thicker by 1e-7 m has more
            assert np.linalg.norm(mine.lever - urdf.lever) < (4e-3 if number in joints else 1e-4)
    assert compared > 20


def test_every_link_motor_and_axis_is_a_product_at_its_place(
    robot: tuple[Tree, dict[str, bytes]], assembly: dict[str, Part]
) -> None:
    tree, _ = robot
    model = in_pinocchio(tree)
    frames, axes = frames_at_zero(model), axes_at_zero(model)
    links = {link.name for link in tree.links if link.solids}
    motors = actuators_of(tree)
    assert len(motors) == 25
    assert set(assembly) == links | {f"motor_{name}" for name in motors} | {f"axis_{name}" for name in axes}
    for name in links:
        np.testing.assert_allclose(assembly[name].place[:3, :3], frames[name].rotation, atol=1e-9)
        np.testing.assert_allclose(assembly[name].place[:3, 3], 1000.0 * frames[name].translation, atol=1e-6)
    for name, (point, direction) in axes.items():
        start, end = ends_of(assembly[f"axis_{name}"])
        np.testing.assert_allclose((start + end) / 2.0, 1000.0 * point, atol=1e-6)
        np.testing.assert_allclose(end - start, 200.0 * direction, atol=1e-5)
    for name, actuator in motors.items():
        part, (point, direction) = assembly[f"motor_{name}"], axes[name]
        volume, center, about_center = measured(part.body)
        diameter, length = (float(each) for each in actuator.size)
        assert volume == pytest.approx(np.pi / 4.0 * diameter**2 * length, rel=1e-9)
        np.testing.assert_allclose(center, 0.0, atol=1e-9)
        share = 0.0 if actuator.mounting is None else actuator.mounting.share
        middle = point + share * length * direction
        np.testing.assert_allclose(part.place[:3, 3], 1000.0 * middle, atol=1e-6)
        turn = part.place[:3, :3]
        along = direction @ turn @ about_center @ turn.T @ direction
        assert along == pytest.approx(volume * diameter**2 / 8.0, rel=1e-9)


def ends_of(axis: Part) -> list[np.ndarray]:
    """Both ends of an edge in the assembly's frame [mm]."""
    (edge,) = explored(axis.body, TopAbs_ShapeEnum.TopAbs_EDGE)
    vertices = explored(edge, TopAbs_ShapeEnum.TopAbs_VERTEX)
    points = [BRep_Tool.Pnt_s(TopoDS.Vertex(each)) for each in vertices]
    return [axis.place[:3, :3] @ [p.X(), p.Y(), p.Z()] + axis.place[:3, 3] for p in points]


def test_another_library_sees_the_same_assembly(robot: tuple[Tree, dict[str, bytes]], tmp_path: Path) -> None:
    """cascadio and trimesh: names, places and volumes of the STEP file, and those of the STL files."""
    tree, files = robot
    (tmp_path / "robot.step").write_bytes(files["assembly.step"])
    cascadio.step_to_glb(str(tmp_path / "robot.step"), str(tmp_path / "robot.glb"), 0.05, 0.1)
    scene = trimesh.load(tmp_path / "robot.glb")
    frames = frames_at_zero(in_pinocchio(tree))
    links = [link for link in tree.links if link.solids]
    assert len(links) == 42
    for link in links:
        place, name = scene.graph[link.name]
        mesh = scene.geometry[name]
        volume, *_ = measured(parts_in(files[f"{link.name}.step"])[link.name].body)
        assert mesh.volume == pytest.approx(volume, rel=5e-3)
        np.testing.assert_allclose(place, frames[link.name].homogeneous, atol=1e-6)
        (tmp_path / "link.stl").write_bytes(files[f"{link.name}.stl"])
        alone = trimesh.load(tmp_path / "link.stl")
        assert alone.is_watertight
        assert alone.volume == pytest.approx(1e9 * volume, rel=1e-3)
        np.testing.assert_allclose(alone.bounds, 1000.0 * mesh.bounds, atol=0.15)


def test_the_readme_tells_every_link_with_its_difference(robot: tuple[Tree, dict[str, bytes]]) -> None:
    tree, files = robot
    readme = files["README.md"].decode()
    parts = parts_of(tree, {})
    compared = agreements(parts, seated := seated_links(parts))
    for name, each in compared.items():
        assert abs(each.mass_difference) < 1e-9
        assert each.shared == 0.0
        if not seated[name].seats:
            assert each.center_difference < 1e-9
            assert each.inertia_difference < 1e-6
        assert f"| `{name}` | {each.drawn.mass:.4f} | {each.urdf.mass:.4f} | 0.000 |" in readme
    assert sum(float(each.urdf.mass) for each in compared.values()) == pytest.approx(float(tree.mass))
    worst = max(compared, key=lambda name: compared[name].housed_difference)
    if any(each.mounting is not None for each in actuators_of(tree).values()):
        assert 1e-6 < compared[worst].housed_difference < 0.03  # of one link by itself, with seats
    else:
        assert compared[worst].housed_difference > WITHIN  # a ball is no motor, and the README says so
    assert f"with housings {100.0 * compared[worst].housed_difference:.3f} % (`{worst}`)" in readme
    assert "aluminium_6061" in readme
