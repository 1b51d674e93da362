"""Notes are written for limits whose sign is wrong, and for nothing else but what a problem leaves out."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from evodesign.human.measured_posture import measured_posture
from evodesign.problem.build import DesignProblem
from evodesign.problem.left_out import left_out
from evodesign.problem.notes import notes
from evodesign.records import Lift
from evodesign.tasks.lift import LoadProfile, minimum_jerk
from evodesign.tree.model import Joint

Limits = tuple[float, float]


def with_joint(problem: DesignProblem, joint: Joint) -> DesignProblem:
    """The problem whose person has this joint in the place of its own of that name."""
    scene, tree = problem.scene, problem.scene.human.tree
    joints = tuple(joint if other.name == joint.name else other for other in tree.joints)
    human = replace(scene.human, tree=replace(tree, joints=joints))
    return replace(problem, scenes=(scene.with_agents(human),))


def changed(
    problem: DesignProblem, name: str, degrees: Limits, axis: tuple[float, float, float] | None = None
) -> DesignProblem:
    joint = problem.scene.human.tree.joint_by_name[name]
    lower, upper = (math.radians(limit) for limit in degrees)
    return with_joint(problem, replace(joint, lower=lower, upper=upper, axis=axis or joint.axis))


def strange(problem: DesignProblem) -> tuple[str, ...]:
    """The notes but for those on what the problem leaves out, which come last."""
    found, last = notes(problem), left_out(problem.source)
    assert last
    assert found[-len(last) :] == last
    return found[: -len(last)]


def test_nothing_is_noted_of_a_generated_person(problem: DesignProblem) -> None:
    assert strange(problem) == ()


def test_a_hip_that_bends_backwards_is_noted_with_both_ranges(problem: DesignProblem) -> None:
    (sentence,) = strange(changed(problem, "jLeftHip_roty", (-15.0, 120.0)))
    assert sentence == (
        "human: joint jLeftHip_roty turns from -15 to 120 degrees, where a person's turns from -120 to 15 "
        "degrees: its limits seem to have the wrong sign"
    )


@pytest.mark.parametrize("limits", [(-105.5, 0.5), (-134.5, 29.5), (-120.0, 15.0)])
def test_a_person_a_little_stiffer_or_suppler_is_not_noted(problem: DesignProblem, limits: Limits) -> None:
    assert strange(changed(problem, "jLeftHip_roty", limits)) == ()


@pytest.mark.parametrize("limits", [(-0.5, 105.5), (-29.5, 134.5)])
def test_it_is_noted_with_its_limits_turned(problem: DesignProblem, limits: Limits) -> None:
    assert len(strange(changed(problem, "jLeftHip_roty", limits))) == 1


@pytest.mark.parametrize("limits", [(-60.0, 60.0), (0.0, 40.0), (-math.inf, math.inf)])
def test_limits_that_fit_neither_way_are_not_noted(problem: DesignProblem, limits: Limits) -> None:
    assert strange(changed(problem, "jLeftHip_roty", limits)) == ()


@pytest.mark.parametrize("limits", [(-40.0, 40.0), (-42.0, 41.0), (-45.0, 36.0)])
def test_a_range_that_is_nearly_even_is_not_noted(problem: DesignProblem, limits: Limits) -> None:
    """The ankle bends 30 degrees up and 50 down: turning these makes little difference."""
    assert strange(changed(problem, "jLeftAnkle_roty", limits)) == ()


def test_a_smaller_range_is_noted_if_turning_it_makes_it_right(problem: DesignProblem) -> None:
    assert len(strange(changed(problem, "jLeftAnkle_roty", (-50.0, 30.0)))) == 1


def test_limits_count_about_the_axis_that_the_joint_has(problem: DesignProblem) -> None:
    """About -y hip flexion is positive: -15 to 120 is right, and -120 to 15 is wrong."""
    down = (0.0, -1.0, 0.0)
    assert strange(changed(problem, "jLeftHip_roty", (-15.0, 120.0), down)) == ()
    (sentence,) = strange(changed(problem, "jLeftHip_roty", (-120.0, 15.0), down))
    assert "from -120 to 15 degrees, where a person's turns from -15 to 120 degrees" in sentence


def test_a_joint_about_another_axis_is_not_judged(problem: DesignProblem) -> None:
    assert strange(changed(problem, "jLeftHip_roty", (-15.0, 120.0), (1.0, 0.0, 0.0))) == ()


def test_a_joint_with_a_name_of_its_own_is_not_judged(problem: DesignProblem) -> None:
    turned = changed(problem, "jLeftHip_roty", (-15.0, 120.0))
    tree = turned.scene.human.tree
    renamed = tuple(
        replace(joint, name="hip") if joint.name == "jLeftHip_roty" else joint for joint in tree.joints
    )
    human = replace(turned.scene.human, tree=replace(tree, joints=renamed), joints=("hip",))
    assert strange(replace(turned, scenes=(turned.scene.with_agents(human),))) == ()


def test_a_joint_that_is_held_outside_of_its_range_is_noted(problem: DesignProblem) -> None:
    held = next(name for name in problem.scene.human.tree.actuated if name not in problem.scene.human.joints)
    joint = problem.scene.human.tree.joint_by_name[held]
    sentences = notes(with_joint(problem, replace(joint, lower=0.5, upper=1.0)))
    said = f"held at zero, as `joints` does not name them, but outside of their ranges: {held} (0.5 to 1)"
    wanted = f"{problem.scene.human.tree.name}: {said}"
    assert wanted in sentences


def test_heights_at_which_nobody_was_measured_are_named(problem: DesignProblem) -> None:
    """Palms of the 1.82 m person between 0.44 and 0.54 of stature: with the load at 0.8 m, not at 1 m."""
    human = replace(problem.scene.human, measured=measured_posture(1.82))
    built = replace(problem, scenes=(problem.scene.with_agents(human),))
    assert strange(problem) == ()
    assert strange(built) == (
        "human: how measured people stand with the load at 0.8 m is an assumption: nobody was measured who "
        "held one between 0.44 and 0.54 of stature",
    )


STEP = 1e-4
"""Of the share of a lift's time, for differences."""


def test_a_lift_that_accelerates_the_load_faster_than_it_falls_is_noted(problem: DesignProblem) -> None:
    """The acceleration is that of finite differences of the profile."""
    shares = [STEP * place for place in range(1, 10000)]
    bends = [minimum_jerk(s + STEP) - 2.0 * minimum_jerk(s) + minimum_jerk(s - STEP) for s in shares]
    least = math.sqrt(0.4 * max(bends) / STEP**2 / 9.81)
    lifts = [Lift(from_m=0.8, to_m=1.2, seconds=seconds) for seconds in (0.01, 0.999 * least, 1.001 * least)]
    found = strange(replace(problem, tasks=tuple(lifts)))
    assert [sentence.split(": ")[0] for sentence in found] == ["task.lift[0].seconds", "task.lift[1].seconds"]
    assert found[0].endswith(f" push it down; wanted at least {least:.2f} s")


def test_a_free_lift_may_take_less_time_than_one_of_minimum_jerk(problem: DesignProblem) -> None:
    """At best it speeds up and slows down equally, half of the time each: way = g (T / 2)^2."""
    for seconds, noted in ((2.0 * math.sqrt(0.4 / 9.81) - 1e-3, 1), (2.0 * math.sqrt(0.4 / 9.81) + 1e-3, 0)):
        lift = Lift(from_m=0.8, to_m=1.2, seconds=seconds, profile=LoadProfile.FREE)
        assert len(strange(replace(problem, tasks=(lift,)))) == noted
