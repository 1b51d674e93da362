"""Lifts that there are not, and such as need more knots: a status with a sentence, soon."""

from __future__ import annotations

from dataclasses import replace

import msgspec
import pytest

from evodesign.motion import lifting
from evodesign.motion.lifting import LiftProblem
from evodesign.posture.check import AgentModel
from evodesign.records import Status
from tests.motion.lifted import LIFT, Lifted

pytestmark = pytest.mark.slow

HASTE = msgspec.structs.replace(LIFT, seconds=0.02, knots=5)
COARSE = msgspec.structs.replace(LIFT, from_m=0.7, to_m=1.2, knots=5)


def test_a_lift_that_is_too_fast_is_told_from_one_that_there_is_not(lifted: Lifted) -> None:
    found = lifted.solve(HASTE)
    assert found.status is Status.INFEASIBLE
    assert found.reason.startswith("0.9 to 1.1 m in 0.02 s is too fast")


def test_a_height_that_cannot_be_held_is_named(lifted: Lifted) -> None:
    found = lifted.solve(msgspec.structs.replace(LIFT, to_m=2.6))
    assert found.status is Status.INFEASIBLE
    assert found.reason.startswith("the load cannot be held at the end of the lift")
    assert found.attempts == ()


@pytest.fixture
def hasty(lifted: Lifted) -> Lifted:
    """Solves give up soon: where there is nothing to be found, that saves a minute."""
    setting = replace(lifted.setting, options=replace(lifted.setting.options, iterations=60))
    return replace(lifted, setting=setting, lifts=LiftProblem(setting, symmetric=True))


def test_a_height_out_of_reach_on_the_way_is_said(hasty: Lifted) -> None:
    """Feet stay where the holds have them: from there the way goes beyond what arms reach."""
    low, lift = hasty.hold(LIFT.from_m), msgspec.structs.replace(LIFT, to_m=1.7, knots=5)
    found = hasty.lifts.solve(hasty.design, lift, [low, low], hasty.robot, hasty.human)
    assert found.status not in {Status.SOLVED, Status.TIME_LIMIT}
    assert "out of reach from where the feet stand at its ends: hands or feet are 0." in found.reason


def test_solves_that_run_out_of_time_say_so(lifted: Lifted) -> None:
    holds = [lifted.hold(height) for height in (LIFT.from_m, LIFT.to_m)]
    setting = replace(lifted.setting, options=replace(lifted.setting.options, seconds=1e-3))
    lifts = LiftProblem(setting, symmetric=True)
    found = lifts.solve(lifted.design, LIFT, holds, lifted.robot, lifted.human)
    assert found.status is Status.TIME_LIMIT
    assert found.reason == "no motion 0.9 to 1.1 m in 1.5 s was found within `seconds` of [solver], 0.001 s"


def test_torque_limits_that_holds_meet_and_no_motion_are_said(hasty: Lifted) -> None:
    """Each end is held in a stance of its own, with torques that one stance for both does not do with."""
    lift, scene = msgspec.structs.replace(LIFT, from_m=0.8, to_m=1.2, knots=5), hasty.setting.scene
    holds = [hasty.hold(height) for height in (lift.from_m, lift.to_m)]
    limits = {
        joint: 0.05 + 1.05 * max(abs(hold.postures["robot"].torques[joint]) for hold in holds)
        for joint in scene.robot.joints
    }
    robot = replace(scene.robot, torque_limits=limits, limits_torques=True)
    setting = replace(hasty.setting, scene=scene.with_agents(robot))
    limited = LiftProblem(setting, symmetric=True)
    found = limited.solve(hasty.design, lift, holds, AgentModel.of(robot, scene.robot.tree), hasty.human)
    assert found.status not in {Status.SOLVED, Status.TIME_LIMIT}
    assert found.reason == "no motion 0.8 to 1.2 m in 1.5 s was found that meets all limits, however slow"


def test_a_motion_that_is_too_coarse_gets_more_knots_or_says_so(
    lifted: Lifted, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(lifting, "REFINEMENTS", 0)
    coarse = lifted.solve(COARSE)
    assert coarse.status is Status.NUMERICAL_FAILURE
    assert coarse.reason.startswith("between knots the check found")
    assert coarse.course is None
    monkeypatch.setattr(lifting, "REFINEMENTS", 3)
    finer = lifted.solve(COARSE)
    assert finer.solved
    assert finer.lift.knots > COARSE.knots
    assert finer.attempts[2].start == "motion of 5 knots"
    peak = max(effort.peak_torque for effort in finer.efforts.values())
    assert finer.checked is not None
    assert max(finer.checked.between[f"{name}.torque"] for name in finer.efforts) < 0.03 * peak
