"""Load cases in which the robot holds a payload or is pushed: against pinocchio's inverse dynamics."""

from __future__ import annotations

import math
from pathlib import Path

import msgspec
import numpy as np
import pinocchio as pin
import pytest

from evodesign.errors import InputError
from evodesign.mechanics.balance import GRAVITY
from evodesign.mechanics.stance_case import StanceCase, StanceTorques
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.source import read_source
from evodesign.quantities.stance_model import StanceModel
from evodesign.tree.equip import actuators_of
from evodesign.tree.model import Tree
from evodesign.tree.urdf_write import urdf_text

HOLD = """
[[load_case]]
name = "tray"
joints_deg = { l_shoulder_pitch = -20.0, l_elbow = 70.0 }
balance = [["l_ankle_pitch", "r_ankle_pitch"]]
hold = { mass_kg = 5.0, hand = "left", height_m = 1.0, raised_by = ["l_shoulder_pitch"] }
"""
PUSH = """
[[load_case]]
name = "shove"
joints_deg = { l_elbow = 70.0, r_elbow = 70.0 }
balance = [["l_ankle_pitch", "r_ankle_pitch"]]
push = { force_n = 40.0, direction_deg = 150.0 }
"""
ON_ONE_LEG = """
[[load_case]]
name = "bumped"
feet = "left"
joints_deg = { r_knee = -60.0, r_hip_pitch = 30.0 }
balance = [["l_ankle_pitch"], ["l_ankle_roll"]]
push = { force_n = 15.0, at = "trunk", direction_deg = 90.0 }
hold = { mass_kg = 2.0, hand = "right" }
"""
WRIST = '"l_wrist_prosup", "r_wrist_prosup",'
BALANCE = '\nbalance = [["l_ankle_pitch", "r_ankle_pitch"]]\n'


def with_cases(repository: Path, more: str, wrists: str = WRIST) -> DesignProblem:
    """The problem of hardware with further load cases, and other joints beside the elbows."""
    source = read_source(repository / "problems" / "icub_hardware.toml")
    text = source.text.replace('"l_elbow", "r_elbow", ' + WRIST[:-1], '"l_elbow", "r_elbow", ' + wrists[:-1])
    return build_problem(msgspec.structs.replace(source, text=text + more))


def stood(problem: DesignProblem, name: str) -> tuple[Tree, StanceCase, StanceTorques]:
    space, robot = problem.space, problem.scene.robot
    tree = space.resized(robot.tree, space.given(space.unscaled(robot.tree), {}))
    model = StanceModel.of(problem.stances, robot, tuple(actuators_of(tree)))
    return next((tree, case, found) for case, found in model.torques(tree) if case.name == name)


def at_rest(tree: Tree, case: StanceCase, found: StanceTorques) -> tuple[pin.Model, pin.Data, np.ndarray]:
    """Pinocchio's model of the written URDF in the posture that was found, its first sole level."""
    model = pin.buildModelFromXML(urdf_text(tree), pin.JointModelFreeFlyer())
    model.gravity.linear = np.array([0.0, 0.0, -GRAVITY])
    data, q = model.createData(), pin.neutral(model)
    positions = dict(case.joints)
    for joints, offset in zip(case.groups, found.offsets, strict=True):
        for joint in joints:
            positions[joint] = positions.get(joint, 0.0) + offset
    for joint, angle in positions.items():
        q[model.joints[model.getJointId(joint)].idx_q] = angle
    pin.framesForwardKinematics(model, data, q)
    sole = data.oMf[model.getFrameId(case.soles[0])].rotation
    q[3:7] = pin.Quaternion(np.array(sole.T)).coeffs()
    pin.framesForwardKinematics(model, data, q)
    return model, data, q


def loaded_torques(
    tree: Tree, case: StanceCase, found: StanceTorques, feet: dict[str, np.ndarray]
) -> tuple[np.ndarray, dict[str, float]]:
    """Base and joints by the recursive Newton-Euler algorithm, with all that acts from outside."""
    model, data, q = at_rest(tree, case, found)
    outside = [pin.Force.Zero() for _ in range(model.njoints)]
    for frame, force in [*case.loads, *feet.items()]:
        number = model.getFrameId(frame)
        carrier = model.frames[number].parentJoint
        place = data.oMf[number].translation - data.oMi[carrier].translation
        turn = np.array(data.oMi[carrier].rotation).T
        force = np.array(force)
        moment = np.cross(place, force[:3]) + (force[3:] if len(force) > 3 else 0.0)
        outside[carrier] += pin.Force(turn @ force[:3], turn @ moment)
    still = np.zeros(model.nv)
    rows = np.array(pin.rnea(model, data, q, still, still, outside))
    joints = {name: float(rows[model.joints[model.getJointId(name)].idx_v]) for name in found.torques}
    return rows[:6], joints


def shared_by_hand(tree: Tree, case: StanceCase, found: StanceTorques) -> dict[str, np.ndarray]:
    """What two feet pass, written out: half of the force each, and a couple for the moment."""
    model, data, q = at_rest(tree, case, found)
    center, mass = np.array(pin.centerOfMass(model, data, q)), pin.computeTotalMass(model)
    pin.framesForwardKinematics(model, data, q)
    acting = [(center, np.array([0.0, 0.0, -GRAVITY * mass]))]
    acting += [(data.oMf[model.getFrameId(f)].translation.copy(), np.array(force)) for f, force in case.loads]
    left, right = (np.array(data.oMf[model.getFrameId(sole)].translation) for sole in case.soles)
    total = sum(force for _, force in acting)
    moment = sum(np.cross(place - (left + right) / 2.0, force) for place, force in acting)
    wide = (left - right)[1]
    couple = np.array([moment[2] / wide, 0.0, -moment[0] / wide])
    return {case.soles[0]: -total / 2.0 + couple, case.soles[1]: -total / 2.0 - couple}


@pytest.mark.parametrize(("text", "name"), [(HOLD, "tray"), (PUSH, "shove")])
def test_a_loaded_robot_is_at_rest_with_these_torques(repository: Path, text: str, name: str) -> None:
    tree, case, found = stood(with_cases(repository, text), name)
    assert found.reason == ""
    base, joints = loaded_torques(tree, case, found, shared_by_hand(tree, case, found))
    assert np.abs(base).max() < 1e-6
    for joint, torque in found.torques.items():
        assert torque == pytest.approx(joints[joint], abs=1e-6), joint


def test_one_foot_carries_all_and_twists_the_ground(repository: Path) -> None:
    tree, case, found = stood(with_cases(repository, ON_ONE_LEG), "bumped")
    assert found.reason == ""
    base, _ = loaded_torques(tree, case, found, {})
    model, data, _ = at_rest(tree, case, found)
    (sole,) = case.soles
    root = data.oMi[1]
    force = np.array(root.rotation) @ base[:3]
    moment = np.array(root.rotation) @ base[3:]
    moment -= np.cross(data.oMf[model.getFrameId(sole)].translation - root.translation, force)
    assert np.abs(moment[:2]).max() < 1e-6
    base, joints = loaded_torques(tree, case, found, {sole: np.append(force, moment)})
    assert np.abs(base).max() < 1e-6
    assert max(abs(found.torques[joint] - joints[joint]) for joint in joints) < 1e-6


def test_a_payload_held_is_a_mass_in_the_hand_at_its_height(repository: Path) -> None:
    problem = with_cases(repository, HOLD)
    tree, case, found = stood(problem, "tray")
    model, data, _ = at_rest(tree, case, found)
    hand, sole = (data.oMf[model.getFrameId(frame)].translation for frame in (case.loads[0][0], "l_sole"))
    assert hand[2] - sole[2] == pytest.approx(1.0, abs=1e-8)
    assert case.loads == (("l_hand_frame", (0.0, 0.0, pytest.approx(-5.0 * GRAVITY))),)
    unladen = dict.fromkeys(found.torques, 0.0) | dict(stood(problem, "squat")[2].torques)
    assert abs(found.torques["l_elbow"]) > 5.0 * abs(unladen["l_elbow"])
    assert abs(found.torques["l_elbow"]) > 2.0 * abs(found.torques["r_elbow"])


def test_a_wrist_that_the_lift_holds_still_counts_where_it_is_driven(repository: Path) -> None:
    pitched = WRIST.replace("prosup", "pitch")
    turned = HOLD.replace("l_elbow = 70.0", "l_elbow = 70.0, l_wrist_pitch = 20.0")
    problem = with_cases(repository, turned, pitched)
    assert "l_wrist_pitch" not in problem.scene.robot.joints
    tree, case, found = stood(problem, "tray")
    _, joints = loaded_torques(tree, case, found, {})
    assert abs(found.torques["l_wrist_pitch"]) > 0.1
    assert found.torques["l_wrist_pitch"] == pytest.approx(joints["l_wrist_pitch"], abs=1e-6)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (("height_m = 1.0", "height_m = 3.0"), "its hand not at 3 m"),
        (("l_elbow = 70.0", "l_elbow = 70.0, l_shoulder_roll = 90.0"), "would have to pull"),
        (("height_m = 1.0", "height_m = 1.25"), "needs l_shoulder_pitch at"),
    ],
)
def test_what_cannot_be_held_says_why(repository: Path, change: tuple[str, str], words: str) -> None:
    heavy = HOLD.replace("mass_kg = 5.0", "mass_kg = 60.0") if "roll" in change[1] else HOLD
    _, _, found = stood(with_cases(repository, heavy.replace(*change)), "tray")
    assert words in found.reason
    assert not found.torques


def test_a_push_makes_feet_slip_and_a_light_foot_pull(repository: Path) -> None:
    strong = PUSH.replace("40.0", "400.0").replace("150.0", "90.0")
    _, _, found = stood(with_cases(repository, strong), "shove")
    assert "slips" in found.reason or "tips" in found.reason
    easy = PUSH.replace("40.0", "4.0")
    assert math.isclose(
        sum(f[0] ** 2 + f[1] ** 2 for _, f in with_cases(repository, easy).stances[-1].loads), 8
    )


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (HOLD.replace('"left"', '"third"'), ["load_case[2].hold.hand", "'third'"]),
        (HOLD.replace("5.0", "-5.0"), ["load_case[2].hold.mass_kg"]),
        (HOLD.replace(', raised_by = ["l_shoulder_pitch"]', ""), ["hold.raised_by", "joints that raise"]),
        (HOLD.replace("height_m = 1.0, ", ""), ["hold.height_m", "a height"]),
        (HOLD.replace('["l_shoulder_pitch"]', '["l_ankle_pitch"]'), ["'l_ankle_pitch', which is in balance"]),
        (HOLD.replace('["l_shoulder_pitch"]', '["l_sholder_pitch"]'), ["did you mean 'l_shoulder_pitch'?"]),
        (PUSH.replace("force_n = 40.0", 'force_n = 40.0, at = "head"'), ["load_case[2].push.at", "'head'"]),
        (PUSH + "dropped_from_m = 0.1", ["load_case[2].dropped_from_m", "a fall or a push"]),
        (PUSH.replace("40.0", "0.0"), ["load_case[2].push.force_n"]),
        (HOLD.replace("l_elbow = 70.0", "l_wrist_yaw = 1.0"), ["moving joint", "'l_wrist_yaw'"]),
    ],
)
def test_contradictions_are_refused_in_a_sentence(repository: Path, text: str, words: list[str]) -> None:
    with pytest.raises(InputError) as caught:
        with_cases(repository, text)
    for word in ("icub_hardware.toml", *words):
        assert word in str(caught.value)
    assert "\n" not in str(caught.value)
