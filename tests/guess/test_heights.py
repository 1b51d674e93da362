"""Heights that `init` writes: robot and people hold them, and people need not bend where it can be helped."""

from __future__ import annotations

import itertools
import math

import pytest

from evodesign.guess.body_plan import body_plan
from evodesign.guess.heights import HeldHeights, held_heights
from evodesign.guess.problem_text import guessed_problem
from evodesign.human.anthropometry import Person
from evodesign.human.anthropometry_tables import Sex
from evodesign.tree.model import Tree
from evodesign.tree.resize import resize
from tests.guess.humanoid import Build, humanoid, leg_length


@pytest.fixture(scope="module")
def held() -> HeldHeights:
    tree = humanoid(Build())
    found = held_heights(guessed_problem(tree, "robot.urdf").text, "robot.urdf", tree)
    assert found is not None
    return found


def raised(tree: Tree) -> float:
    """Height of the hands above the soles where arms point straight up [m]: a bound of the reach."""
    plan = body_plan(tree)
    arm = [body.origin for body in plan.arms["left"].bodies]
    along = sum(math.dist(one, other) for one, other in itertools.pairwise(arm))
    return float(arm[0][2]) + leg_length() + along + 0.15


def test_the_highest_load_is_below_raised_arms_and_above_the_shoulders(held: HeldHeights) -> None:
    tree = humanoid(Build())
    shoulders = float(body_plan(tree).arms["left"].bodies[0].origin[2]) + leg_length()
    assert shoulders < held.highest < raised(tree)
    assert 0.0 < held.lowest < 0.3


def test_the_tallest_persons_hands_hang_where_anthropometry_says(held: HeldHeights) -> None:
    """Of Drillis and Contini: shoulder 0.818 H, arm to the wrist 0.332 H, and about 0.05 H to the palm."""
    stature = 1.88
    assert held.hanging == pytest.approx((0.818 - 0.332 - 0.05) * stature, abs=0.03)
    assert Person(stature, 100.0, Sex.MALE).stature == stature


@pytest.mark.parametrize(
    ("ends", "heights"),
    [
        ((0.0, 2.0, 0.8), (1.0, 1.25, 1.5)),
        ((0.0, 1.5, 0.82), (0.8, 0.95, 1.1)),
        ((0.0, 1.0, 0.82), (0.65, 0.7, 0.75)),
        ((0.0, 0.4, 0.82), (0.25, 0.3)),
    ],
    ids=["tall", "as tall as people's hands", "small", "tiny"],
)
def test_heights_lie_between_hanging_hands_and_three_quarters_of_the_reach(
    ends: tuple[float, float, float], heights: tuple[float, ...]
) -> None:
    assert HeldHeights(*ends).heights == pytest.approx(heights, abs=0.051)
    assert HeldHeights(*ends).heights[-1] <= 0.75 * ends[1] + 0.025


def test_longer_arms_hold_higher_loads_and_get_higher_heights(held: HeldHeights) -> None:
    arms = {f"{side}_{name}": 1.3 for side in ("left", "right") for name in ("upper_arm", "forearm")}
    tree = resize(humanoid(Build()), arms, {})
    longer = held_heights(guessed_problem(tree, "robot.urdf").text, "robot.urdf", tree)
    assert longer is not None
    assert longer.highest > held.highest + 0.01
    assert longer.heights[-1] >= held.heights[-1]


def test_nothing_is_known_of_a_robot_without_hands() -> None:
    tree = humanoid(Build(arms=False))
    guessed = guessed_problem(tree, "robot.urdf")
    assert held_heights(guessed.text, "robot.urdf", tree) is None
    assert "# from the hips to the shoulders" in guessed.text
