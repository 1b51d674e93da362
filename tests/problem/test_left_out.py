"""What a problem leaves out is told in a sentence each, and what a believer writes leaves nothing to tell."""

from __future__ import annotations

import pytest

from evodesign.problem.left_out import left_out
from evodesign.problem.source import read_source
from evodesign.records import ProblemSource

WHOLE = """
name = "whole"
[[human]]
[[human]]
posture = "least_torque"
joint_ranges = "coupled"
[[human]]
urdf = "person.urdf"
[payload]
grasp = "rigid"
hand_moment_n_m = 5
[collisions]
"""


def told(text: str) -> tuple[str, ...]:
    return left_out(ProblemSource(path="p.toml", text=text, files={}))


def test_nothing_is_told_of_a_problem_that_says_everything() -> None:
    assert told(WHOLE) == ()
    assert left_out(read_source("shared-lifting")) == ()


@pytest.mark.parametrize(
    ("old", "new", "begin"),
    [
        ("[collisions]", "", "no [collisions]: bodies may pass through each other"),
        ("hand_moment_n_m = 5", "", "no hand_moment_n_m: a rigid hand passes at most 7 N m about each axis"),
        ("= 5", "= inf", "hand_moment_n_m = inf: hands twist the load with any moment"),
        (
            'joint_ranges = "coupled"',
            "",
            'joint_ranges = "separate": every joint of a spine has all of its own',
        ),
        ('"coupled"', '"separate"', 'joint_ranges = "separate": every joint'),
    ],
)
def test_each_thing_left_out_is_told_in_one_line(old: str, new: str, begin: str) -> None:
    assert old in WHOLE
    (sentence,) = told(WHOLE.replace(old, new))
    assert sentence.startswith(begin)
    assert "\n" not in sentence


def test_point_grasps_pass_no_moment_to_be_told_of() -> None:
    point = WHOLE.replace('"rigid"', '"point"').replace("hand_moment_n_m = 5", "")
    assert told(point) == ()


def test_of_several_loads_each_kind_is_told_once() -> None:
    loads = "".join(f'[[payload]]\ngrasp = "rigid"\n{line}\n' for line in ("", "", "hand_moment_n_m = inf"))
    sentences = told(f"{loads}[collisions]\n[human]\njoint_ranges = 'coupled'")
    assert [sentence.split(":")[0] for sentence in sentences] == [
        "no hand_moment_n_m",
        "hand_moment_n_m = inf",
    ]


@pytest.mark.parametrize("text", ["", "[payload", "payload = 3", "human = [1]", "[payload]\ngrasp = 1"])
def test_a_text_that_is_no_problem_breaks_nothing(text: str) -> None:
    assert not any("hand_moment" in sentence for sentence in told(text))
