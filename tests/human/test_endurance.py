"""How long a posture can be held: against the published table, and against hand calculation."""

from __future__ import annotations

import math

import pytest

from evodesign.human.anthropometry import Person
from evodesign.human.anthropometry_tables import Sex
from evodesign.human.body import DEFAULT_JOINTS
from evodesign.human.endurance import endurance, endurance_tables, holding_time
from evodesign.human.strength import joint_strengths, with_given

TABLE_2 = {
    "jLeftAnkle_roty": (34.71, -2.06),
    "jL5S1_roty": (22.69, -2.27),
    "jRightElbow_rotz": (17.98, -2.21),
    "jRightWrist_rotx": (33.55, -1.61),
    "jRightKnee_roty": (19.38, -1.88),
    "jLeftShoulder_rotz": (14.86, -1.83),
    "jRightElbow_roty": (14.86, -1.83),
    "jLeftHip_roty": (21.92, -1.98),
}
"""Seconds at the full strength and exponent of the region to which each joint belongs."""

MAN = joint_strengths(Person(1.8, 75.0, Sex.MALE))


@pytest.mark.parametrize("joint", TABLE_2)
@pytest.mark.parametrize("share", [0.01, 0.1, 0.25, 0.5, 0.9, 1.0, 1.2])
def test_times_are_those_of_the_published_table(joint: str, share: float) -> None:
    seconds, exponent = TABLE_2[joint]
    assert holding_time(joint, share) == pytest.approx(seconds * math.exp(exponent * math.log(share)))


def test_at_half_the_strength_regions_tire_in_the_published_order() -> None:
    """Ankle, trunk, hand, elbow, knee, shoulder: from the most to the least resistant (abstract)."""
    order = ["jLeftAnkle_roty", "jL5S1_roty", "jRightWrist_rotx", "jRightElbow_rotz", "jRightKnee_roty"]
    times = [holding_time(joint, 0.5) for joint in [*order, "jLeftShoulder_rotz"]]
    assert times == sorted(times, reverse=True)


def test_below_the_drawn_curve_the_time_grows_no_further() -> None:
    lowest = endurance_tables().drawn_from
    assert holding_time("jLeftKnee_roty", lowest / 10.0) == holding_time("jLeftKnee_roty", lowest)


def test_the_joint_that_tires_first_is_not_the_one_with_the_largest_share() -> None:
    shoulder, ankle = MAN["jLeftShoulder_rotz"].negative, MAN["jLeftAnkle_roty"].positive
    torques = dict.fromkeys(DEFAULT_JOINTS, 0.0)
    torques |= {"jLeftShoulder_rotz": -0.4 * shoulder.moment, "jLeftAnkle_roty": 0.5 * ankle.moment}
    found = endurance(torques, MAN)
    assert found.joint.joint == "jLeftShoulder_rotz"
    assert found.seconds == pytest.approx(14.86 * 0.4**-1.83)
    assert found.measured


def test_the_back_tires_first_once_its_strength_is_known() -> None:
    torques = {"jL5S1_roty": -150.0, "jLeftKnee_roty": -30.0}
    assert endurance(torques, MAN).joint.joint == "jLeftKnee_roty"
    found = endurance(torques, with_given(MAN, {"jL5S1_roty": (234.0, 143.0)}))
    assert found.joint.joint == "jL5S1_roty"
    assert found.seconds == pytest.approx(22.69 * (150.0 / 234.0) ** -2.27)


@pytest.mark.parametrize("torque", [-90.0, -20.0, -0.5, 60.0])
def test_its_derivative_is_that_of_differences(torque: float) -> None:
    found = endurance({"jLeftKnee_roty": torque}, MAN)
    ends = [endurance({"jLeftKnee_roty": torque + step}, MAN).seconds for step in (1e-5, -1e-5)]
    assert found.by_torque == pytest.approx((ends[0] - ends[1]) / 2e-5, rel=1e-6)


def test_who_has_no_strength_has_no_holding_time() -> None:
    assert endurance({"jLeftKnee_roty": 10.0}, {}) is None
