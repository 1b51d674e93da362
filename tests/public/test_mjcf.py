"""A public humanoid that MuJoCo itself writes as MJCF, read again: the robot of its URDF.

MuJoCo writes six digits of every number, by as much the two may differ.
"""

from __future__ import annotations

import re
from pathlib import Path

import mujoco
import numpy as np
import pinocchio
import pytest

from evodesign.body.placement import Placement
from evodesign.guess.problem_text import guessed_problem
from evodesign.tree.frames import link_frames
from evodesign.tree.mjcf_read import translated
from evodesign.tree.model import Tree
from evodesign.tree.urdf_read import InertiaRule, read_urdf
from evodesign.tree.urdf_write import urdf_text
from tests.oracles.pinocchio_model import floating_model
from tests.robots import HUMANOIDS, SHARED

POSTURES, DIGITS = 20, 2e-5

pytestmark = pytest.mark.needs_robots


@pytest.fixture(scope="module")
def original() -> Tree:
    return read_urdf(HUMANOIDS["g1"].read_text(encoding="utf-8"), "g1", InertiaRule.FILE)


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The G1 as MuJoCo writes it; its mesh files stay where they are."""
    text = re.sub('package://[^"]*/', "", HUMANOIDS["g1"].read_text(encoding="utf-8"))
    meshes = SHARED / "g1_description" / "meshes"
    compiler = f'<mujoco><compiler discardvisual="false" fusestatic="false" meshdir="{meshes}"/></mujoco>'
    spec = mujoco.MjSpec.from_string(re.sub("(<robot [^>]*>)", rf"\1{compiler}", text, count=1))
    spec.body("pelvis").add_freejoint()
    for geom in spec.geoms:  # hulls of meshes that touch take seconds
        if geom.type == mujoco.mjtGeom.mjGEOM_MESH:
            geom.contype = geom.conaffinity = 0
    spec.compile()
    path = tmp_path_factory.mktemp("g1") / "g1.xml"
    path.write_text(spec.to_xml())
    return path


@pytest.fixture(scope="module")
def tree(file: Path) -> Tree:
    return read_urdf(translated(file, "g1.xml").urdf, "g1.xml", InertiaRule.FILE)


def test_it_has_the_links_joints_limits_and_meshes_of_its_urdf(original: Tree, tree: Tree) -> None:
    assert set(tree.link_by_name) == set(original.link_by_name)
    assert tree.root == original.root
    assert sorted(tree.actuated) == sorted(original.actuated)
    for name in original.actuated:
        ours, its = tree.joint_by_name[name], original.joint_by_name[name]
        assert (ours.kind, ours.parent, ours.child) == (its.kind, its.parent, its.child)
        found = (ours.lower, ours.upper, ours.effort, *ours.axis)
        assert found == pytest.approx((its.lower, its.upper, its.effort, *its.axis), rel=DIGITS, abs=DIGITS)
    for link in original.links:
        assert {Path(mesh.file).stem.lower() for mesh in link.meshes} <= {
            Path(mesh.file).stem.lower() for mesh in tree.link_by_name[link.name].meshes
        }


def test_masses_centres_and_tensors_are_those_of_its_urdf(original: Tree, tree: Tree) -> None:
    for link in original.links:
        ours, its = tree.link_by_name[link.name].inertia, link.inertia
        assert ours.mass == pytest.approx(its.mass, rel=DIGITS)
        np.testing.assert_allclose(ours.center, its.center, atol=DIGITS)
        largest = np.abs(its.about_center).max()
        np.testing.assert_allclose(ours.about_center, its.about_center, atol=DIGITS * max(largest, 1e-9))


def test_frames_and_torques_against_gravity_are_those_of_its_urdf_and_of_mujoco(
    original: Tree, tree: Tree, file: Path
) -> None:
    rng = np.random.default_rng(1)
    model = mujoco.MjModel.from_xml_path(str(file))
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    data = mujoco.MjData(model)
    ours, its = (floating_model(urdf_text(each)) for each in (tree, original))
    for _ in range(POSTURES):
        joints = {name: float(rng.uniform(-1.0, 1.0)) for name in tree.actuated}
        place = Placement.from_xyz_rpy(rng.normal(size=3).tolist(), rng.uniform(-1.4, 1.4, 3).tolist())
        frames, original_frames = (link_frames(each, place, joints) for each in (tree, original))
        for name, frame in frames.items():
            np.testing.assert_allclose(
                (*frame.translation, *np.ravel(frame.rotation)),
                (*original_frames[name].translation, *np.ravel(original_frames[name].rotation)),
                atol=DIGITS,
            )
        data.qpos[:3] = place.translation
        mujoco.mju_mat2Quat(data.qpos[3:7], np.array(place.rotation).ravel())
        for name, position in joints.items():
            data.qpos[model.joint(name).qposadr[0]] = position
        mujoco.mj_forward(model, data)
        torques = {name: data.qfrc_bias[model.joint(name).dofadr[0]] for name in joints}
        assert gravity_torques(ours, place, joints) == pytest.approx(torques, abs=1e-9)
        assert gravity_torques(its, place, joints) == pytest.approx(torques, abs=1e3 * DIGITS)


def gravity_torques(model: pinocchio.Model, place: Placement, joints: dict[str, float]) -> dict[str, float]:
    q = pinocchio.neutral(model)
    q[:7] = [*place.translation, *pinocchio.Quaternion(np.array(place.rotation)).coeffs()]
    for name, position in joints.items():
        q[model.joints[model.getJointId(name)].idx_q] = position
    torques = pinocchio.computeGeneralizedGravity(model, model.createData(), q)
    return {name: float(torques[model.joints[model.getJointId(name)].idx_v]) for name in joints}


def test_the_same_problem_is_guessed_for_it(original: Tree, tree: Tree) -> None:
    ours, its = (guessed_problem(each, "robot").guesses for each in (tree, original))
    assert {each.key: each.found for each in ours} == {each.key: each.found for each in its}
