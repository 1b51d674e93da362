"""What joints and links are called: every joint that moves has words of its own."""

from __future__ import annotations

import pytest

from evodesign.problem.build import DesignProblem
from evodesign.tree.words import in_words, words_of


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("jL5S1_roty", "lower back L5/S1, bending forward"),
        ("jLeftShoulder_rotz", "left shoulder, raising forward"),
        ("LeftUpperLeg", "left upper leg"),
        ("T8_f1", "chest"),
        *((name, name) for name in ("l_hip_pitch", "panda_joint1", "LHipPitch", "RightElbow", "")),
    ],
)
def test_names_of_the_person_become_words_and_no_others(name: str, words: str) -> None:
    assert in_words(name) == words


def test_no_two_joints_of_a_person_are_called_alike(problem: DesignProblem) -> None:
    for agent in problem.scene.people:
        called = [in_words(joint) for joint in agent.joints]
        assert len({*called}) == len(called)
        assert not any("_" in words or "rot" in words for words in called)
        known = words_of(agent.tree)
        assert [known.get(joint, joint) for joint in agent.joints] == called
