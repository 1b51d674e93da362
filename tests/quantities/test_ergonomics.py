"""What a posture asks of the person, against pinocchio's kinematics and sums written out by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from evodesign.human.anthropometry import Person, sole_size
from evodesign.human.anthropometry_tables import Sex
from evodesign.human.body import DEFAULT_JOINTS, HANDS, SOLES, TRUNK, human_tree
from evodesign.human.endurance import endurance
from evodesign.human.niosh import Coupling
from evodesign.human.strength import joint_strengths
from evodesign.mechanics.agent import HUMAN, Agent, Role, two_hands_two_feet
from evodesign.mechanics.contact import SoleSize
from evodesign.posture.check import AgentModel
from evodesign.posture.results import AgentPosture
from evodesign.quantities.ergonomics import ergonomics, ergonomics_json
from evodesign.quantities.person_quantities import compression, load_torque
from evodesign.records import AgentDetail

MAN = Person(1.82, 72.7, Sex.MALE)


def human() -> Agent:
    tree = human_tree(MAN)
    size = SoleSize(*sole_size(MAN))
    contacts = two_hands_two_feet(HANDS, SOLES, size)
    return Agent(HUMAN, Role.PERSON, tree, DEFAULT_JOINTS, contacts, TRUNK, strengths=joint_strengths(MAN))


PERSON = human()


def posture(
    joints: dict[str, float],
    angles: tuple[float, float, float] = (0.0, 0.0, 0.0),
    forces: tuple[float, float] = (-10.0, -14.5),
) -> AgentDetail:
    """A person with the pelvis where it stands, hands pressed down by the given forces [N]."""
    wrench = [0.0] * 6
    return AgentDetail(
        base_position_m=(-0.4, 0.1, 0.530 * MAN.stature),
        base_rpy_rad=angles,
        joints_rad={name: joints.get(name, 0.0) for name in DEFAULT_JOINTS},
        torques_n_m=dict.fromkeys(DEFAULT_JOINTS, 1.0),
        wrenches={
            "left_hand": (3.0, 1.0, forces[0], *wrench[:3]),
            "right_hand": (3.0, -1.0, forces[1], *wrench[:3]),
            "left_foot": tuple(wrench),
            "right_foot": tuple(wrench),
        },
    )


def middles(detail: AgentDetail) -> tuple[np.ndarray, np.ndarray]:
    """Middle of the hands and of the ankles by pinocchio [m]."""
    solved = AgentPosture(
        np.array(detail.base_position_m), np.array(detail.base_rpy_rad), detail.joints_rad, {}, {}
    )
    state = AgentModel.of(PERSON, PERSON.tree).at(solved)
    hands = np.mean([state.pose(name)[1] for name in HANDS.values()], axis=0)
    ankles = np.mean([state.pose(name)[1] for name in ("LeftFoot", "RightFoot")], axis=0)
    return hands, ankles


@settings(max_examples=20)
@given(
    st.lists(st.floats(-0.8, 0.8), min_size=len(DEFAULT_JOINTS), max_size=len(DEFAULT_JOINTS)),
    st.tuples(st.floats(-0.3, 0.3), st.floats(-0.3, 0.3), st.floats(-0.5, 0.5)),
)
def test_hands_and_ankles_are_where_pinocchio_finds_them(
    joints: list[float], angles: tuple[float, float, float]
) -> None:
    detail = posture(dict(zip(DEFAULT_JOINTS, joints, strict=True)), angles)
    hands, ankles = middles(detail)
    task = ergonomics(PERSON, detail).task
    line = (hands - ankles)[:2]
    assert task.horizontal == pytest.approx(float(np.linalg.norm(line)), abs=1e-9)
    assert task.vertical == pytest.approx(float(hands[2]), abs=1e-9)
    cosine = line[0] / np.linalg.norm(line)
    assert np.cos(np.radians(task.asymmetry)) == pytest.approx(cosine, abs=1e-9)


def test_arms_held_forward_are_an_arms_length_from_the_ankles() -> None:
    forward = {"jLeftShoulder_rotz": -np.pi / 2.0, "jRightShoulder_rotz": np.pi / 2.0}
    found = ergonomics(PERSON, posture(forward))
    hands, ankles = middles(posture(forward))
    arm = (0.186 + 0.146) * MAN.stature
    assert arm < found.task.horizontal < arm + 0.108 * MAN.stature
    assert found.task.vertical == pytest.approx(0.818 * MAN.stature, abs=0.02)
    assert found.task.asymmetry == pytest.approx(0.0, abs=1e-9)
    assert found.task.coupling is Coupling.POOR
    assert found.recommended_weight == 0.0, "0.66 m is farther than the equation goes"
    assert found.lifting_index is None
    assert hands[0] - ankles[0] == pytest.approx(found.task.horizontal)


def test_the_lifting_index_is_the_held_part_of_the_load_over_what_is_recommended() -> None:
    bent = {
        "jLeftShoulder_rotx": -1.5,
        "jRightShoulder_rotx": 1.5,
        "jLeftElbow_rotz": -1.5,
        "jRightElbow_rotz": 1.5,
    }
    found = ergonomics(PERSON, posture(bent))
    assert found.load == pytest.approx(24.5 / 9.81)
    factors = found.multipliers
    by_hand = 23.0 * factors.horizontal * factors.vertical * 0.90
    assert found.recommended_weight == pytest.approx(by_hand * factors.asymmetry)
    assert found.lifting_index == pytest.approx(24.5 / 9.81 / found.recommended_weight)


def test_the_relative_torque_is_that_of_the_weakest_direction_of_a_joint() -> None:
    """One newton metre everywhere, so the weakest of all positive directions works hardest."""
    strain = ergonomics(PERSON, posture({})).strain
    assert strain is not None
    weakest = min(both.positive.moment for both in PERSON.strengths.values() if both.positive is not None)
    assert strain.share == pytest.approx(1.0 / weakest)


def test_a_person_without_strengths_has_no_relative_torque_but_a_lifting_index() -> None:
    found = ergonomics(replace(PERSON, strengths={}), posture({"jLeftElbow_rotz": -1.5}))
    assert found.strain is None
    assert found.recommended_weight >= 0.0


def test_the_back_the_load_and_the_scores_are_those_of_the_quantities() -> None:
    """The arms are out to the side, and what the feet bear is nothing, which is less than the body weighs."""
    detail = posture({"jL5S1_roty": 0.5})
    found = ergonomics(PERSON, detail)
    solved = AgentPosture(
        np.array(detail.base_position_m),
        np.array(detail.base_rpy_rad),
        detail.joints_rad,
        detail.torques_n_m,
        {name: np.array(wrench) for name, wrench in detail.wrenches.items()},
    )
    assert found.load_torque == pytest.approx(load_torque(PERSON, solved))
    assert found.back.compression == pytest.approx(compression(PERSON, solved))
    assert found.endurance.seconds == endurance(detail.torques_n_m, PERSON.strengths).seconds
    assert (found.rula.whole, found.reba.whole) == (7, 6), "by hand from the worksheets"


def test_the_json_has_every_figure_and_nulls_for_what_is_not_known() -> None:
    told = ergonomics_json(ergonomics(PERSON, posture({})))
    assert set(told["rula"]) == set(told["reba"]) == {"arm", "body", "whole"}
    assert told["back_limit_n"] == 3400.0
    stiff = tuple(name for name in PERSON.joints if not name.startswith("jL5S1"))
    nobody = replace(PERSON, joints=stiff, strengths={})
    told = ergonomics_json(ergonomics(nobody, posture({})))
    assert [
        told[key] for key in ("back_compression_n", "back_shear_n", "endurance_s", "endurance_joint")
    ] == [None] * 4
