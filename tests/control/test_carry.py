"""Robot and person walk with the load: their controllers on one foot, how walks end, and what is no walk."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import count

import numpy as np
import pytest

from evodesign.control.controller import Command, WholeBodyController
from evodesign.control.limits import JointLimits
from evodesign.control.moving_body import MovingBody
from evodesign.control.stance import ready_stance
from evodesign.control.target import Target, target_of
from evodesign.errors import InputError
from evodesign.evaluation.carries import CarriedCase, carried_holds
from evodesign.mechanics.contact import foot_margins
from evodesign.mechanics.floating_base import ROOT
from evodesign.simulation.carry import carried
from evodesign.simulation.pushed_plan import PushConditions, PushedPlan
from tests.simulation.conftest import HEIGHT, Held

FORWARDS, DISTANCE = 0.0, 0.2
Answer = tuple[MovingBody, np.ndarray, np.ndarray, Target, Command]
"""A controller's body, its state, what it was to do, and what it answered."""


def plan_of(held: Held) -> PushedPlan:
    return PushedPlan("hold", held.scene, held.trees, held.solution.postures, HEIGHT)


def weak(held: Held, torque: float) -> PushedPlan:
    """The hold with a robot whose joints have torque limits [N m]."""
    robot = held.scene.robot
    limited = replace(robot, torque_limits=dict.fromkeys(robot.joints, torque))
    return replace(plan_of(held), scene=held.scene.with_agents(limited))


@pytest.fixture(scope="module")
def answers() -> list[Answer]:
    """Every fifth answer of the controllers of `walked`."""
    return []


@pytest.fixture(scope="module")
def walked(held: Held, answers: list[Answer]) -> CarriedCase:
    command, calls = WholeBodyController.command, count()

    def recorded(self: WholeBodyController, q: np.ndarray, v: np.ndarray, target: Target) -> Command:
        found = command(self, q, v, target)
        if next(calls) % 5 == 0:
            answers.append((self.body, q.copy(), v.copy(), target, found))
        return found

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(WholeBodyController, "command", recorded)
        (case,) = carried_holds([plan_of(held)], (DISTANCE, FORWARDS), None, PushConditions())
    return case


def test_robot_and_person_walk_with_a_level_load_and_stand(walked: CarriedCase) -> None:
    outcome = walked.outcome
    assert outcome.reason == ""
    assert outcome.steps >= 3
    assert outcome.distance == pytest.approx(DISTANCE, abs=5e-3)
    assert 0.0 < outcome.tilt < math.radians(5.0)
    assert 0.0 < outcome.load_off < 0.05
    for name in ("robot", "human"):
        assert 0.0 < outcome.agents[name].capture < 0.05
        assert walked.energy[name] > 0.0
        last = outcome.instants[name][-1]
        assert max(map(abs, last.speeds.values())) < 0.05
        assert len(outcome.instants[name]) == len(outcome.states)


def test_feet_swing_clear_of_the_floor_and_land_where_they_shall(held: Held, walked: CarriedCase) -> None:
    """Soles of the recording: those that swing are above the floor, all have moved by the whole way."""
    for agent in held.scene.agents:
        body = MovingBody(agent, held.trees[agent.name])
        soles, forces = [], []
        for posture in walked.outcome.instants[agent.name]:
            q = body.posed(posture.base_position, posture.base_angles, posture.joints)
            soles.append([foot.place for foot in body.at(q, np.zeros(body.size)).feet])
            forces.append([posture.wrenches[foot.name][2] for foot in agent.feet])
        way = np.array(soles) - soles[0]
        assert way[-1, :, 0] == pytest.approx(DISTANCE, abs=5e-3)
        assert way[-1, :, 1:] == pytest.approx(0.0, abs=5e-3)
        assert (way[:, :, 2].max(axis=0) > 0.01).all()
        assert way[:, :, 2].min() > -1e-3
        slips = np.linalg.norm(np.diff(way[:, :, :2], axis=0), axis=2)
        loaded = np.array(forces)[1:] > 0.3 * np.sum(forces[0])
        assert slips[loaded].max() < 5e-4, "a foot that carries a third of the weight stays where it is"


def test_on_one_foot_torques_give_the_accelerations_within_all_limits(
    held: Held, walked: CarriedCase, answers: list[Answer]
) -> None:
    """Pinocchio's inverse dynamics at the states of a walk; a swing foot passes nothing on."""
    swung = 0
    for body, q, v, target, command in answers:
        assert command.reason == ""
        force = body.inverse_dynamics(q, v, command.acceleration, command.feet, command.hands)
        assert np.abs(force[:ROOT]).max() < 1e-8 * body.total * 9.81
        assert command.torques == pytest.approx(force[body.rates], abs=1e-8 * body.total * 9.81)
        for place, (foot, wrench) in enumerate(zip(body.agent.feet, command.feet, strict=True)):
            if place in target.swings:
                swung += 1
                assert not wrench.any()
                sole, course = body.at(q, v).feet[place], target.swings[place]
                assert np.linalg.norm(sole.place - course.place) < 0.02
            else:
                assert min(foot_margins(wrench, foot.sole, held.scene.ground)) > -1e-6 * body.total
    assert swung > len(answers) / 4


def test_who_stands_ready_has_feet_under_the_hips_and_is_in_balance(held: Held) -> None:
    for agent in held.scene.agents:
        body = MovingBody(agent, held.trees[agent.name])
        hold = target_of(body, held.solution.postures[agent.name])
        limits = JointLimits.of(agent, held.trees[agent.name])
        found = ready_stance(body, hold, limits, np.array([0.12, 0.0]))
        assert found.reason == ""
        motion = body.at(found.target.coordinates, found.target.velocity)
        for foot, leg in zip(motion.feet, body.legs(found.target.coordinates), strict=True):
            assert foot.turn == pytest.approx(agent.turn, abs=1e-3)
            assert leg.top[1] == pytest.approx(foot.place[1], abs=0.05)
        for hand, held_at in zip(motion.hands, hold.hands, strict=True):
            assert hand.place == pytest.approx(held_at.place, abs=5e-3)
        forces = body.inverse_dynamics(
            found.target.coordinates,
            np.zeros(body.size),
            np.zeros(body.size),
            found.target.feet_wrenches,
            found.target.hand_wrenches,
        )
        assert np.abs(forces[:3]).max() < 1e-4 * found.weight
        assert np.abs(forces[3:ROOT]).max() < 2e-2 * found.weight, "the pressure point is within 2 cm"


def test_who_cannot_stand_ready_does_not_begin_and_says_so(held: Held) -> None:
    plan = plan_of(held)
    robot = plan.postures["robot"]
    lifted = replace(robot, base_position=robot.base_position + np.array([0.0, 0.0, 0.5]))
    outcome = carried(
        replace(plan, postures={**plan.postures, "robot": lifted}), DISTANCE, 0.0, PushConditions()
    )
    assert outcome.reason.startswith("robot cannot stand ready to walk: its ")
    assert (outcome.seconds, outcome.agents, len(outcome.states)) == (0.0, {}, 0)


def test_a_robot_too_weak_for_one_leg_falls_and_its_figures_are_finite(held: Held) -> None:
    outcome = carried(weak(held, 8.0), DISTANCE, FORWARDS, PushConditions())
    assert outcome.reason
    assert 0.0 < outcome.seconds < 3.0
    robot = outcome.agents["robot"]
    assert robot.torque <= 8.0 * (1.0 + 1e-6)
    assert robot.saturated
    figures = [outcome.tilt, outcome.load_off, outcome.distance, robot.saturation, robot.capture]
    assert np.isfinite(figures).all()


def test_another_load_is_shared_as_the_hold_shares_its_own(held: Held) -> None:
    for distance, load, key in ((0.0, None, "--distance"), (1.0, math.nan, "--load")):
        with pytest.raises(InputError, match=key):
            list(carried_holds([plan_of(held)], (distance, 0.0), load, PushConditions()))
