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


@pytest.mark.parametrize("seed", range(4))
def test_a_resized_body_is_the_one_that_is_built_anew(seed: int, problem: DesignProblem) -> None:
    """The built one is held against the URDF above; here half of the joints are welded at zero, too."""
    tree, rng = problem.scene.robot.tree, np.random.default_rng(seed)
    point = rng.uniform(size=len(problem.space.parameters))
    resized = problem.space.resized(tree, problem.space.values(tuple(point.tolist())))
    moving = tree.actuated[:: 1 + seed % 2]
    template = FloatingBody.of_tree(tree, moving, np.eye(3))
    ours, anew = template.resized(resized), FloatingBody.of_tree(resized, moving, np.eye(3))
    angles = dict(zip(moving, rng.uniform(-0.6, 0.6, len(moving)), strict=True))
    configuration = Configuration(rng.uniform(-1, 1, 3), rng.uniform(-1, 1, 3), angles)
    velocity = rng.uniform(-1, 1, anew.size)
    one, other = ours.at(configuration, velocity), anew.at(configuration, velocity)
    unscaled = template.at(configuration, velocity)
    assert one.bias == pytest.approx(other.bias, rel=1e-12, abs=1e-10)
    assert one.mass == pytest.approx(other.mass, rel=1e-12, abs=1e-12)
    for link in tree.links:
        for mine, its in zip(one.pose(link.name), other.pose(link.name), strict=True):
            assert np.allclose(mine, its, rtol=0.0, atol=1e-13)
    assert np.abs(unscaled.bias - other.bias).max() > 1.0  # and is not the unscaled one


def test_states_of_one_body_do_not_mix(problem: DesignProblem) -> None:
    """They compute in the same memory."""
    tree = problem.scene.robot.tree
    body, rng = FloatingBody.of_tree(tree, tree.actuated, np.eye(3)), np.random.default_rng(0)
    link, still = problem.scene.robot.frame("left_hand"), np.zeros(body.size)
    places = [
        Configuration(rng.uniform(-1, 1, 3), rng.uniform(-1, 1, 3), dict.fromkeys(tree.actuated, 0.1 * k))
        for k in range(2)
    ]
    alone = [body.at(place, still).pose(link)[1] for place in places]
    states = [body.at(place, still) for place in places]
    for _ in range(2):
        for state, expected in zip(states, alone, strict=True):
            assert state.pose(link)[1].tolist() == expected.tolist()
