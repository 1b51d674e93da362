"""Public humanoids read, written unscaled, and read again by pinocchio: the robot of the original file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from evodesign.problem.guess.problem_text import guessed_problem
from evodesign.tree.resize import resize
from evodesign.tree.urdf_read import InertiaRule, read_urdf
from evodesign.tree.urdf_write import urdf_text
from tests.robots import HUMANOIDS

POSTURES = 50

pytestmark = pytest.mark.needs_robots


def model_of(text: str) -> pin.Model:
    return pin.buildModelFromXML(text, pin.JointModelFreeFlyer())


def configuration(model: pin.Model, base: np.ndarray, positions: dict[str, float]) -> np.ndarray:
    """Base pose and joint positions; joints without a position stand at zero."""
    q = pin.neutral(model)
    q[:7] = base
    for name, position in positions.items():
        joint = model.joints[model.getJointId(name)]
        unbounded = joint.nq == 2
        q[joint.idx_q : joint.idx_q + joint.nq] = (
            (np.cos(position), np.sin(position)) if unbounded else position
        )
    return q


@pytest.mark.parametrize("name", HUMANOIDS)
def test_a_robot_written_unscaled_is_the_original(name: str) -> None:
    original_text = Path(HUMANOIDS[name]).read_text(encoding="utf-8")
    tree = read_urdf(original_text, name, InertiaRule.FILE)
    groups = guessed_problem(tree, "robot.urdf").text
    links = [link.name for link in tree.links if f'"{link.name}"' in groups and link.inertia.mass]
    unscaled = resize(tree, dict.fromkeys(links, 1.0), {})
    original, written = model_of(original_text), model_of(urdf_text(unscaled))
    moving = [joint for joint in original.names[2:] if joint in set(written.names)]
    assert len(moving) >= 25
    assert pin.computeTotalMass(original) == pytest.approx(pin.computeTotalMass(written), rel=1e-9)
    frames = [
        (original.getBodyId(link.name), written.getBodyId(link.name))
        for link in tree.links
        if original.existBodyName(link.name)
    ]
    assert len(frames) > 35
    rng = np.random.default_rng(1)
    one, other = original.createData(), written.createData()
    for _ in range(POSTURES):
        positions = {joint: rng.uniform(-1.0, 1.0) for joint in moving}
        base = np.concatenate([rng.uniform(-1.0, 1.0, 3), pin.Quaternion(pin.SE3.Random().rotation).coeffs()])
        q, q_written = configuration(original, base, positions), configuration(written, base, positions)
        pin.framesForwardKinematics(original, one, q)
        pin.framesForwardKinematics(written, other, q_written)
        for here, there in frames:
            assert np.allclose(one.oMf[here].homogeneous, other.oMf[there].homogeneous, atol=1e-9)
        assert np.allclose(
            pin.centerOfMass(original, one, q), pin.centerOfMass(written, other, q_written), atol=1e-9
        )
        gravity = pin.computeGeneralizedGravity(original, one, q)
        gravity_written = pin.computeGeneralizedGravity(written, other, q_written)
        for joint in ("root_joint", *moving):
            a, b = (model.joints[model.getJointId(joint)] for model in (original, written))
            assert np.allclose(
                gravity[a.idx_v : a.idx_v + a.nv],
                gravity_written[b.idx_v : b.idx_v + b.nv],
                atol=1e-9 * 1e3,
                rtol=1e-9,
            )
