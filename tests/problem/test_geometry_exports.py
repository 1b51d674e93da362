"""Random designs of joints, sections and mounted actuators: URDF in pinocchio, MJCF in MuJoCo, the tree."""

from __future__ import annotations

import mujoco
import numpy as np
import pinocchio as pin
import pytest

from evodesign.body.placement import Placement
from evodesign.mechanics.balance import GRAVITY
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.shipped import SHIPPED
from evodesign.problem.source import read_source
from evodesign.tree.frames import link_frames
from evodesign.tree.mjcf_write import mjcf_text
from evodesign.tree.model import JointKind, Tree
from evodesign.tree.urdf_write import urdf_text

DESIGNS = 50


@pytest.fixture(scope="module")
def geometry() -> DesignProblem:
    return build_problem(read_source(SHIPPED / "icub_geometry.toml"))


def random_tree(problem: DesignProblem, rng: np.random.Generator) -> Tree:
    space = problem.space
    values = space.values(tuple(rng.uniform(size=len(space.parameters)).tolist()))
    rated = {each.name: float(rng.uniform(3.0, 60.0)) for each in space.parameters if each.joints}
    return space.resized(problem.scene.designed_tree, space.given(values, rated))


def gravity_torques(tree: Tree, frames: dict[str, Placement]) -> dict[str, float]:
    """Of each joint that turns [N m], summed over the links beyond it."""
    found = {}
    for joint in tree.joints:
        if joint.kind is JointKind.FIXED:
            continue
        place = frames[joint.child]
        axis = np.array(place.rotation, float) @ np.array(joint.axis, float)
        moment, below = np.zeros(3), [joint.child]
        while below:
            link = below.pop()
            below += [each.child for each in tree.child_joints[link]]
            inertia = tree.link_by_name[link].inertia
            centre = np.array(frames[link].apply(inertia.center), float)
            weight = np.array([0.0, 0.0, -GRAVITY * float(inertia.mass)])
            moment += np.cross(centre - np.array(place.translation, float), weight)
        found[joint.name] = -float(axis @ moment)
    return found


@pytest.mark.slow
def test_urdf_mjcf_and_the_tree_are_one_robot(geometry: DesignProblem) -> None:
    rng = np.random.default_rng(43)
    for _ in range(DESIGNS):
        tree = random_tree(geometry, rng)
        turning = [joint for joint in tree.joints if joint.kind is not JointKind.FIXED]
        positions = {joint.name: float(rng.uniform(-0.6, 0.6)) for joint in turning}
        frames = link_frames(tree, Placement(), positions)
        torques = gravity_torques(tree, frames)

        model = pin.buildModelFromXML(urdf_text(tree), pin.JointModelFreeFlyer())
        data, q = model.createData(), pin.neutral(model)
        for joint in turning:
            q[model.idx_qs[model.getJointId(joint.name)]] = positions[joint.name]
        pin.framesForwardKinematics(model, data, q)
        gravity = pin.computeGeneralizedGravity(model, data, q)
        assert pin.computeTotalMass(model) == pytest.approx(float(tree.mass), rel=1e-12)
        for frame, place in zip(model.frames, data.oMf, strict=True):
            if frame.type == pin.FrameType.BODY:
                wanted = frames[frame.name]
                assert place.translation == pytest.approx(np.array(wanted.translation, float), abs=1e-12)
                assert place.rotation == pytest.approx(np.array(wanted.rotation, float), abs=1e-12)
        for joint in turning:
            found = gravity[model.idx_vs[model.getJointId(joint.name)]] * GRAVITY / 9.81
            assert found == pytest.approx(torques[joint.name], abs=1e-9)

        spec = mujoco.MjModel.from_xml_string(mjcf_text(tree, GRAVITY, {}).partition("?>")[2])
        state = mujoco.MjData(spec)
        for joint in turning:
            state.joint(joint.name).qpos[0] = positions[joint.name]
        root = spec.body(tree.root).id
        mujoco.mj_forward(spec, state)
        origin, turn = state.xpos[root].copy(), state.xmat[root].reshape(3, 3).copy()
        for link in tree.links:
            body = mujoco.mj_name2id(spec, mujoco.mjtObj.mjOBJ_BODY, link.name)
            if body < 0:
                continue
            place = turn.T @ (state.xpos[body] - origin)
            assert place == pytest.approx(np.array(frames[link.name].translation, float), abs=1e-12)
        rows = [model.idx_vs[model.getJointId(joint.name)] for joint in turning]
        dofs = [int(spec.joint(joint.name).dofadr[0]) for joint in turning]
        masses, full = pin.crba(model, data, q), np.zeros((spec.nv, spec.nv))
        mujoco.mj_fullM(spec, state, full)
        armature = np.diag(spec.dof_armature)
        others = (full - armature)[np.ix_(dofs, dofs)]
        masses = np.triu(masses) + np.triu(masses, 1).T
        assert others == pytest.approx(masses[np.ix_(rows, rows)], abs=1e-9)
        for joint in turning:
            found = state.qfrc_bias[spec.joint(joint.name).dofadr[0]]
            assert found == pytest.approx(torques[joint.name], abs=1e-9)


def test_the_reference_design_is_the_files_robot_to_the_last_bit(geometry: DesignProblem) -> None:
    """Joints and sections alone: actuators and walls are what a design adds."""
    tree, space = geometry.scene.designed_tree, geometry.space
    same = space.family(tree).without_actuators(space.given(space.unscaled(tree), {}))
    for before, after in zip(tree.joints, same.joints, strict=True):
        assert (after.parent_from_child, after.axis) == (before.parent_from_child, before.axis)
    for before, after in zip(tree.links, same.links, strict=True):
        shapes = [(solid.shape, solid.link_from_solid) for solid in before.solids]
        assert [(solid.shape, solid.link_from_solid) for solid in after.solids] == shapes
