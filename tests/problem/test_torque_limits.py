"""Limits of joint torques in a problem file, and which problems they refuse."""

from __future__ import annotations

import pytest

from evodesign.errors import InputError
from evodesign.mechanics.agent import Agent
from evodesign.problem.build import build_problem
from evodesign.records import ProblemSource
from tests.fuzz.input_cases import PROBLEM, ROBOT, TEXTS


def robot_of(
    table: str = "", torque_limits: str = "none", robot: str = TEXTS[ROBOT], more: str = ""
) -> Agent:
    """The small robot, whose shoulders have limits of 50 N m in its URDF, under other limits."""
    text = TEXTS[PROBLEM].replace(f'urdf = "{ROBOT}"', f'urdf = "{ROBOT}"\ntorque_limits = "{torque_limits}"')
    text = text.replace("[human]", f"[robot.torque_limits_n_m]\n{table}\n\n[human]", 1)
    text = text.replace('"human_torque"]', f'"human_torque"{more}]')
    files = {**TEXTS, ROBOT: robot}
    return build_problem(ProblemSource(path=PROBLEM, text=text, files=files)).scene.robot


def test_limits_are_those_of_the_urdf_unless_the_problem_says_otherwise() -> None:
    shoulders = {"l_shoulder": 50.0, "r_shoulder": 50.0}
    assert robot_of().torque_limits == shoulders
    assert not robot_of().limits_torques
    assert robot_of(torque_limits="hard").limits_torques
    assert robot_of("spin = 3.0").torque_limits == {**shoulders, "spin": 3.0}
    lifted = robot_of('"*_lift" = 400.0\nl_lift = 300.0\n"?_shoulder" = 40.0').torque_limits
    assert lifted == {"l_shoulder": 40.0, "r_shoulder": 40.0, "l_lift": 300.0, "r_lift": 400.0}


def test_a_placeholder_of_zero_is_no_limit_until_limits_hold() -> None:
    zero = TEXTS[ROBOT].replace('effort="50"', 'effort="0"')
    assert robot_of(robot=zero).torque_limits == {}
    with pytest.raises(InputError, match=r"robot\.urdf.*positive effort limit of the joint 'l_shoulder'"):
        robot_of(torque_limits="hard", robot=zero)


NONE = TEXTS[ROBOT].replace('effort="50" ', "")


@pytest.mark.parametrize(
    ("table", "torque_limits", "robot", "more", "words"),
    [
        ("l_sholder = 5.0", "none", None, "", ["robot.torque_limits_n_m", "did you mean 'l_shoulder'?"]),
        ('"*_knee" = 5.0', "none", None, "", ["robot.torque_limits_n_m", "'*_knee'"]),
        ('"l_*" = 5.0\n"*_lift" = 6.0', "none", None, "", ["share no joint", "'l_lift'", "'*_lift'"]),
        ("spin = -3.0", "none", None, "", ["robot.torque_limits_n_m", "> 0"]),
        ("", "soft", None, "", ["robot.torque_limits", "'soft'"]),
        ("", "hard", NONE, "", ["robot.torque_limits", "'hard' and no limits"]),
        ("", "none", None, ', "peak_torque"', ["objectives.minimise[2]", "'peak_torque'", "none of"]),
        ("", "hard", None, ', "worst_peak_torque"', ["'worst_peak_torque'", "every joint"]),
        ("", "hard", None, ', "q50_peak_torque"', ["'q50_peak_torque'", "every joint"]),
    ],
)
def test_what_cannot_be_a_limit_is_refused(
    table: str, torque_limits: str, robot: str | None, more: str, words: list[str]
) -> None:
    with pytest.raises(InputError) as caught:
        robot_of(table, torque_limits, robot or TEXTS[ROBOT], more)
    for word in (PROBLEM, *words):
        assert word in str(caught.value)


def test_peak_torque_is_had_where_every_joint_has_a_limit() -> None:
    robot = robot_of('"*_lift" = 400.0\nspin = 3.0', more=', "peak_torque"')
    assert set(robot.torque_limits) == set(robot.joints)
