"""The body that we give to pinocchio is the one that pinocchio reads from our URDF."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from evodesign.mechanics.balance import GRAVITY
from evodesign.mechanics.floating_base import Configuration, FloatingBody
from evodesign.problem.build import DesignProblem
from evodesign.tree.model import Tree
from evodesign.tree.urdf_write import urdf_text
from tests.oracles.pinocchio_model import floating_model
from tests.tree.crane import crane


def trees(problem: DesignProblem) -> dict[str, Tree]:
    scene = problem.scene
    longer = problem.space.values((0.8,) * len(problem.space.parameters))
    return {
        "robot": scene.robot.tree,
        "longer robot": problem.space.resized(scene.robot.tree, longer),
        "person": scene.human.tree,
        "crane": crane(),
    }


@pytest.mark.parametrize("name", ["robot", "longer robot", "person", "crane"])
def test_mass_matrix_bias_and_frames_are_those_of_the_urdf(name: str, problem: DesignProblem) -> None:
    tree = trees(problem)[name]
    rng = np.random.default_rng(3)
    moving = tree.actuated[::2]  # the others are welded at zero
    body = FloatingBody.of_tree(tree, moving, np.eye(3))
    positions = dict(zip(moving, rng.uniform(-0.6, 0.6, len(moving)), strict=True))
    configuration = Configuration(rng.uniform(-1, 1, 3), rng.uniform(-1, 1, 3), positions)
    velocity = rng.uniform(-1, 1, body.size)
    state = body.at(configuration, velocity)

    model = floating_model(urdf_text(tree))
    model.gravity.linear = np.array([0.0, 0.0, -GRAVITY])
    data = model.createData()
    q, v = pin.neutral(model), np.zeros(model.nv)
    q[:3] = configuration.base_position
    q[3:7] = pin.Quaternion(pin.rpy.rpyToMatrix(*configuration.base_angles)).coeffs()
    rows = list(range(6))
    v[:6] = velocity[:6]
    for column, joint_name in enumerate(moving, 6):
        joint = model.joints[model.getJointId(joint_name)]
        angle = positions[joint_name]
        q[joint.idx_q : joint.idx_q + joint.nq] = angle if joint.nq == 1 else (np.cos(angle), np.sin(angle))
        v[joint.idx_v] = velocity[column]
        rows.append(joint.idx_v)
    mass = np.array(pin.crba(model, data, q))
    bias = np.array(pin.nonLinearEffects(model, data, q, v))
    pin.framesForwardKinematics(model, data, q)
    assert np.allclose(state.mass, mass[np.ix_(rows, rows)], rtol=1e-10, atol=1e-10)
    assert np.allclose(state.bias, bias[rows], rtol=1e-10, atol=1e-9)
    for link in tree.links:
        placement = data.oMf[model.getFrameId(link.name, pin.FrameType.BODY)]
        assert np.allclose(state.pose(link.name)[1], placement.translation, atol=1e-10)
        assert np.allclose(state.pose(link.name)[0], placement.rotation, atol=1e-10)
