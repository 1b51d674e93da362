"""Pushes against closed forms, and what ends a simulation."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from evodesign.control.gains import Feedback
from evodesign.errors import InputError
from evodesign.records import Case
from evodesign.simulation.controlled import Timing
from evodesign.simulation.engine import engine_named
from evodesign.simulation.installed import EngineName
from evodesign.simulation.push import BACK, SURVIVING, Push, PushOutcome, PushTest, Recovery
from evodesign.simulation.push_margin import DIRECTIONS, FASTEST, SMALLEST, least_margin, margins
from evodesign.simulation.pushable import refuse_unpushable
from evodesign.simulation.pushed_plan import PushConditions, PushedDesign, PushedPlan, pushed_cases
from evodesign.tasks import Hold, Lift
from tests.control.pendulum import Pendulum
from tests.simulation.conftest import HEIGHT, Held
from tests.simulation.engines import SLOW_IN_DRAKE


@pytest.mark.parametrize(
    "pendulum", [Pendulum(0.16), Pendulum(0.24), Pendulum(0.24, 20.0), Pendulum(0.24, 40.0)], ids=str
)
@pytest.mark.parametrize("engine", SLOW_IN_DRAKE)
def test_a_pendulum_survives_until_its_capture_point_leaves_the_sole(
    pendulum: Pendulum, engine: EngineName
) -> None:
    """The largest impulse is the closed form's, so it grows with sole and torque as that does.

    Within 5 % in MuJoCo, whose floor gives way, and 2 % in Drake.
    """
    within = {EngineName.MUJOCO: 0.05, EngineName.DRAKE: 0.02}[engine]
    tests, impulse = pendulum.test(engine=engine_named(engine)), pendulum.survived()
    shares = (*sorted({0.95, 1.0 - within}), 1.0 + within)
    *weak, strong = (tests.pushed(Push(share * impulse, 0.0, seconds=0.02)) for share in shares)
    assert all(each.survived for each in weak)
    assert strong.reason == "robot falls"
    assert weak[0].recovery is not None
    assert 0.0 < weak[0].recovery < weak[0].seconds


def test_who_is_near_the_plan_but_goes_away_from_it_is_not_taken_for_back() -> None:
    """On a sole of 6 cm a capture point is lost 3 cm from its middle."""
    pendulum = Pendulum(0.06)
    outcome = pendulum.test().pushed(Push(1.1 * pendulum.survived(), 0.0, seconds=0.02), awaited=SURVIVING)
    assert outcome.reason == "robot falls"


class Straight(PushTest):
    """Survives what is below an impulse that depends on the direction alone."""

    def __init__(self, *, turned: float = 0.5, largest: float = 14.0) -> None:
        self.tried: list[Push] = []
        self.turned, self.is_symmetric, self.largest = turned, turned == 0.0, largest

    def limit(self, direction: float) -> float:
        return self.largest * (10.0 - 4.0 * math.cos(direction - self.turned)) / 14.0

    def pushed(self, push: Push, frames: bool = False, awaited: Recovery = BACK) -> PushOutcome:
        self.tried.append(push)
        reason = "" if push.impulse < self.limit(push.direction) else "robot falls"
        return PushOutcome(push, reason, 1.0, None, 0.0, 0.0, 0.0)


def test_bisection_finds_the_limit_in_each_direction_and_the_least_with_fewer_trials() -> None:
    every, least = Straight(), Straight()
    found = margins({"hold": every}, "robot", 30.0)
    assert len(found) == 8
    for margin in found:
        assert every.limit(margin.direction) * 0.975 < margin.impulse <= every.limit(margin.direction)
        assert margin.reason == "robot falls"
    weakest = least_margin({"hold": least}, "robot", 30.0)
    assert weakest is not None
    limits = [least.limit(each.direction) for each in found]
    assert 0.975 * min(limits) < weakest.impulse <= min(limits)
    assert weakest.trials == len(least.tried) < len(every.tried) / 2
    assert least_margin({}, "robot", 30.0) is None


@pytest.mark.parametrize("largest", [2.0, 14.0, 60.0, 200.0])
def test_no_impulse_is_tried_twice_and_those_who_are_weaker_alone_are_bisected(largest: float) -> None:
    tests = {"low": Straight(largest=largest), "high": Straight(turned=2.0, largest=0.99 * largest)}
    found = least_margin(tests, "robot", 30.0)
    assert found is not None
    limit = min(test.limit(each) for test in tests.values() for each in DIRECTIONS)
    assert 0.979 * limit - SMALLEST < found.impulse <= limit
    assert tests[found.moment].limit(found.direction) == limit
    tried = [(name, push.direction, push.impulse) for name, test in tests.items() for push in test.tried]
    assert len(set(tried)) == len(tried) == found.trials < 40


def test_a_margin_ends_at_what_is_tried_at_most_and_at_nothing() -> None:
    strong, weak = Straight(largest=1e6), Straight(largest=1e-6)
    for test, impulse, reason in ((strong, FASTEST * 30.0, ""), (weak, 0.0, "robot falls")):
        found = least_margin({"hold": test}, "robot", 30.0)
        assert found is not None
        assert (found.impulse, found.reason) == (impulse, reason)


def pushed(held: Held, conditions: PushConditions | None = None, *, alone: bool = False) -> PushTest:
    plan = PushedPlan("hold", held.scene, held.trees, held.solution.postures, HEIGHT)
    return PushedDesign((plan,), alone).tests(conditions or PushConditions())["hold"]


def test_of_two_mirrored_directions_one_is_pushed_where_everything_is_its_own_mirror_image() -> None:
    mirrored = Straight(turned=0.0)
    found = margins({"hold": mirrored}, "robot", 30.0)
    assert [math.degrees(each.direction) for each in found] == pytest.approx(
        [math.degrees(each) for each in DIRECTIONS]
    )
    for margin in found:
        assert mirrored.limit(margin.direction) * 0.975 < margin.impulse <= mirrored.limit(margin.direction)
    assert len({push.direction for push in mirrored.tried}) == 5
    few = margins({"hold": Straight(turned=0.0)}, "robot", 30.0, [math.radians(270.0)])
    assert [each.direction for each in few] == [math.radians(270.0)]


@pytest.mark.parametrize("direction", [90.0, 135.0])
def test_a_push_to_the_left_does_what_one_to_the_right_does(pushed_hold: PushTest, direction: float) -> None:
    assert pushed_hold.is_symmetric
    left, right = (
        pushed_hold.pushed(Push(8.0, math.radians(turn))) for turn in (direction, 360.0 - direction)
    )
    assert (left.reason, left.seconds, left.recovery) == (right.reason, right.seconds, right.recovery)
    assert left.load_off == pytest.approx(right.load_off, rel=1e-6)


def test_a_posture_that_leans_to_a_side_is_no_mirror_image(held: Held) -> None:
    robot = held.solution.postures["robot"]
    leaning = {**held.solution.postures, "robot": replace(robot, joints={**robot.joints, "torso_roll": 1e-3})}
    plan = PushedPlan("hold", held.scene, held.trees, held.solution.postures, HEIGHT)
    assert plan.is_symmetric
    assert not replace(plan, postures=leaning).is_symmetric


@pytest.fixture(scope="module")
def pushed_hold(held: Held) -> PushTest:
    return pushed(held)


@pytest.mark.parametrize("engine", SLOW_IN_DRAKE)
def test_a_push_is_survived_or_not_and_told_alike_each_time(held: Held, engine: EngineName) -> None:
    conditions = PushConditions(engine=engine_named(engine))
    pushed_hold = pushed(held, conditions)
    weak, strong, again = (pushed_hold.pushed(Push(each, 0.0)) for each in (8.0, 80.0, 8.0))
    assert weak.survived
    assert weak.recovery is not None
    assert 0.0 < weak.load_off < 0.1
    fields = ("seconds", "recovery", "load_off", "saturation", "capture")
    assert [getattr(again, each) for each in fields] == [getattr(weak, each) for each in fields]
    assert not strong.survived
    assert np.isfinite([strong.seconds, strong.load_off, strong.capture]).all()


@pytest.mark.parametrize("direction", [0.0, 90.0])
def test_who_comes_near_the_plan_after_a_push_comes_back(pushed_hold: PushTest, direction: float) -> None:
    push = Push(20.0, math.radians(direction))
    near, back = (pushed_hold.pushed(push, awaited=each) for each in (SURVIVING, BACK))
    assert near.survived
    assert back.survived
    assert near.seconds < back.seconds
    assert near.capture == back.capture


def test_late_sensors_and_another_load_change_what_a_push_does(held: Held, pushed_hold: PushTest) -> None:
    known = pushed_hold.pushed(Push(8.0, math.pi))
    for conditions in (PushConditions(timing=Timing(delay=1)), PushConditions(mass=1.05)):
        changed = pushed(held, conditions)
        assert changed.pushed(Push(8.0, math.pi)).capture != known.capture


def test_a_robot_alone_stands_above_its_soles_and_is_pushed(held: Held) -> None:
    outcome = pushed(held, alone=True).pushed(Push(5.0, 0.0))
    assert outcome.survived
    assert outcome.load_off == 0.0


def test_a_controller_too_slow_to_stand_says_who_falls(held: Held) -> None:
    slow = PushConditions(Feedback(0.05, 0.05))
    outcome = pushed(held, slow).pushed(Push(20.0, 0.0))
    assert not outcome.survived
    assert outcome.reason


def test_the_lowest_and_highest_hold_of_every_person_and_load_and_all_lifts_are_pushed() -> None:
    lift = Case(task=Lift(from_m=0.5, to_m=1.5))
    holds = {
        person: [Case(person=person, task=Hold(height_m=height)) for height in (1.1, 0.8, 1.4)]
        for person in ("short", "tall")
    }
    kept = pushed_cases([*holds["short"], lift, *holds["tall"][:1]])
    assert kept == (*holds["short"][1:], lift, holds["tall"][0])


def test_where_nothing_is_found_or_nobody_stands_on_feet_nobody_is_pushed(held: Held) -> None:
    with pytest.raises(InputError, match="a hold or a lift that was found"):
        PushedDesign(())
    human = replace(held.scene.human, contacts=held.scene.human.hands)
    for scene, found in (
        (held.scene.with_agents(human), "'human', which stands on something else"),
        (held.scene.only(human), "people alone"),
    ):
        with pytest.raises(InputError, match=found):
            refuse_unpushable(scene)
