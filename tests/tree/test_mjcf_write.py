"""Exported robots in the libraries that people open them with: equal masses, equal kinematics.

URDF goes to pinocchio, MuJoCo and yourdfpy, MJCF to MuJoCo; each says where every link is in random postures.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from io import BytesIO

import mujoco
import numpy as np
import pinocchio
import pytest
import yourdfpy

from evodesign.body.placement import Placement, quaternion_wxyz
from evodesign.body.shape import Box, Cylinder, Shape, Solid, Sphere
from evodesign.errors import ModelError
from evodesign.mechanics.balance import GRAVITY
from evodesign.problem.build import DesignProblem
from evodesign.report.scene_models import looks_of
from evodesign.tree.frames import link_frames
from evodesign.tree.mjcf_write import KeyPosture, mjcf_text
from evodesign.tree.model import Joint, JointKind, Link, Tree
from evodesign.tree.urdf_write import urdf_text
from tests.oracles.pinocchio_model import floating_model
from tests.tree.crane import crane

TOLERANCE = 1e-9
Poses = Mapping[str, np.ndarray]


@dataclass(frozen=True)
class Case:
    """A robot in a posture."""

    tree: Tree
    posture: KeyPosture

    @classmethod
    def random(cls, tree: Tree, seed: int) -> Case:
        rng = np.random.default_rng(seed)
        joints = dict(zip(tree.actuated, rng.uniform(-1.5, 1.5, len(tree.actuated)).tolist(), strict=True))
        root = Placement.from_xyz_rpy(rng.normal(size=3).tolist(), rng.uniform(-1.4, 1.4, 3).tolist())
        return cls(tree, KeyPosture(root, joints))


def cases(problem: DesignProblem) -> Iterator[Case]:
    rng = np.random.default_rng(31)
    for seed in range(4):
        values = problem.space.values(tuple(rng.uniform(size=len(problem.space.parameters)).tolist()))
        yield Case.random(problem.space.resized(problem.scene.robot.tree, values), seed)
    yield Case.random(crane(), 9)


def matrix(rotation: object, origin: object) -> np.ndarray:
    whole = np.eye(4)
    whole[:3, :3], whole[:3, 3] = np.reshape(np.array(rotation), (3, 3)), np.ravel(origin)
    return whole


def in_pinocchio(case: Case) -> tuple[float, Poses]:
    model = floating_model(urdf_text(case.tree))
    data, q = model.createData(), pinocchio.neutral(model)
    place = case.posture.world_from_root
    w, x, y, z = quaternion_wxyz(place.rotation)
    q[:7] = [*place.translation, x, y, z, w]
    for name, position in case.posture.joints.items():
        joint = model.joints[model.getJointId(name)]
        turned = [position] if joint.nq == 1 else [np.cos(position), np.sin(position)]
        q[joint.idx_q : joint.idx_q + joint.nq] = turned
    pinocchio.framesForwardKinematics(model, data, q)
    frames = {
        frame.name: matrix(placement.rotation, placement.translation)
        for frame, placement in zip(model.frames, data.oMf, strict=True)
        if frame.type == pinocchio.FrameType.BODY
    }
    return pinocchio.computeTotalMass(model), frames


def in_yourdfpy(case: Case) -> tuple[float, Poses]:
    robot = yourdfpy.URDF.load(
        BytesIO(urdf_text(case.tree).encode()), build_scene_graph=True, load_meshes=False
    )
    robot.update_cfg(dict(case.posture.joints))
    root = matrix(case.posture.world_from_root.rotation, case.posture.world_from_root.translation)
    mass = sum(link.inertial.mass for link in robot.link_map.values() if link.inertial is not None)
    return mass, {name: root @ robot.get_transform(name, case.tree.root) for name in robot.link_map}


def from_urdf_in_mujoco(case: Case) -> tuple[float, Poses]:
    spec = mujoco.MjSpec.from_string(urdf_text(case.tree))
    spec.compiler.fusestatic = False
    spec.body(case.tree.root).add_freejoint()
    model = spec.compile()
    data = mujoco.MjData(model)
    place = case.posture.world_from_root
    data.qpos[:7] = [*place.translation, *quaternion_wxyz(place.rotation)]
    for name, position in case.posture.joints.items():
        data.qpos[model.joint(name).qposadr[0]] = position
    return told(case, model, data)


def from_mjcf_in_mujoco(case: Case) -> tuple[float, Poses]:
    model = mujoco.MjModel.from_xml_string(mjcf_text(case.tree, GRAVITY, {"held": case.posture}))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("held").id)
    return told(case, model, data)


def told(case: Case, model: mujoco.MjModel, data: mujoco.MjData) -> tuple[float, Poses]:
    mujoco.mj_kinematics(model, data)
    bodies = [model.body(number).name for number in range(1, model.nbody)]
    frames = {name: matrix(data.body(name).xmat, data.body(name).xpos) for name in bodies}
    return float(model.body_mass.sum()), frames


@pytest.mark.parametrize("reader", [in_pinocchio, in_yourdfpy, from_urdf_in_mujoco, from_mjcf_in_mujoco])
def test_masses_and_kinematics_are_equal_everywhere(
    reader: Callable[[Case], tuple[float, Poses]], problem: DesignProblem
) -> None:
    for case in cases(problem):
        mass, poses = reader(case)
        assert mass == pytest.approx(sum(link.inertia.mass for link in case.tree.links), abs=TOLERANCE)
        ours = link_frames(case.tree, case.posture.world_from_root, case.posture.joints)
        for name, place in ours.items():
            expected = matrix(place.rotation, place.translation)
            assert np.allclose(poses[name], expected, rtol=0.0, atol=TOLERANCE), name


def test_bodies_of_mjcf_have_the_inertia_of_their_links(problem: DesignProblem) -> None:
    for case in cases(problem):
        model = mujoco.MjModel.from_xml_string(mjcf_text(case.tree, GRAVITY, {}))
        for link in case.tree.links:
            body = model.body(link.name)
            assert body.mass[0] == pytest.approx(link.inertia.mass, abs=TOLERANCE)
            if link.inertia.mass:
                assert np.allclose(body.ipos, link.inertia.center, rtol=0.0, atol=TOLERANCE)
                axes = turned(body.iquat)
                moments = axes @ np.diag(body.inertia) @ axes.T
                assert np.allclose(moments, link.inertia.about_center, rtol=0.0, atol=TOLERANCE)


def test_geoms_are_the_shapes_of_the_links(problem: DesignProblem) -> None:
    for case in cases(problem):
        model = mujoco.MjModel.from_xml_string(mjcf_text(case.tree, GRAVITY, {}))
        shown = [(link.name, shape, place) for link in case.tree.links for shape, place in looks_of(link)]
        assert model.ngeom == len(shown) + 1, "and the ground"
        for name, shape, place in shown:
            assert any(
                model.geom(index).bodyid[0] == model.body(name).id
                and model.geom(index).type[0] == kind_of(shape)[0]
                and np.allclose(model.geom(index).size, kind_of(shape)[1])
                and np.allclose(model.geom(index).pos, place.translation)
                and np.allclose(turned(model.geom(index).quat), place.rotation)
                for index in range(model.ngeom)
            ), name


def kind_of(shape: Shape) -> tuple[int, list[float]]:
    match shape:
        case Sphere(radius):
            return mujoco.mjtGeom.mjGEOM_SPHERE, [radius, 0.0, 0.0]
        case Cylinder(radius, length):
            return mujoco.mjtGeom.mjGEOM_CYLINDER, [radius, length / 2.0, 0.0]
        case Box():
            return mujoco.mjtGeom.mjGEOM_BOX, [side / 2.0 for side in shape.sides]


def turned(quaternion: np.ndarray) -> np.ndarray:
    turn = np.zeros(9)
    mujoco.mju_quat2Mat(turn, quaternion)
    return turn.reshape(3, 3)


def test_mjcf_keeps_limits_and_efforts(problem: DesignProblem) -> None:
    tree = problem.scene.robot.tree
    model = mujoco.MjModel.from_xml_string(mjcf_text(tree, GRAVITY, {}))
    for name in tree.actuated:
        joint, found = tree.joint_by_name[name], model.joint(name)
        assert found.range.tolist() == pytest.approx([joint.lower, joint.upper])
        if np.isfinite(joint.effort):
            assert found.actfrcrange.tolist() == pytest.approx([-joint.effort, joint.effort])
    assert model.opt.gravity.tolist() == [0.0, 0.0, -GRAVITY]


def test_robot_stands_on_the_ground_and_does_not_touch_itself(problem: DesignProblem) -> None:
    robot = problem.scene.robot
    frames = link_frames(robot.tree, Placement(), {})
    lowest = min(frames[sole].translation[2] for sole in robot.foot_frames)
    standing = KeyPosture(Placement(translation=(0.0, 0.0, -lowest - 0.01)), {})
    model = mujoco.MjModel.from_xml_string(mjcf_text(robot.tree, GRAVITY, {"standing": standing}))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    assert data.ncon > 0
    ground = model.geom(0).id
    assert all(ground in (contact.geom1, contact.geom2) for contact in data.contact)


def test_names_are_kept_as_they_are() -> None:
    solid = Solid(Box(0.1, 0.1, 0.1), Placement(), 1000.0)
    links = (Link("<script>&\"'", (solid,)), Link("../x", (solid,)))
    joint = Joint("a b<", JointKind.REVOLUTE, links[0].name, "../x", Placement(), lower=-1.0, upper=1.0)
    model = mujoco.MjModel.from_xml_string(
        mjcf_text(Tree("<r>", links, (joint,)), GRAVITY, {"1 m": KeyPosture(Placement(), {})})
    )
    assert [model.body(index).name for index in (1, 2)] == [links[0].name, "../x"]
    assert model.joint(1).name == "a b<"
    assert model.key(0).name == "1 m"


def test_links_that_only_lie_between_joints_are_joints_of_one_body(problem: DesignProblem) -> None:
    tree = problem.scene.human.tree
    case = Case.random(tree, 5)
    mass, poses = from_mjcf_in_mujoco(case)
    assert mass == pytest.approx(sum(link.inertia.mass for link in tree.links), abs=TOLERANCE)
    assert {link.name for link in tree.links if link.inertia.mass} <= set(poses) < set(tree.link_by_name)
    ours = link_frames(tree, case.posture.world_from_root, case.posture.joints)
    for name, pose in poses.items():
        expected = matrix(ours[name].rotation, ours[name].translation)
        np.testing.assert_allclose(pose, expected, rtol=0.0, atol=TOLERANCE)


def test_link_that_moves_without_mass_is_refused_by_name() -> None:
    links = (Link("body", (Solid(Sphere(0.1), Placement(), 1000.0),)), Link("flag"))
    joint = Joint("mast", JointKind.REVOLUTE, "body", "flag", Placement(), lower=-1.0, upper=1.0)
    with pytest.raises(ModelError, match="flag: wanted mass, which MuJoCo asks of every link that moves"):
        mjcf_text(Tree("robot", links, (joint,)), GRAVITY, {})


def test_link_called_world_is_refused() -> None:
    solid = Solid(Box(0.1, 0.1, 0.1), Placement(), 1000.0)
    with pytest.raises(ModelError, match="link world"):
        mjcf_text(Tree("robot", (Link("world", (solid,)),), ()), GRAVITY, {})
