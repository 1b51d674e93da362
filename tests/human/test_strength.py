"""Strengths against figures worked out by hand, and the meaning of signs by moving and loading the body."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from evodesign.body.placement import Placement
from evodesign.human.anthropometry import Person
from evodesign.human.anthropometry_tables import Sex
from evodesign.human.body import DEFAULT_JOINTS, human_tree
from evodesign.human.strength import (
    joint_strengths,
    largest_relative_torque,
    relative_torques,
    strength_tables,
)
from evodesign.mechanics.balance import cut
from evodesign.tree.frames import link_frames
from evodesign.tree.kinematics import Pose, forward

MAN = Person(1.82, 72.7, Sex.MALE)
WOMAN = Person(1.612, 73.5, Sex.FEMALE)
FORWARD, UP = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
LEFTWARDS = np.array([0.0, 1.0, 0.0])
ARMS_DOWN = {"jLeftShoulder_rotx": -1.5, "jRightShoulder_rotx": 1.5}

MOVEMENTS = (
    # joint, movement, a point (link, place in it) that it carries along, and where to
    ("jL5S1_rotx", "bending to the left", "Head", (0.0, 0.0, 0.1), LEFTWARDS),
    ("jL4L3_rotx", "bending to the right", "Head", (0.0, 0.0, 0.1), -LEFTWARDS),
    ("jL1T12_roty", "flexion", "Head", (0.0, 0.0, 0.1), FORWARD),
    ("jT9T8_roty", "extension", "Head", (0.0, 0.0, 0.1), -FORWARD),
    ("jLeftShoulder_rotx", "abduction", "LeftHand", (0.0, 0.1, 0.0), UP),
    ("jLeftShoulder_rotx", "adduction", "LeftHand", (0.0, 0.1, 0.0), -UP),
    ("jLeftShoulder_roty", "internal rotation", "LeftHand", (0.1, 0.0, 0.0), -UP),
    ("jLeftElbow_roty", "external rotation", "LeftHand", (0.1, 0.0, 0.0), UP),
    ("jLeftShoulder_rotz", "flexion", "LeftHand", (0.0, 0.1, 0.0), FORWARD),
    ("jLeftElbow_rotz", "flexion", "LeftHand", (0.0, 0.1, 0.0), FORWARD),
    ("jLeftHip_rotx", "abduction", "LeftFoot", (0.0, 0.0, 0.0), LEFTWARDS),
    ("jLeftHip_roty", "flexion", "LeftLowerLeg", (0.0, 0.0, 0.0), FORWARD),
    ("jLeftHip_roty", "extension", "LeftLowerLeg", (0.0, 0.0, 0.0), -FORWARD),
    ("jLeftKnee_roty", "flexion", "LeftFoot", (0.0, 0.0, 0.0), -FORWARD),
    ("jLeftKnee_roty", "extension", "LeftFoot", (0.0, 0.0, 0.0), FORWARD),
    ("jLeftAnkle_rotx", "inversion", "LeftFoot", (0.0, 0.05, 0.0), -UP),
    ("jLeftAnkle_rotx", "eversion", "LeftFoot", (0.0, 0.05, 0.0), UP),
    ("jLeftAnkle_roty", "dorsiflexion", "LeftToe", (0.05, 0.0, 0.0), UP),
    ("jLeftAnkle_roty", "plantarflexion", "LeftToe", (0.05, 0.0, 0.0), -UP),
)
UNRATED = {"jT9T8_rotz", "jLeftHip_rotz", "jRightHip_rotz", "jLeftAnkle_rotz", "jRightAnkle_rotz"}
TRUNK = {f"{level}_rot{axis}" for level in ("jL5S1", "jL4L3", "jL1T12", "jT9T8") for axis in "xy"}
"""Whose figures are from memory."""


SIDES = (*((*row, False) for row in MOVEMENTS), *((*row, True) for row in MOVEMENTS if "Left" in row[0]))
"""Every movement, and its mirror image."""


def mirrored(vector: np.ndarray) -> np.ndarray:
    return vector * np.array([1.0, -1.0, 1.0])


@pytest.mark.parametrize(("joint", "movement", "link", "place", "where", "right"), SIDES)
def test_a_torque_has_the_sign_of_the_movement_that_it_is_named_for(
    joint: str, movement: str, link: str, place: tuple[float, ...], where: np.ndarray, right: bool
) -> None:
    if right:
        joint, link = joint.replace("Left", "Right"), link.replace("Left", "Right")
        place, where = tuple(mirrored(np.array(place))), mirrored(where)
    strength = joint_strengths(MAN, from_memory=True)[joint]
    ways = {-1.0: strength.negative, 1.0: strength.positive}
    (sign,) = [sign for sign, way in ways.items() if way is not None and way.movement == movement]
    tree = human_tree(MAN)
    before, after = (
        np.array(link_frames(tree, Placement(), {joint: angle})[link].apply(place))
        for angle in (0.0, 1e-3 * sign)
    )
    moved = (after - before) @ where
    assert moved > 0.7 * np.linalg.norm(after - before) > 0.0


def holding_torques(positions: dict[str, float], tilt: float = 0.0) -> dict[str, float]:
    """Torques that hold the body's own weight, pelvis fixed and tilted forward."""
    tree = human_tree(MAN)
    turn = ca.DM([[np.cos(tilt), 0.0, np.sin(tilt)], [0.0, 1.0, 0.0], [-np.sin(tilt), 0.0, np.cos(tilt)]])
    poses = forward(tree, Pose(turn, ca.DM.zeros(3)), {name: ca.DM(at) for name, at in positions.items()})
    return {name: float(torque) for name, torque in cut(tree, poses, []).torques.items()}


@pytest.mark.parametrize("side", ["Left", "Right"])
def test_the_muscles_that_hold_a_weight_are_those_that_would_lift_it(side: str) -> None:
    strengths = joint_strengths(MAN, from_memory=True)
    sign = 1.0 if side == "Left" else -1.0
    bent = {**ARMS_DOWN, f"j{side}Elbow_rotz": -1.5 * sign}
    raised = {f"j{side}Shoulder_rotz": -1.5 * sign}
    for positions, joint, movement in (
        (bent, f"j{side}Elbow_rotz", "flexion"),
        ({}, f"j{side}Shoulder_rotx", "abduction"),
        ({f"j{side}Hip_roty": -1.5}, f"j{side}Hip_roty", "flexion"),
        ({f"j{side}Hip_roty": -1.5}, f"j{side}Knee_roty", "extension"),
    ):
        torques = holding_torques(positions)
        (found,) = relative_torques({joint: torques[joint]}, strengths)
        assert found.movement == movement, joint
    arm_forward = holding_torques({f"j{side}Shoulder_rotx": -1.5 * sign, **raised})
    (found,) = relative_torques({f"j{side}Shoulder_rotz": arm_forward[f"j{side}Shoulder_rotz"]}, strengths)
    assert found.movement == "flexion"


def test_a_stooping_back_is_held_by_its_extensors() -> None:
    torques = holding_torques(ARMS_DOWN, tilt=1.0)
    for level in ("jL5S1_roty", "jL4L3_roty", "jL1T12_roty", "jT9T8_roty"):
        (found,) = relative_torques({level: torques[level]}, joint_strengths(MAN, from_memory=True))
        assert found.movement == "extension"


def test_strengths_are_those_worked_out_by_hand() -> None:
    """Body weight times stature is 72.7 * 9.81 * 1.82 = 1298.0 N m, and 73.5 * 9.81 * 1.612 = 1162.3 N m."""
    for person, knee, hip, abduction, elbow in (
        (MAN, 211.6, 209.0, 93.8, 68.5),
        (WOMAN, 184.8, 210.4, 83.1, 40.5),
    ):
        strengths = joint_strengths(person)
        for side, turned in (("Left", False), ("Right", True)):
            hips = strengths[f"j{side}Hip_rotx"]
            out = hips.negative if turned else hips.positive
            bent = strengths[f"j{side}Elbow_rotz"]
            flexion = bent.positive if turned else bent.negative
            assert strengths[f"j{side}Knee_roty"].negative.moment == pytest.approx(knee, abs=0.06)
            assert strengths[f"j{side}Hip_roty"].positive.moment == pytest.approx(hip, abs=0.06)
            assert out.moment == pytest.approx(abduction, abs=0.06)
            assert flexion.moment == pytest.approx(elbow)


def test_figures_from_memory_are_nobodys_strength() -> None:
    everything, published = (joint_strengths(MAN, from_memory=each) for each in (True, False))
    assert set(everything) - set(published) == TRUNK
    assert everything["jL4L3_roty"].negative.moment == 234.0
    assert (published["jLeftShoulder_rotx"].positive, published["jRightShoulder_rotx"].negative) == (
        None,
        None,
    )
    assert everything["jLeftShoulder_rotx"].positive.moment == 71.0
    assert everything["jLeftKnee_roty"] == published["jLeftKnee_roty"]


def test_what_is_not_rated_is_what_the_documents_say() -> None:
    strengths = joint_strengths(MAN)
    assert set(DEFAULT_JOINTS) - set(strengths) == UNRATED | TRUNK
    assert set(strengths) <= set(human_tree(MAN).actuated)
    one_way = {name for name, both in strengths.items() if both.negative is None or both.positive is None}
    rated_one_way = ("Hip_rotx", "Shoulder_rotx", "Shoulder_rotz", "Elbow_rotz")
    assert one_way == {f"j{side}{joint}" for side in ("Left", "Right") for joint in rated_one_way}


def test_every_figure_has_a_source_that_is_used_and_a_sensible_size() -> None:
    tables = strength_tables()
    ways = [way for row in tables.rows for way in (row.negative, row.positive) if way is not None]
    assert {way.source for way in ways} == set(tables.sources)
    for person in (MAN, WOMAN):
        for joint, both in joint_strengths(person).items():
            for way in (both.negative, both.positive):
                assert way is None or 15.0 < way.moment < 250.0, joint


@settings(max_examples=25)
@given(st.lists(st.floats(-2.0, 2.0), min_size=5, max_size=5))
def test_the_elbows_y_axis_is_the_upper_arms_whatever_the_posture(angles: list[float]) -> None:
    """Why a moment about it is carried by the shoulder's rotators, not by those of the forearm."""
    names = [f"jLeftShoulder_rot{axis}" for axis in "xyz"] + [f"jLeftElbow_rot{axis}" for axis in "yz"]
    at = link_frames(human_tree(MAN), Placement(), dict(zip(names, angles, strict=True)))
    elbow, shoulder = (np.array(at[link].translation) for link in ("LeftForeArm", "LeftUpperArm"))
    along = np.array(at["LeftUpperArm"].rotation)[:, 1]  # the joint's axis, y of the upper arm
    assert np.cross(along, elbow - shoulder) == pytest.approx(np.zeros(3), abs=1e-12)


def test_the_hardest_joint_is_found_by_its_own_strength_in_the_torques_direction() -> None:
    strengths = joint_strengths(MAN)
    torques = {
        "jL5S1_roty": -100.0,
        "jLeftElbow_rotz": -40.0,
        "jRightElbow_rotz": -40.0,
        "jRightKnee_roty": 40.0,
        "jLeftHip_rotz": 99.0,
    }
    worst = largest_relative_torque(torques, strengths)
    assert worst is not None
    assert (worst.joint, worst.movement) == ("jLeftElbow_rotz", "flexion")
    assert worst.share == pytest.approx(40.0 / 68.5)
    rated = {found.joint for found in relative_torques(torques, strengths)}
    assert rated == {"jLeftElbow_rotz", "jRightKnee_roty"}


def test_without_a_rated_torque_there_is_no_hardest_joint() -> None:
    assert (
        largest_relative_torque({"jLeftHip_rotz": 5.0, "jLeftHip_rotx": -5.0}, joint_strengths(MAN)) is None
    )
    assert largest_relative_torque({"knee": 5.0}, {}) is None
