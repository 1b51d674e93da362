"""The `[collisions]` table: what it makes of a problem, and what is refused."""

from __future__ import annotations

import pytest

from evodesign.collision.pairs import checked_pairs
from evodesign.collision.rules import FLOOR, LOAD
from evodesign.errors import InputError
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.model_json import model_json
from evodesign.records import ProblemSource


def with_table(problem: DesignProblem, *lines: str) -> ProblemSource:
    """The point-grasp problem with the table."""
    text = "\n".join((problem.source.text, "[collisions]", *lines, ""))
    return ProblemSource("p.toml", text, problem.source.files)


def refused(problem: DesignProblem, *lines: str) -> str:
    with pytest.raises(InputError) as caught:
        build_problem(with_table(problem, *lines))
    return str(caught.value)


def test_without_the_table_nothing_is_kept_apart(problem: DesignProblem) -> None:
    assert all(agent.collisions is None for agent in (problem.scene.robot, problem.scene.human))
    assert "collisions" not in model_json(problem)


def test_pairs_are_found_ignored_and_added(problem: DesignProblem) -> None:
    built = build_problem(with_table(problem))
    rules = built.scene.robot.collisions
    assert rules is not None
    assert rules.margin == 0.005
    assert {("l_upper_leg", "r_upper_leg"), ("head", LOAD), ("l_hand", FLOOR)} <= set(rules.checked)
    assert ("l_hand", LOAD) not in rules.checked
    assert ("l_upper_leg", "l_lower_leg") not in rules.checked
    shown = model_json(built)["collisions"]
    assert shown["margin_m"] == 0.005
    assert ["head", LOAD] in shown["pairs"]["robot"]
    other = build_problem(
        with_table(
            problem,
            "margin_m = 0.01",
            'ignore = [["head", "load"], ["r_upper_leg", "l_upper_leg"]]',
            'part = [["l_hand", "load"]]',
        )
    ).scene.robot.collisions
    assert other is not None
    assert other.margin == 0.01
    assert set(rules.checked) - set(other.checked) == {("head", LOAD), ("l_upper_leg", "r_upper_leg")}
    assert other.parted[-1] == ("l_hand", LOAD)
    assert {pair[0] for pair in other.parted[:-1]} == {"l_ankle_2", "l_foot_rear", "l_foot_front"}


def test_a_pair_that_always_overlaps_in_some_design_is_a_matter_of_its_build(problem: DesignProblem) -> None:
    """Trunks with short links rest on their hips."""
    rules = build_problem(with_table(problem)).scene.robot.collisions
    assert rules is not None
    assert ("torso_2", "l_hip_2") not in rules.checked


def test_what_cannot_be_meant_is_refused(problem: DesignProblem) -> None:
    wanted = "wanted a link of the robot or of a person, found 'hed'; did you mean 'head'?"
    assert wanted in refused(problem, 'ignore = [["hed", "chest"]]')
    assert "collisions.part[0]" in refused(problem, 'part = [["head", "LeftHand"]]')
    both = refused(problem, 'part = [["head", "load"]]', 'ignore = [["head", "load"]]')
    assert "wanted a pair that is not ignored, found 'head' and 'load' among those ignored" in both
    assert "margin_m" in refused(problem, "margin_m = -0.1")


def test_everyone_keeps_clear_of_the_same(problem: DesignProblem) -> None:
    """A pair that rests on each other in one person is no pair of the others: rows fit everybody's starts."""
    person = 'stature_m = 1.82\nmass_kg = 72.7\nsex = "male"'
    assert person in problem.source.text
    several = problem.source.text.replace(person, 'population = { sex = "both", percentiles = [5, 95] }')
    built = build_problem(ProblemSource("p.toml", f"{several}\n[collisions]\n", problem.source.files))
    alone = [
        set(checked_pairs(each.human.tree, each.human.joints, each.human.hands, each.human.soles))
        for each in built.scenes
    ]
    assert len(alone) == 4
    assert set.union(*alone) != set.intersection(*alone)
    for scene in built.scenes:
        assert scene.human.collisions is not None
        assert set(scene.human.collisions.checked) == set.intersection(*alone)
