"""Limits of stance by a person's size, and that a file's keys go before them."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from evodesign.human.anthropometry import Person, segments, sole_size
from evodesign.human.anthropometry_tables import Sex
from evodesign.human.body import human_tree
from evodesign.problem.build import build_problem
from evodesign.problem.source import read_source
from evodesign.problem.stance_limits import feet_apart, trunk_clearance
from evodesign.records import ProblemSource

PEOPLE = (Person(1.52, 50.0, Sex.FEMALE), Person(1.88, 110.0, Sex.MALE))


@pytest.mark.parametrize("person", PEOPLE, ids=["small woman", "large man"])
def test_feet_and_trunk_have_the_room_that_the_body_needs(person: Person) -> None:
    tree, h = human_tree(person), person.stature
    least, most = feet_apart(tree, sole_size(person)[1])
    leg = (0.530 - 0.039) * h  # from hip to ankle, by Drillis and Contini's shares
    assert least == pytest.approx(0.055 * h)
    assert most == pytest.approx(0.100 * h + 2.0 * leg * math.sin(math.pi / 9.0), rel=1e-3)
    # a box of the trunk's mass, about as dense as water, as broad as the hips and as high as the trunk
    trunk = sum(segment.mass for name, segment in segments(person).items() if name.endswith("trunk"))
    depth = trunk / (1000.0 * 0.191 * 0.288 * h**2)
    assert trunk_clearance(tree) == pytest.approx(depth / 2.0 + 0.02, rel=0.1)


def test_keys_of_limits_hold_for_everybody_and_a_robot_has_none_of_its_own(repository: Path) -> None:
    source = read_source(repository / "problems" / "point_grasp.toml")
    given = build_problem(source).scene
    assert given.stance_of(given.human) == given.stance_of(given.robot) == given.stance
    lines = "feet_apart_m = [0.12, 0.50]\n", "trunk_clearance_m = 0.15\n"
    text = source.text
    for line in lines:
        assert line in text
        text = text.replace(line, "")
    scene = build_problem(ProblemSource("p.toml", text, source.files)).scene
    assert scene.stance_of(scene.robot) == scene.stance == given.stance
    own = scene.stance_of(scene.human)
    assert own.feet_apart == feet_apart(scene.human.tree, scene.human.feet[0].sole.width)
    assert own.trunk_clearance == trunk_clearance(scene.human.tree)
    assert own.feet_stagger == scene.stance.feet_stagger
