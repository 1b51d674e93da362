"""Robots read from MJCF: MuJoCo's own figures of the same file are what the tree must have.

Places of bodies and sites, and torques against gravity, are those of MuJoCo in random postures; the tree's
torques are pinocchio's.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np
import pinocchio
import pytest

from evodesign.body.placement import Placement
from evodesign.body.shape import Box, Cylinder, Shape, Sphere
from evodesign.errors import ModelError
from evodesign.problem.agent_tables import RobotTable
from evodesign.problem.meshes import kept_name, mesh_texts, with_surfaces
from evodesign.tree.frames import link_frames
from evodesign.tree.mesh_write import vertices_of
from evodesign.tree.mjcf_read import TranslatedRobot, is_mjcf, translated
from evodesign.tree.model import JointKind, Tree
from evodesign.tree.triangulation import capsule, ellipsoid, scaled_surface
from evodesign.tree.urdf_read import InertiaRule, read_urdf
from evodesign.tree.urdf_write import urdf_text
from tests.oracles.pinocchio_model import floating_model
from tests.tree.small_mjcf import ROBOT, write_small_mjcf

POSTURES = 20


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_small_mjcf(tmp_path_factory.mktemp("small"))


@pytest.fixture(scope="module")
def robot(file: Path) -> TranslatedRobot:
    return translated(file, file.name)


@pytest.fixture(scope="module")
def tree(robot: TranslatedRobot) -> Tree:
    return read_urdf(robot.urdf, "small.xml", InertiaRule.FILE)


@dataclass(frozen=True)
class Posed:
    """MuJoCo's model in a random posture, in which its coupled joints are where the tree locks them."""

    model: mujoco.MjModel
    data: mujoco.MjData
    world_from_root: Placement
    joints: dict[str, float]


def posed(file: Path, tree: Tree, locked: dict[str, float], rng: np.random.Generator) -> Posed:
    model = mujoco.MjModel.from_xml_path(str(file))
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_EQUALITY
    model.body_gravcomp[:] = 0.0
    data = mujoco.MjData(model)
    joints = {name: float(rng.uniform(-1.0, 1.0)) for name in tree.actuated}
    place = Placement.from_xyz_rpy(rng.normal(size=3).tolist(), rng.uniform(-1.4, 1.4, 3).tolist())
    trunk = link_frames(tree, place, {})["trunk"]
    data.qpos[:3] = trunk.translation
    mujoco.mju_mat2Quat(data.qpos[3:7], np.array(trunk.rotation).ravel())
    for name, position in {**joints, **locked}.items():
        data.qpos[model.joint(name).qposadr[0]] = position
    mujoco.mj_forward(model, data)
    return Posed(model, data, place, joints)


LOCKED = {"finger": math.radians(5.0) + 0.1, "nail": 0.2}
"""With the wrist at zero: reference and constant coefficient."""


def test_bodies_and_sites_stand_where_mujoco_puts_them(file: Path, tree: Tree) -> None:
    rng = np.random.default_rng(1)
    for _ in range(POSTURES):
        case = posed(file, tree, LOCKED, rng)
        frames = link_frames(tree, case.world_from_root, case.joints)
        bodies = [case.model.body(body).name for body in range(1, case.model.nbody)]
        for theirs in (*(case.data.body(name) for name in bodies if name != "crate"), case.data.site("palm")):
            ours = frames[theirs.name]
            np.testing.assert_allclose(ours.translation, theirs.xpos, atol=1e-12)
            np.testing.assert_allclose(np.array(ours.rotation).ravel(), theirs.xmat, atol=1e-12)


def test_the_root_has_the_axes_of_the_world(file: Path, tree: Tree) -> None:
    assert tree.root == "trunk_upright"
    model = mujoco.MjModel.from_xml_path(str(file))
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    ours = link_frames(tree, Placement(), {})["trunk"]
    np.testing.assert_allclose(np.array(ours.rotation).ravel(), data.body("trunk").xmat, atol=1e-12)


def test_torques_against_gravity_and_masses_are_those_of_mujoco(file: Path, tree: Tree) -> None:
    rng = np.random.default_rng(2)
    model = floating_model(urdf_text(tree))
    data = model.createData()
    for _ in range(POSTURES):
        case = posed(file, tree, LOCKED, rng)
        robot_mass = case.model.body("trunk").subtreemass[0]
        assert pinocchio.computeTotalMass(model) == pytest.approx(robot_mass, rel=1e-12)
        q = pinocchio.neutral(model)
        quaternion = pinocchio.Quaternion(np.array(case.world_from_root.rotation))
        q[:7] = [*case.world_from_root.translation, *quaternion.coeffs()]
        for name, position in case.joints.items():
            joint = model.joints[model.getJointId(name)]
            turned = [position] if joint.nq == 1 else [math.cos(position), math.sin(position)]
            q[joint.idx_q : joint.idx_q + joint.nq] = turned
        torques = pinocchio.computeGeneralizedGravity(model, data, q)
        for name in case.joints:
            theirs = case.data.qfrc_bias[case.model.joint(name).dofadr[0]]
            ours = torques[model.joints[model.getJointId(name)].idx_v]
            assert ours == pytest.approx(theirs, abs=1e-9), name
            assert abs(theirs) > 1e-9 or name == "spin"


def test_tensors_of_links_are_those_that_mujoco_infers_from_geoms(file: Path, tree: Tree) -> None:
    model = mujoco.MjModel.from_xml_path(str(file))
    for link in tree.links:
        if link.inertia.mass:
            theirs = np.sort(model.body(link.name).inertia)
            ours = np.linalg.eigvalsh(np.array(link.inertia.about_center))
            np.testing.assert_allclose(ours, theirs, rtol=1e-9, atol=1e-15)


def test_limits_efforts_and_kinds(tree: Tree) -> None:
    def of(name: str) -> tuple[JointKind, float, float, float]:
        joint = tree.joint_by_name[name]
        return joint.kind, math.degrees(joint.lower), math.degrees(joint.upper), joint.effort

    assert of("shoulder_pitch") == (JointKind.REVOLUTE, *map(pytest.approx, (-90.0, 120.0, 30.0)))
    assert of("shoulder_roll") == (JointKind.REVOLUTE, *map(pytest.approx, (-20.0, 170.0, 35.0)))
    assert of("spin") == (JointKind.CONTINUOUS, -math.inf, math.inf, 6.0)
    wrist = tree.joint_by_name["wrist"]
    assert (wrist.kind, wrist.lower, wrist.upper) == (JointKind.PRISMATIC, -0.05, 0.08)
    assert math.isinf(wrist.effort), "of two actuators one has no limit"


def test_several_joints_of_a_body_and_anchors_elsewhere_lie_between_links_without_mass(tree: Tree) -> None:
    chain, link = [], "palm"
    while link != "trunk":
        chain.append(link)
        link = tree.parent_joint[link].parent
    assert [(name, bool(tree.link_by_name[name].inertia.mass)) for name in reversed(chain)] == [
        ("arm_below_shoulder_pitch", False),
        ("arm_below_shoulder_roll", False),
        ("arm", True),
        ("hand", True),
        ("palm", False),
    ]


def test_what_a_tree_does_not_have_is_told(tree: Tree) -> None:
    assert set(tree.notes) == {
        "no part of the robot, and left out: crate",
        "locked where an equality holds them: nail",
        "what these equalities tie together moves freely: loop",
        "no actuator acts directly on: finger, nail",
        "weights that MuJoCo compensates count nevertheless: spinner",
        "damping, friction and armature of joints are not counted: "
        "shoulder_pitch, shoulder_roll, wrist and 2 more",
        "locked where they are while the joints that they mimic are at zero: finger",
    }


def test_an_equality_that_follows_a_joint_with_a_reference_is_locked_where_mujoco_puts_it(
    tmp_path: Path,
) -> None:
    text = """<mujoco><compiler angle="radian"/><worldbody><body name="a"><geom size="1"/>
      <body name="b"><joint name="b" axis="1 0 0" ref="0.3"/><geom size="1"/></body>
      <body name="c"><joint name="c" axis="0 1 0" ref="-0.2"/><geom size="1"/></body></body></worldbody>
      <equality><joint joint1="b" joint2="c" polycoef="0.1 1.5 0.7 0 0"/></equality></mujoco>"""
    (tmp_path / "a.xml").write_text(text)
    tree = read_urdf(translated(tmp_path / "a.xml", "a.xml").urdf, "a.xml", InertiaRule.FILE)
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)

    def residual(b: float) -> float:
        data.qpos[:] = [b, 0.0]
        mujoco.mj_forward(model, data)
        return float(data.efc_pos[0])

    locked = 0.3 + 0.1 + 1.5 * 0.2 + 0.7 * 0.2**2
    assert residual(locked) == pytest.approx(0.0, abs=1e-12)
    data.qpos[:] = [locked, 0.0]
    mujoco.mj_kinematics(model, data)
    ours = link_frames(tree, Placement(), {})["b"]
    np.testing.assert_allclose(np.array(ours.rotation).ravel(), data.body("b").xmat, atol=1e-12)


def test_geoms_that_are_shown_are_visuals_and_those_that_touch_collisions(
    robot: TranslatedRobot, tree: Tree
) -> None:
    meshes = {link.name: [mesh.file.split("_")[0] for mesh in link.meshes] for link in tree.links}
    assert meshes["trunk"] == ["wedge.stl"], "shapes that touch do not stand beside a mesh that does not"
    assert meshes["arm"] == ["capsule"]
    assert meshes["hand"] == ["ellipsoid", "sphere"]
    assert meshes["spinner"] == []
    looks = {link.name: [type(look.shape) for look in link.looks] for link in tree.links}
    assert looks["spinner"] == [Cylinder, Box]
    assert looks["trunk"] == [Box, Cylinder], "stand for the mesh where that is left out"
    assert sorted(name.split("_")[0] for name in robot.meshes) == [
        *("capsule",) * 3,
        "ellipsoid",
        "wedge.stl",
    ]


def test_meshes_lie_as_the_file_says(robot: TranslatedRobot, tree: Tree, tmp_path: Path) -> None:
    texts = mesh_texts(RobotTable(urdf="small.xml"), tmp_path / "small.xml", robot, tmp_path, "p.toml")
    assert set(texts) == {kept_name(name) for name in robot.meshes}
    seen = with_surfaces(tree, texts, "p.toml")
    (mesh,) = seen.link_by_name["trunk"].meshes
    scaled = np.array([[0.0, 0.0, 0.0], [0.2, 0.0, 0.0], [0.0, -0.2, 0.0], [0.0, 0.0, 0.3]])
    turned = scaled @ np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]).T + [0.1, 0.0, 0.0]
    found = vertices_of(mesh)
    for vertex in turned:
        assert np.linalg.norm(found - vertex, axis=1).min() < 1e-5
    assert len(found) == 4
    assert mesh.volume == pytest.approx(0.2 * 0.2 * 0.3 / 6.0, rel=1e-4)
    arm = vertices_of(seen.link_by_name["arm"].meshes[0])
    along = np.array([0.02, 0.01, -0.3])
    share = np.clip(arm @ along / (along @ along), 0.0, 1.0)
    np.testing.assert_allclose(np.linalg.norm(arm - share[:, None] * along, axis=1), 0.04, atol=1e-4)


@pytest.mark.parametrize(
    ("spoilt", "words"),
    [
        (ROBOT[:-60], "small.xml: wanted an MJCF file that MuJoCo compiles, found XML parse error"),
        (ROBOT.replace("arm.xml", "nowhere.xml"), "found XML Error: Error opening file 'nowhere.xml'"),
        (ROBOT.replace('mesh="wedge"', 'mesh="wedgie"'), "mesh 'wedgie' not found"),
        (
            ROBOT.replace('name="spin" axis="0 0 1"', 'name="spin" type="ball"'),
            "joint spin: wanted hinges and slides (three hinges turn as a ball joint does), found a ball",
        ),
        (
            ROBOT.replace("<freejoint/>", '<freejoint/><body><joint/><geom size="1"/></body>'),
            "worldbody: wanted one body that carries others on hinges or slides, found 'trunk', 'crate'",
        ),
        (
            "<mujoco><worldbody><body><freejoint/><geom size='1'/></body></worldbody></mujoco>",
            "worldbody: wanted one body that carries others on hinges or slides, found none",
        ),
    ],
    ids=["syntax", "include", "mesh", "ball", "two robots", "no robot"],
)
def test_what_cannot_be_read_is_told_in_a_sentence(spoilt: str, words: str, tmp_path: Path) -> None:
    write_small_mjcf(tmp_path).write_text(spoilt)
    with pytest.raises(ModelError) as caught:
        translated(tmp_path / "small.xml", "small.xml")
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("<mujoco/>", True),
        ('\ufeff<?xml version="1.0"?>\n<!-- <robot> -->\n <mujoco model="a">', True),
        ("<mujocoinclude/>", False),
        ("<!-- <mujoco> --><robot/>", False),
        ("<!--" * 100_000, False),
    ],
)
def test_the_outermost_element_says_what_a_file_is(text: str, told: bool) -> None:
    assert is_mjcf(text) is told


@pytest.mark.parametrize(
    "shape", [Sphere(0.2), Cylinder(0.1, 0.5), Box(0.1, 0.2, 0.3)], ids=lambda s: type(s).__name__
)
def test_triangles_of_a_shape_are_closed_and_enclose_it_from_outside(shape: Shape) -> None:
    _, surface, factors = scaled_surface(shape)
    exact = surface.volume * math.prod(factors)
    assert exact == pytest.approx(float(shape.volume), rel=1e-12)
    enclosed = volume(surface.vertices * factors, surface.faces)
    assert 0.97 * exact < enclosed < exact * (1.0 + 1e-4)


def test_capsules_and_ellipsoids_have_their_volume() -> None:
    whole = math.pi * 0.1**2 * 0.5 + 4.0 / 3.0 * math.pi * 0.1**3
    assert 0.98 * whole < volume(*capsule(0.1, 0.5)) < whole
    whole = 4.0 / 3.0 * math.pi * 0.1 * 0.2 * 0.3
    assert 0.97 * whole < volume(*ellipsoid(0.1, 0.2, 0.3)) < whole


def volume(vertices: np.ndarray, faces: np.ndarray) -> float:
    """By the divergence theorem; the two triangles of an edge must run along it in opposite ways."""
    edges = np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    assert len(np.unique(edges, axis=0)) == len(edges)
    assert {tuple(edge) for edge in edges.tolist()} == {(b, a) for a, b in edges.tolist()}
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)
