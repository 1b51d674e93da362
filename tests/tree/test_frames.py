"""Frames of many postures at once against those of each posture, and pinocchio's."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from evodesign.body.placement import Placement
from evodesign.problem.build import DesignProblem
from evodesign.tree.frames import link_frames, link_poses
from evodesign.tree.urdf_write import urdf_text
from tests.tree.crane import crane

RNG = np.random.default_rng(5)


def test_many_postures_are_those_of_each() -> None:
    """The crane has a joint that slides, and one that stays."""
    tree = crane()
    drawn = {joint.name: RNG.uniform(-1.0, 1.0, 7) for joint in tree.joints}
    poses = link_poses(tree, drawn)
    for number in range(7):
        frames = link_frames(tree, Placement(), {name: float(each[number]) for name, each in drawn.items()})
        assert poses.keys() == frames.keys()
        for name, frame in frames.items():
            turns, origins = poses[name]
            assert np.allclose(turns[number], frame.rotation, rtol=0.0, atol=1e-14)
            assert np.allclose(origins[number], frame.translation, rtol=0.0, atol=1e-14)


def test_many_postures_are_pinocchios(problem: DesignProblem) -> None:
    tree = problem.scene.robot.tree
    model = pin.buildModelFromXML(urdf_text(tree))
    data = model.createData()
    drawn = {name: RNG.uniform(-1.0, 1.0, 3) for name in problem.scene.robot.joints}
    poses = link_poses(tree, drawn)
    for number in range(3):
        q = pin.neutral(model)
        for name, each in drawn.items():
            q[model.joints[model.getJointId(name)].idx_q] = each[number]
        pin.framesForwardKinematics(model, data, q)
        for name, (turns, origins) in poses.items():
            place = data.oMf[model.getFrameId(name, pin.FrameType.BODY)]
            assert np.allclose(turns[number], place.rotation, rtol=0.0, atol=1e-12)
            assert np.allclose(origins[number], place.translation, rtol=0.0, atol=1e-12)


def test_joints_left_out_stand_at_zero() -> None:
    tree = crane()
    poses = link_poses(tree, {})
    for name, frame in link_frames(tree, Placement(), {}).items():
        assert np.allclose(poses[name][1], [frame.translation], rtol=0.0, atol=1e-15)
