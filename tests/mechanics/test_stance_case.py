"""A robot that stands alone: torques by hand, by the weights beyond each joint, and their slopes."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from evodesign.body.inertia import Inertia
from evodesign.mechanics.added_mass import AddedMasses
from evodesign.mechanics.balance import GRAVITY
from evodesign.mechanics.floating_base import FloatingBody
from evodesign.mechanics.stance_case import StanceCase
from evodesign.mechanics.stance_torques import stance_slopes, stance_torques
from evodesign.problem.build import DesignProblem
from evodesign.tree.model import Link, Tree
from evodesign.tree.urdf_write import urdf_text

ANKLES = (("l_ankle_pitch", "r_ankle_pitch"),)
SQUAT = StanceCase(
    "squat",
    {
        joint: math.radians(angle)
        for joint, angle in {
            "l_knee": -45.0,
            "r_knee": -45.0,
            "l_hip_pitch": 35.0,
            "r_hip_pitch": 35.0,
        }.items()
    },
    ("l_sole", "r_sole"),
    ANKLES,
    2.0,
)
ONE_LEG = StanceCase(
    "one leg",
    {"r_knee": math.radians(-60.0), "r_hip_pitch": math.radians(30.0)},
    ("l_sole",),
    (("l_ankle_pitch",), ("l_ankle_roll",)),
    2.0,
)


@pytest.fixture(scope="module")
def tree(problem: DesignProblem) -> Tree:
    return problem.scene.robot.tree


def body_of(problem: DesignProblem, tree: Tree) -> FloatingBody:
    return FloatingBody.of_tree(tree, problem.scene.robot.joints, np.eye(3))


@pytest.mark.parametrize("case", [SQUAT, ONE_LEG], ids=lambda case: case.name)
def test_torques_are_those_of_the_weight_beyond_each_joint(
    problem: DesignProblem, tree: Tree, case: StanceCase
) -> None:
    """Each joint of the standing leg against the moment of all weights on the far side of it, by pinocchio's
    model of the written URDF: nothing is shared with the code but the posture that it found."""
    found = stance_torques(body_of(problem, tree), case)
    assert found.reason == ""
    model = pin.buildModelFromXML(urdf_text(tree), pin.JointModelFreeFlyer())
    data, q = model.createData(), pin.neutral(model)
    positions = {**case.joints}
    for joints, offset in zip(case.balance, found.offsets, strict=True):
        for joint in joints:
            positions[joint] = positions.get(joint, 0.0) + offset
    for joint, angle in positions.items():
        q[model.joints[model.getJointId(joint)].idx_q] = angle
    pin.framesForwardKinematics(model, data, q)
    sole = data.oMf[model.getFrameId("l_sole")]
    down = -np.array(sole.rotation)[:, 2]
    center = np.array(pin.centerOfMass(model, data, q))
    middle = np.mean([data.oMf[model.getFrameId(name)].translation for name in case.soles], axis=0)
    away = np.array(sole.rotation).T @ (center - middle)
    assert np.abs(away[: 1 if len(case.soles) == 2 else 2]).max() < 1e-6
    for joint in ("l_knee", "l_ankle_pitch", "l_hip_pitch", "l_hip_roll", "l_shoulder_pitch"):
        number = model.getJointId(joint)
        beyond = [i for i in range(1, model.njoints) if number in model.supports[i]]
        place, moment = np.array(data.oMi[number].translation), np.zeros(3)
        for i in beyond:
            inertia = model.inertias[i]
            at = np.array(data.oMi[i].act(inertia.lever))
            moment += np.cross(at - place, GRAVITY * inertia.mass * down)
        if joint.startswith("l_") and "shoulder" not in joint:
            share = GRAVITY * pin.computeTotalMass(model) / len(case.soles)
            moment += np.cross(np.array(sole.translation) - place, -share * down)
        axis = np.array(data.oMi[number].rotation) @ np.array(tree.joint_by_name[joint].axis)
        assert found.torques[joint] == pytest.approx(-float(axis @ moment), abs=1e-4)


def test_slopes_by_added_masses_are_those_of_differences(problem: DesignProblem, tree: Tree) -> None:
    frames = [["l_forearm", "r_forearm"], ["l_lower_leg", "r_lower_leg"], ["chest"]]
    for case in (SQUAT, ONE_LEG):
        body = body_of(problem, tree)
        slopes = stance_slopes(body, case, stance_torques(body, case), AddedMasses(body, frames))
        for column, group in enumerate(frames):
            ends = []
            for mass in (-0.01, 0.01):
                links = tuple(heavier(link, mass) if link.name in group else link for link in tree.links)
                found = stance_torques(body_of(problem, tree.reshaped(links, tree.joints)), case)
                ends.append(np.array(list(found.torques.values())))
            assert slopes[:, column] == pytest.approx((ends[1] - ends[0]) / 0.02, abs=1e-4)


def heavier(link: Link, mass: float) -> Link:
    """The link with a point of mass at its origin."""
    own = link.inertia
    total = own.mass + mass
    center = np.array(own.center) * own.mass / total
    d = np.array(own.center)
    about = np.array(own.about_center) + own.mass * mass / total * (d @ d * np.eye(3) - np.outer(d, d))
    return replace(
        link, solids=(), own_inertia=Inertia(total, tuple(center), tuple(map(tuple, about.tolist())))
    )


def test_a_posture_in_which_nobody_can_stand_says_why(problem: DesignProblem, tree: Tree) -> None:
    lying = replace(SQUAT, joints={f"{s}_{name}": -0.79 for s in "lr" for name in ("knee", "hip_pitch")})
    assert "centre of mass is not over its soles" in stance_torques(body_of(problem, tree), lying).reason
    lame = replace(SQUAT, joints={"l_knee": -0.2})
    assert "above the other" in stance_torques(body_of(problem, tree), lame).reason
