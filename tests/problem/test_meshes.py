"""Meshes of a robot: where they are found, what is kept of them, and what a run from elsewhere may hold."""

from __future__ import annotations

import re
import shutil
from dataclasses import replace
from pathlib import Path

import msgspec
import numpy as np
import pytest
import trimesh

from evodesign.errors import InputError
from evodesign.problem import mesh_reading
from evodesign.problem.build import build_problem
from evodesign.problem.copied import copy_source
from evodesign.problem.mesh_reading import MOST_BYTES, read_mesh
from evodesign.problem.meshes import OF_ONE, MeshPlaces, kept_name, with_surfaces
from evodesign.problem.source import read_source
from evodesign.records import ProblemSource
from evodesign.tree.resize import resize
from evodesign.tree.surface import MOST_TRIANGLES, Surface, read_surface, surface_of, surface_text
from evodesign.tree.urdf_read import InertiaRule, read_urdf
from tests.problem.mesh_robot import ARM_SIZE, MESHES, PACKAGE, capsule, wedge, write_mesh_problem

ARM, THIGH = (MESHES[link][0] for link in ("l_upper_arm", "l_hip_3"))
WEDGE = ARM_SIZE[0] * ARM_SIZE[1] * ARM_SIZE[2] / 2.0


@pytest.fixture(scope="module")
def source(tmp_path_factory: pytest.TempPathFactory) -> ProblemSource:
    return read_source(write_mesh_problem(tmp_path_factory.mktemp("clad")))


def surface_in(source: ProblemSource, mesh: str) -> Surface:
    return read_surface(source.files[kept_name(mesh)], "p.toml", mesh)


def test_every_mesh_is_kept_once_small_and_close_to_the_file(source: ProblemSource) -> None:
    assert len(source.files) == 1 + len({name for name, _ in MESHES.values()})
    assert sum(map(len, source.files.values())) < 90_000
    arm, thigh = surface_in(source, ARM), surface_in(source, THIGH)
    found = {tuple(vertex) for vertex in np.round(arm.vertices, 2).tolist()}
    assert found == {tuple(vertex) for vertex in np.round(wedge().vertices, 2).tolist()}
    assert trimesh.Trimesh(arm.vertices, arm.faces).volume == pytest.approx(WEDGE * 1e9, rel=1e-4)
    fine = capsule()
    assert len(thigh.faces) == OF_ONE < len(fine.faces)
    assert thigh.volume == pytest.approx(fine.volume, rel=1e-5), "that of the file, not of what is kept"
    _, distances, _ = trimesh.proximity.closest_point(fine, thigh.vertices)
    assert distances.max() < 1e-3
    np.testing.assert_allclose(thigh.vertices.min(axis=0), fine.vertices.min(axis=0), atol=1e-3)


def test_a_copied_problem_needs_none_of_the_meshes_files(tmp_path: Path) -> None:
    path = write_mesh_problem(tmp_path / "here")
    source = read_source(path)
    copied, *_ = copy_source(source, tmp_path / "there")
    shutil.rmtree(tmp_path / "here")
    assert read_source(copied).files == source.files


def test_a_robot_is_built_of_what_its_problem_keeps_alone(source: ProblemSource) -> None:
    tree = build_problem(msgspec.structs.replace(source, path="nowhere/p.toml")).scene.robot.tree
    for link in tree.links:
        assert len(link.meshes) == (link.name in MESHES)
        assert all(mesh.surface for mesh in link.meshes)
    bare = {name: text for name, text in source.files.items() if not name.endswith(".json")}
    dense = source.text.partition("[[design.density]]")[0]
    old = build_problem(msgspec.structs.replace(source, files=bare, text=dense))
    assert all(mesh.surface is None for link in old.scene.robot.tree.links for mesh in link.meshes)


def test_a_link_of_a_watertight_mesh_has_its_volume_however_scaled_and_stretched(
    source: ProblemSource,
) -> None:
    tree = build_problem(source).scene.robot.tree
    for name in ("l_upper_arm", "r_upper_arm"):
        assert tree.link_by_name[name].volume == pytest.approx(WEDGE, rel=1e-6)
        longer = resize(tree, {name: 1.7}, {}).link_by_name[name]
        assert longer.volume == pytest.approx(1.7 * WEDGE, rel=1e-6)
        denser = resize(tree, {name: 1.7}, {name: 1234.0}).link_by_name[name]
        assert denser.inertia.mass == pytest.approx(1234.0 * 1.7 * WEDGE, rel=1e-6)
    arm = tree.link_by_name["l_upper_arm"]
    two = replace(arm, meshes=(*arm.meshes, *tree.link_by_name["l_hip_3"].meshes))
    assert two.volume == pytest.approx(WEDGE + capsule().volume, rel=1e-5)
    assert replace(two, meshes=(*two.meshes, *tree.link_by_name["chest"].meshes)).volume == 0


def test_a_mesh_that_encloses_nothing_has_no_density(tmp_path: Path) -> None:
    path = write_mesh_problem(tmp_path)
    text = path.read_text().replace(
        'name = "upper_arm"\nlinks = ["l_upper_arm", "r_upper_arm"]\nlower_kg',
        'name = "x"\nlinks = ["chest"]\nlower_kg',
    )
    path.write_text(text)
    with pytest.raises(
        InputError, match=r"density of link chest.* found a mesh without volume \(not watertight\)"
    ):
        build_problem(read_source(path))


def test_a_missing_mesh_is_told_with_its_link_and_what_to_do(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = write_mesh_problem(tmp_path / "here")
    meshes = tmp_path / "here" / PACKAGE / "meshes"
    meshes.rename(tmp_path / "away")
    with pytest.raises(InputError) as caught:
        read_source(path)
    for part in (
        "problem.toml: robot.urdf: ",
        "link chest",
        "[robot] packages",
        "meshes = false",
        str(meshes.parent),
    ):
        assert part in str(caught.value)
    text = path.read_text()
    path.write_text(text.replace("[robot]", "[robot]\nmeshes = false").partition("[[design.density]]")[0])
    assert len(read_source(path).files) == 1
    assert build_problem(read_source(path)).scene.robot.tree.link_by_name["chest"].meshes[0].surface is None


@pytest.mark.parametrize("scheme", ["package", "model"])
def test_packages_are_found_where_problem_environment_and_robot_say(tmp_path: Path, scheme: str) -> None:
    name, robot = f"{scheme}://clad/meshes/a.stl", tmp_path / "elsewhere" / "robot"
    nothing = MeshPlaces(robot, [], {})
    assert nothing.find(name) is None
    assert str(robot) in nothing.searched(name)
    for place, found in (
        (MeshPlaces(robot, [tmp_path / "a"], {}), "a/clad"),
        (MeshPlaces(robot, [tmp_path / "b" / "clad"], {}), "b/clad"),
        (MeshPlaces(robot, [], {"ROS_PACKAGE_PATH": f"/nowhere:{tmp_path / 'c'}"}), "c/clad"),
        (MeshPlaces(robot, [], {"AMENT_PREFIX_PATH": str(tmp_path / "d")}), "d/share/clad"),
        (MeshPlaces(tmp_path / "e" / "clad" / "urdf", [], {}), "e/clad"),
        (MeshPlaces(tmp_path / "f" / "robots" / "urdf", [], {}), "f/clad"),
    ):
        file = tmp_path / found / "meshes" / "a.stl"
        assert place.find(name) is None
        file.parent.mkdir(parents=True)
        file.touch()
        assert place.find(name) == file
    assert MeshPlaces(tmp_path, [], {}).find(f"file://{file}") == file
    assert MeshPlaces(file.parent, [], {}).find("../meshes/a.stl") == file.parent / "../meshes/a.stl"
    assert MeshPlaces(file.parent, [], {}).find("http://somewhere/a.stl") is None
    assert MeshPlaces(file.parent, [], {}).find("\0" + "x" * 5000) is None


@pytest.mark.parametrize(
    ("name", "content", "found"),
    [
        ("a.stl", b"", "a mesh of triangles"),
        ("a.stl", b"\0" * 80 + b"\xff\xff\xff\xff" + b"\0" * 50, "a mesh of triangles"),
        ("a.stl", b"solid a\nfacet normal 0 0 0\nouter loop\nvertex x y z", "a mesh of triangles"),
        ("a.dae", b"<COLLADA", "a mesh of triangles"),
        ("a.dae", b"<!DOCTYPE a [<!ENTITY b 'c'>]><COLLADA>&b;</COLLADA>", "a mesh of triangles"),
        ("a.obj", b"v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3", "a mesh of triangles"),
        ("a.obj", b"v 0 0 0\nv 1e300 0 0\nv 0 1 0\nf 1 2 3", "a mesh of triangles"),
        ("a.obj", b"v 0 0 0\nv 1 0 0\nf 1 2 9", "a mesh of triangles"),
        ("a.obj", b"v 0 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3", "a mesh of triangles"),
        ("a.ply", b"ply\nformat ascii 1.0\nelement vertex 999999999\n", "a mesh of triangles"),
        ("a.zip", b"PK", "a mesh file (.stl, .dae, .obj, .ply); [robot] meshes = false"),
    ],
)
def test_a_file_that_is_no_mesh_is_refused(tmp_path: Path, name: str, content: bytes, found: str) -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.raises(InputError) as caught:
        read_mesh(tmp_path / name, 1000, "p.toml", "robot.urdf, link chest")
    assert found in caught.value.wanted
    assert name in caught.value.found


@pytest.mark.parametrize("kind", ["stl", "dae", "obj", "ply"])
def test_a_spoilt_file_is_read_or_refused_with_a_sentence(tmp_path: Path, kind: str) -> None:
    rng, refused = np.random.default_rng(3), list[str]()
    path = tmp_path / f"a.{kind}"
    trimesh.creation.icosphere(1).export(path)
    whole = path.read_bytes()
    for _ in range(60):
        content = bytearray(whole[: int(rng.integers(len(whole) // 2, len(whole) + 1))])
        for place in rng.integers(len(content), size=int(rng.integers(0, 4))):
            content[place] = int(rng.integers(256))
        path.write_bytes(content)
        try:
            surface = read_mesh(path, 50, "p.toml", "robot.urdf")
            assert read_surface(surface_text(surface), "p.toml", "a") == surface
        except InputError as error:
            refused.append(str(error))
    assert len(refused) > 5
    assert all(sentence.isprintable() for sentence in refused)


def test_a_file_that_is_too_large_is_not_read_to_its_end(tmp_path: Path) -> None:
    path = tmp_path / "a.stl"
    with path.open("wb") as file:
        file.truncate(MOST_BYTES + 1)
    with pytest.raises(InputError, match="a file of at most"):
        read_mesh(path, 1000, "p.toml", "robot.urdf")


def test_a_mesh_is_simplified_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.ply"
    trimesh.creation.icosphere(4).export(path)
    first = read_mesh(path, 300, "p.toml", "robot.urdf")
    assert 200 < len(first.faces) <= 300

    def never(*_: object) -> None:
        raise AssertionError("worked out twice")

    monkeypatch.setattr(mesh_reading, "_simplified", never)
    path.rename(path.with_name("b.ply"))
    assert read_mesh(path.with_name("b.ply"), 300, "p.toml", "robot.urdf") == first


def test_many_small_pieces_become_few_triangles(tmp_path: Path) -> None:
    rng = np.random.default_rng(1)
    pieces = [trimesh.creation.box((0.01, 0.01, 0.01)) for _ in range(400)]
    for piece in pieces:
        piece.apply_translation(rng.uniform(size=3))
    path = tmp_path / "a.ply"
    trimesh.util.concatenate(pieces).export(path)
    surface = read_mesh(path, 500, "p.toml", "robot.urdf")
    assert 20 < len(surface.faces) <= 500
    assert surface.vertices.min() > -0.01
    assert surface.vertices.max() < 1.01


def test_surfaces_are_read_back() -> None:
    rng = np.random.default_rng(2)
    vertices, faces = rng.uniform(-1.0, 1.0, (30, 3)), rng.integers(0, 30, (50, 3))
    surface = surface_of(vertices, faces, 0.25)
    again = read_surface(surface_text(surface), "p.toml", "a")
    assert again == surface
    np.testing.assert_array_equal(again.faces, faces)
    np.testing.assert_allclose(again.vertices, vertices, atol=2.0 / 65535)


def test_a_robot_shows_no_more_triangles_than_can_be_exported(source: ProblemSource) -> None:
    """Of a run from elsewhere each link may show the largest mesh that is read."""
    largest = surface_of(np.eye(3), np.tile([0, 1, 2], (MOST_TRIANGLES, 1)), 0.0)
    links = [
        f'<link name="l{i}"><visual><geometry><mesh filename="{ARM}"/></geometry></visual></link>'
        for i in range(26)
    ]
    joints = [
        f'<joint name="j{i}" type="fixed"><parent link="l0"/><child link="l{i}"/></joint>'
        for i in range(1, 26)
    ]
    tree = read_urdf(f"<robot name='r'>{''.join([*links, *joints])}</robot>", "r.urdf", InertiaRule.AUTO)
    files = {kept_name(ARM): surface_text(largest)}
    with pytest.raises(InputError, match=r"at most 500000 triangles in all links.* found 520000"):
        with_surfaces(tree, files, "p.toml")
    fewer = replace(tree, links=tree.links[:25], joints=tree.joints[:24])
    assert all(link.shown for link in with_surfaces(fewer, files, "p.toml").links)


GOOD = surface_of(np.eye(3), np.array([[0, 1, 2]]), 0.0)
MANY = surface_of(np.eye(3), np.zeros((MOST_TRIANGLES + 1, 3), int), 0.0)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "[]",
        "[" * 100_000,
        '{"low": [0, 0, 1e999]}',
        surface_text(MANY),
        *(
            surface_text(msgspec.structs.replace(GOOD, **change))
            for change in (
                {"triangles": surface_of(np.eye(3), np.array([[0, 1, 3]]), 0.0).triangles},
                {"triangles": ""},
                {"triangles": "AAAA"},
                {"points": ""},
                {"points": "é"},
                {"volume": -1.0},
                {"volume": 1e300},
                {"low": (0.0, 0.0, 1e30)},
                {"step": (0.0, -1.0, 0.0)},
            )
        ),
    ],
)
def test_what_is_no_surface_is_refused(text: str, source: ProblemSource) -> None:
    hostile = msgspec.structs.replace(source, files={**source.files, kept_name(ARM): text})
    with pytest.raises(InputError, match=r"problem\.toml: meshes/arm-"):
        build_problem(hostile)


@pytest.mark.parametrize("lying", [False, True])
def test_meshes_with_y_up_are_turned_where_they_would_lie_beside_their_links(
    tmp_path: Path, lying: bool
) -> None:
    path = write_mesh_problem(tmp_path)
    dae = tmp_path / PACKAGE / "meshes" / "thigh.dae"
    thigh = capsule()
    thigh.apply_translation((0.0, 0.02, -0.3))
    if lying:
        thigh.vertices = thigh.vertices[:, [0, 2, 1]] * (1.0, 1.0, -1.0)
    thigh.export(dae)
    dae.write_text(re.sub("<up_axis>[^<]*", "<up_axis>Y_UP", dae.read_text()))
    urdf = tmp_path / PACKAGE / "urdf" / "clad.urdf"
    urdf.write_text(
        re.sub(
            r'(<link name="._hip_3">.*?<visual>\s*<origin xyz=)"[^"]*"',
            r'\1"0 0 0.25"',
            urdf.read_text(),
            flags=re.DOTALL,
        )
    )
    found = surface_in(read_source(path), THIGH)
    middle = (found.vertices.min(axis=0) + found.vertices.max(axis=0)) / 2.0
    np.testing.assert_allclose(middle, (0.0, 0.02, -0.3), atol=2e-3)
    assert found.volume == pytest.approx(capsule().volume, rel=1e-5)
