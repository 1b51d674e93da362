"""Holds and lifts under Newton's laws: they stand and follow their plan, and what is wrong is seen."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import msgspec
import numpy as np
import pytest

from evodesign.control.gains import Feedback
from evodesign.errors import InputError
from evodesign.mechanics.agent import SIDES
from evodesign.mechanics.payload import Grasp
from evodesign.posture.results import AgentPosture
from evodesign.simulation.model import STEP
from evodesign.simulation.outcome import Rollout, SimulationOutcome, outcome_of
from evodesign.simulation.plan import hold_plan, lift_plan
from evodesign.simulation.rollout import rolled_out
from tests.motion.lifted import LIFT, Lifted
from tests.simulation.conftest import HEIGHT, Held


def holding(
    held: Held, seconds: float, feedback: Feedback | None = None, **changed: AgentPosture
) -> tuple[Rollout, SimulationOutcome]:
    plan = hold_plan({**held.solution.postures, **changed}, HEIGHT, seconds, STEP)
    rollout = rolled_out(held.scene, held.trees, plan, feedback or Feedback())
    return rollout, outcome_of(plan, rollout)


@pytest.mark.parametrize("grasp", Grasp)
def test_a_hold_stands_with_the_torques_and_wrenches_of_its_plan(
    held_with: Callable[[Grasp], Held], grasp: Grasp
) -> None:
    held = held_with(grasp)
    rollout, outcome = holding(held, 1.0)
    assert outcome.stands
    assert outcome.seconds == 1.0
    assert outcome.drift < 1e-3
    for name, agent in outcome.agents.items():
        assert agent.slip < 1e-3
        assert agent.torque < max(0.05 * agent.peak, 0.02), "a rigid grasp leaves the robot next to nothing"
        posture = held.solution.postures[name]
        for row, side in enumerate(SIDES):
            foot, hand = rollout.agents[name].feet[-1, row], rollout.agents[name].hands[-1, row]
            assert foot == pytest.approx(posture.wrenches[f"{side}_foot"], abs=0.5)
            assert hand == pytest.approx(posture.wrenches[f"{side}_hand"], abs=0.1)


def test_half_the_step_gives_the_same_motion(held: Held) -> None:
    """A robot that begins with wrong torques in its ankles moves, and how depends on no step."""
    robot = held.solution.postures["robot"]
    torques = {**robot.torques, "l_ankle_pitch": robot.torques["l_ankle_pitch"] + 10.0}
    postures = {**held.solution.postures, "robot": replace(robot, torques=torques)}
    ends = []
    for step in (STEP, STEP / 2.0):
        plan = hold_plan(postures, HEIGHT, 0.3, step)
        rollout = rolled_out(held.scene, held.trees, plan, Feedback())
        ends.append(rollout.agents["robot"].positions[-1] - plan.agents["robot"].positions[-1])
    assert np.abs(ends[0]).max() > 1e-3
    assert ends[1] == pytest.approx(ends[0], abs=0.05 * np.abs(ends[0]).max())


def test_who_has_no_feedback_to_speak_of_falls(held: Held) -> None:
    _, outcome = holding(held, 3.0, Feedback(0.1))
    assert not outcome.stands
    assert outcome.seconds < 3.0


def test_wrong_torques_and_motors_at_their_limit_are_seen(held: Held) -> None:
    robot = held.solution.postures["robot"]
    worst = max(robot.torques, key=lambda joint: abs(robot.torques[joint]))
    limited = replace(held.scene.robot, torque_limits={worst: 0.5 * abs(robot.torques[worst])})
    weak = replace(held, scene=held.scene.with_agents(limited))
    _, outcome = holding(weak, 0.5)
    assert outcome.agents["robot"].at_limit == (worst,)
    assert outcome.agents["robot"].torque_share > 0.4


@pytest.mark.parametrize(
    ("key", "value"), [("frequency", 0.0), ("damping", -1.0), ("frequency", float("nan"))]
)
def test_what_is_no_feedback_is_refused_by_name(key: str, value: float) -> None:
    with pytest.raises(InputError, match=key):
        Feedback(**{key: value})


@pytest.mark.slow
def test_a_lift_follows_its_path(lifted: Lifted) -> None:
    solution = lifted.solve(msgspec.structs.replace(LIFT, knots=16))
    assert solution.course is not None
    plan = lift_plan(solution.course, STEP)
    assert plan.times[-1] == pytest.approx(solution.lift.seconds)
    trees = {model.agent.name: model.tree for model in (lifted.robot, lifted.human)}
    outcome = outcome_of(plan, rolled_out(lifted.setting.scene, trees, plan, Feedback()))
    assert outcome.stands
    assert outcome.drift < 1e-2
    for agent in outcome.agents.values():
        assert agent.slip < 1e-3
        assert agent.torque_share < 0.05
