"""Pushes in the course of a lift: the load goes on up its path, or everything falls."""

from __future__ import annotations

import math

import numpy as np
import pytest

from evodesign.control.gains import Feedback
from evodesign.motion.course import LiftCourse
from evodesign.motion.solution import LiftSolution
from evodesign.records import Case
from evodesign.simulation.push import Push, PushTest
from evodesign.simulation.pushed_plan import PushConditions, PushedDesign, PushedPlan
from tests.motion.conftest import lifted, solution
from tests.motion.lifted import LIFT, Lifted

__all__ = ["lifted", "solution"]


@pytest.fixture(scope="module")
def course(solution: LiftSolution) -> LiftCourse:
    assert solution.course is not None
    return solution.course


@pytest.fixture(scope="module")
def tests_in(lifted: Lifted, course: LiftCourse) -> dict[str, PushTest]:
    scene = lifted.setting.scene
    plan = PushedPlan.lift([scene], scene.robot.tree, Case(task=LIFT), course)
    return PushedDesign((plan,)).tests(PushConditions(Feedback()))


@pytest.mark.slow
def test_a_lift_is_pushed_at_a_third_and_at_two_thirds_of_its_time_on_its_path(
    tests_in: dict[str, PushTest], course: LiftCourse
) -> None:
    """The load is where the plan has it, of which the greater part of the way is still to come."""
    names = list(tests_in)
    assert names == [f"{LIFT}, after {time:.2g} s" for time in (0.5, 1.0)]
    for test, time in zip(tests_in.values(), (0.5, 1.0), strict=True):
        ended = test.pushed(Push(1e-6, 0.0), frames=True)
        assert ended.survived
        assert ended.load_off < 0.01
        height = ended.states[0][2]
        assert height == pytest.approx(float(course.heights(np.array([time]))[0]), abs=5e-3)
        assert ended.states[-1][2] == pytest.approx(LIFT.to_m, abs=5e-3)


def test_a_lift_survives_a_weak_push_and_not_a_strong_one(tests_in: dict[str, PushTest]) -> None:
    for test in tests_in.values():
        weak, strong = (test.pushed(Push(each, math.pi)) for each in (3.0, 90.0))
        assert weak.survived, weak.reason
        assert 0.0 < weak.load_off < 0.1
        assert not strong.survived


def test_a_robot_alone_is_pushed_as_it_stands_at_the_beginning_of_a_lift(
    lifted: Lifted, course: LiftCourse
) -> None:
    scene = lifted.setting.scene
    plan = PushedPlan.lift([scene], scene.robot.tree, Case(task=LIFT), course)
    (name, test), *others = plan.tests(PushConditions(), alone=True).items()
    assert (name, others) == (str(LIFT), [])
    assert test.pushed(Push(3.0, 0.0)).survived
