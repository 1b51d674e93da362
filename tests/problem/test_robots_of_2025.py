"""The robots of 2025 as they are built here, against the figures of their URDFs and what these reach."""

from __future__ import annotations

from pathlib import Path

import msgspec
import numpy as np
import pinocchio as pin
import pytest
from scipy.optimize import minimize

from evodesign.errors import InputError
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.source import read_source
from evodesign.reproduction.ergonomic2025 import as_published, published_robots
from evodesign.tree.model import Tree
from evodesign.tree.urdf_write import urdf_text

FRAMES_KG = 4.0
"""Base, soles and IMU are links of 1 kg each in the URDFs, and frames without mass here."""

GRASP_ABOVE = 0.0125
"""Hands are so far above the centre of the load, and 0.2 m beside it [m]."""

SOLE_BELOW = 0.00515
"""Here soles lie under the feet; in the URDFs they are as much higher [m]."""

JOINTS_M = {
    "A": (-0.0216, 0.0725, 0.163, -0.1237, -0.1075, -0.0709, -0.255989),
    "B": (0.0019, 0.13445993, 0.17167529, -0.09688893, -0.11549243, -0.16569306, -0.29324047),
    "C": (0.0019, 0.16188487, 0.18180085, -0.11100542, -0.14623290, -0.20381301, -0.32249295),
}
"""z of joint origins in their parents' frames in model_A, model_B, model_C: hip pitch, torso pitch,
shoulder pitch, elbow, wrist pitch, hip yaw, ankle pitch. Torso yaw is at 0.06447 in all three."""


@pytest.fixture(scope="module")
def of_2025(repository: Path) -> DesignProblem:
    return as_published(build_problem(read_source(repository / "problems" / "sartore2025.toml")))


def test_the_published_robots_weigh_the_same_and_have_the_joints_of_their_urdfs(
    of_2025: DesignProblem,
) -> None:
    base = of_2025.scene.designed_tree
    for name, values in published_robots(of_2025).items():
        tree = of_2025.space.resized(base, values)
        assert float(tree.mass) + FRAMES_KG == pytest.approx(62.57, abs=0.005)
        for link in tree.links:
            assert float(link.mass) == pytest.approx(float(base.link_by_name[link.name].mass), rel=1e-9)
        if name == "iCub":
            continue
        model = pin.buildModelFromXML(urdf_text(tree))
        data = model.createData()
        pin.framesForwardKinematics(model, data, pin.neutral(model))
        height = {each: data.oMi[model.getJointId(each)].translation[2] for each in model.names[1:]}
        hip, torso, shoulder, elbow, wrist, thigh, ankle = JOINTS_M[name]
        sole = data.oMf[model.getFrameId("l_sole")].translation[2]
        raised = height["l_shoulder_pitch"] - sole
        legs = hip - 0.009 - 0.0897 + thigh - 0.1062 + ankle - 0.035 - 0.0658
        assert raised == pytest.approx(torso + 0.06447 + shoulder - legs + SOLE_BELOW, abs=5e-5)
        origins = {"l_elbow": elbow, "l_wrist_pitch": wrist, "l_hip_yaw": thigh, "l_ankle_pitch": ankle}
        for joint, wanted in origins.items():
            found = tree.joint_by_name[joint].parent_from_child.translation
            assert float(found[2]) == pytest.approx(wanted, abs=5e-5), joint


REACH_M = {"A": 1.398, "B": 1.558, "C": 1.708}
"""Of the URDFs themselves, arms raised sideways, by our evaluator in November 2026."""

RAISING = (
    *("torso_pitch", "l_shoulder_pitch", "l_shoulder_roll", "l_shoulder_yaw", "l_elbow", "l_wrist_prosup"),
    *("l_hip_pitch", "l_knee", "l_ankle_pitch"),
)
RAISED = np.array([0.0, 0.0, 2.7, -0.8, 0.5, 1.5, 0.0, 0.0, 0.0])
"""A posture with the arm raised sideways, where the highest one is sought [rad]."""


def raised_hand(tree: Tree) -> float:
    """How high a robot can bring its left hand above the sole, 0.2 m beside the middle [m]."""
    model = pin.buildModelFromXML(urdf_text(tree))
    data = model.createData()
    hand, sole = model.getFrameId("l_hand_frame"), model.getFrameId("l_sole")
    places = [model.joints[model.getJointId(each)].idx_q for each in RAISING]

    def frames(joints: np.ndarray) -> tuple[pin.SE3, pin.SE3]:
        posture = pin.neutral(model)
        posture[places] = joints
        pin.framesForwardKinematics(model, data, posture)
        return data.oMf[sole], data.oMf[hand]

    def below(joints: np.ndarray) -> float:
        world_from_sole, world_from_hand = frames(joints)
        return -float(world_from_sole.actInv(world_from_hand).translation[2])

    beside = {"type": "eq", "fun": lambda joints: frames(joints)[1].translation[1] - 0.2}
    bounds = [*zip(model.lowerPositionLimit[places], model.upperPositionLimit[places], strict=True)]
    found = minimize(below, RAISED, bounds=bounds, constraints=[beside])
    assert found.success
    return -float(found.fun)


def test_the_published_robots_reach_as_high_as_their_urdfs(of_2025: DesignProblem) -> None:
    """By the joints of leg, trunk and arm alone: other limits of a hold cost all the same."""
    base, robots = of_2025.scene.designed_tree, published_robots(of_2025)
    above = {
        name: raised_hand(of_2025.space.resized(base, robots[name])) - GRASP_ABOVE - SOLE_BELOW - reach
        for name, reach in REACH_M.items()
    }
    assert all(0.0 <= each <= 0.02 for each in above.values())
    assert max(above.values()) - min(above.values()) <= 0.003


def test_a_mass_is_kept_only_where_nothing_else_gives_it(repository: Path) -> None:
    source = read_source(repository / "problems" / "sartore2025.toml")
    density = (
        '[[design.density]]\nname = "d"\nlinks = ["chest"]\nlower_kg_per_m3 = 1.0\nupper_kg_per_m3 = 9.0\n'
    )
    wall = '[[design.wall]]\nname = "w"\nlinks = ["chest"]\nthickness_m = 0.002\nmaterial = "abs"\n'
    for table in (density, wall):
        changed = msgspec.structs.replace(source, text=f"{source.text}\n{table}")
        with pytest.raises(
            InputError, match=r"design.length\[6\].keep_mass: wanted false, as .* gives 'chest'"
        ):
            build_problem(changed)
