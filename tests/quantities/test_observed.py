"""Postures as an observer sees them: a person who is posed on purpose."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from evodesign.human.worksheets import ArmSeen, BodySeen
from evodesign.quantities.observed import observed
from evodesign.records import AgentDetail
from tests.problem.standing_people import PERSON


def detail(joints: dict[str, float], angles: tuple[float, float, float], left: float) -> AgentDetail:
    """A person with some joints [degrees] not at zero, whose left foot has a share of the weight."""
    given = {name: math.radians(value) for name, value in joints.items()}
    return AgentDetail(
        base_position_m=(0.0, 0.0, 0.9),
        base_rpy_rad=tuple(math.radians(each) for each in angles),
        joints_rad={name: given.get(name, 0.0) for name in {*PERSON.joints, *given}},
        torques_n_m={},
        wrenches={
            f"{side}_foot": (0.0, 0.0, 700.0 * share, 0.0, 0.0, 0.0)
            for side, share in (("left", left), ("right", 1.0 - left))
        },
    )


def seen(
    joints: dict[str, float], angles: tuple[float, float, float] = (0.0, 0.0, 0.0), left: float = 0.5
) -> tuple[ArmSeen, ArmSeen, BodySeen]:
    """Both arms and the body of such a person."""
    arms, body = observed(PERSON, detail(joints, angles, left))
    return *arms, body


def both(joint: str, degrees: float) -> dict[str, float]:
    """A joint about x or z of both sides, mirrored."""
    return {f"jLeft{joint}": degrees, f"jRight{joint}": -degrees}


def test_arms_that_hang_are_neither_flexed_nor_abducted() -> None:
    for arm in seen(both("Shoulder_rotx", -90.0))[:2]:
        assert (arm.upper, arm.abduction, arm.elbow) == pytest.approx((0.0, 0.0, 0.0), abs=1e-5)
        assert not arm.raised
        assert not arm.aside


def test_arms_in_t_pose_are_abducted_by_ninety_degrees_and_aside() -> None:
    for arm in seen({})[:2]:
        assert (arm.upper, arm.abduction) == pytest.approx((90.0, 90.0), abs=1e-5)
        assert arm.aside


def test_arms_held_forward_are_flexed_by_ninety_degrees() -> None:
    for arm in seen(both("Shoulder_rotz", -90.0))[:2]:
        assert (arm.upper, arm.abduction) == pytest.approx((90.0, 0.0), abs=1e-5)


def test_a_bent_elbow_is_as_bent_as_its_joint() -> None:
    left, right, _ = seen({**both("Shoulder_rotz", -90.0), **both("Elbow_rotz", -70.0)})
    assert (left.elbow, right.elbow) == pytest.approx((70.0, 70.0))
    assert left.aside == right.aside


@pytest.mark.parametrize("pitch", [-15.0, 0.0, 12.0, 40.0, 70.0])
def test_who_tilts_the_pelvis_bends_the_trunk_and_not_the_arms(pitch: float) -> None:
    left, _, body = seen(both("Shoulder_rotx", -90.0), (0.0, pitch, 0.0))
    assert body.trunk == pytest.approx(pitch, abs=1.0), "the spine of the T-pose is upright within a degree"
    assert left.upper == pytest.approx(0.0, abs=1e-5)


def test_bends_and_turns_of_trunk_neck_and_wrist_are_those_of_their_joints() -> None:
    left, right, body = seen(
        {
            "jL5S1_rotx": 20.0,
            "jT9T8_rotz": 30.0,
            "jT1C7_roty": 15.0,
            "jC1Head_roty": 5.0,
            "jT1C7_rotz": -8.0,
            "jLeftWrist_rotx": -25.0,
            "jLeftWrist_rotz": 12.0,
            "jRightC7Shoulder_rotx": -20.0,
        }
    )
    assert abs(body.trunk_bent) > 10.0
    assert body.trunk_twisted == pytest.approx(30.0, abs=3.0)
    assert (body.neck, body.neck_twisted) == pytest.approx((20.0, -8.0))
    assert (left.wrist, left.deviation, left.raised, right.raised) == pytest.approx(
        (-25.0, 12.0, False, True)
    )


def test_the_more_bent_knee_counts_and_a_foot_without_weight_is_no_support() -> None:
    *_, body = seen({"jLeftKnee_roty": 10.0, "jRightKnee_roty": 50.0}, left=0.4)
    assert body.knee == pytest.approx(50.0)
    assert body.balanced
    assert not seen({}, left=0.2)[2].balanced


def test_a_person_whose_links_have_other_names_is_not_seen() -> None:
    tree = PERSON.tree
    links = tuple(replace(link, name=link.name.replace("T8", "chest")) for link in tree.links)
    joints = tuple(
        replace(joint, parent=joint.parent.replace("T8", "chest"), child=joint.child.replace("T8", "chest"))
        for joint in tree.joints
    )
    stranger = replace(PERSON, tree=replace(tree, links=links, joints=joints), trunk=("Pelvis", "chest"))
    assert observed(stranger, detail({}, (0.0, 0.0, 0.0), 0.5)) is None
