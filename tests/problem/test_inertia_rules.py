"""What `check` says of links whose shapes and file disagree about their inertia."""

from __future__ import annotations

import re

import numpy as np
import pytest

from evodesign.guess.problem_text import guessed_problem
from evodesign.problem.build import build_problem
from evodesign.problem.inertia_rules import rule_differences
from evodesign.records import ProblemSource
from evodesign.tree.urdf_read import InertiaRule
from evodesign.tree.urdf_write import urdf_text
from tests.guess.humanoid import Build, humanoid

CENTER = re.compile(r'(<inertial>\s*<origin xyz="0\.0 0\.0 )-0\.19"')
"""That of both thighs."""


@pytest.mark.parametrize("rule", InertiaRule)
def test_a_centre_of_mass_that_shapes_would_move_is_named(rule: InertiaRule) -> None:
    urdf, count = CENTER.subn(r'\1-0.09"', urdf_text(humanoid(Build())))
    assert count == 2
    text = guessed_problem(humanoid(Build()), "robot.urdf").text
    text = text.replace("[robot]", f'[robot]\ninertia = "{rule}"')
    problem = build_problem(ProblemSource(path="p", text=text, files={"robot.urdf": urdf}))
    found = rule_differences(problem)
    assert [each.link for each in found] == ["left_thigh", "right_thigh"]
    assert found[0].center_m == pytest.approx(0.1)
    assert found[0].taken == (InertiaRule.FILE if rule is InertiaRule.FILE else InertiaRule.SHAPES)
    box = 2.28 / 12.0 * np.array([0.02, 0.1**2 + 0.38**2, 0.1**2 + 0.38**2])
    assert np.allclose(found[0].moments_kg_m2, [box, box], rtol=1e-9)


def test_a_robot_whose_file_says_what_its_shapes_say_has_none() -> None:
    text = guessed_problem(humanoid(Build()), "robot.urdf").text
    source = ProblemSource(path="p", text=text, files={"robot.urdf": urdf_text(humanoid(Build()))})
    assert rule_differences(build_problem(source)) == ()
