"""A controller's torques against pinocchio, its limits, and the plan that it keeps."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from evodesign.control.controller import LEVEL, Command, WholeBodyController, wrench_weights
from evodesign.control.gains import Feedback
from evodesign.control.limits import JointLimits
from evodesign.control.moving_body import MovingBody
from evodesign.control.quadratic import least_squares
from evodesign.control.target import Target, target_of
from evodesign.mechanics.contact import foot_margins
from evodesign.mechanics.floating_base import ROOT
from evodesign.mechanics.payload import Grasp
from evodesign.mechanics.scene import Scene
from evodesign.simulation.controlled import ControlledScene, Timing, hand_share
from evodesign.simulation.engine import engine_named
from evodesign.simulation.installed import EngineName
from tests.simulation.conftest import HEIGHT, Held
from tests.simulation.engines import SLOW_IN_DRAKE

LIMIT = 60.0


def limited(held: Held) -> Scene:
    """The scene with a robot whose joints have torque limits."""
    robot = held.scene.robot
    return held.scene.with_agents(replace(robot, torque_limits=dict.fromkeys(robot.joints, LIMIT)))


def controlled(
    held: Held, scene: Scene, timing: Timing, engine: EngineName = EngineName.MUJOCO
) -> ControlledScene:
    postures = held.solution.postures
    targets = {a.name: target_of(MovingBody(a, held.trees[a.name]), postures[a.name]) for a in scene.agents}
    return ControlledScene(
        scene,
        held.trees,
        postures,
        HEIGHT,
        lambda _: targets,
        Feedback(),
        timing,
        engine=engine_named(engine),
    )


@pytest.mark.parametrize("grasp", Grasp)
def test_after_a_push_torques_give_the_accelerations_within_all_limits(
    held_with: Callable[[Grasp], Held], grasp: Grasp
) -> None:
    """Pinocchio's inverse dynamics at the states that MuJoCo comes through, every 10 ms."""
    held = held_with(grasp)
    scene = limited(held)
    found, saturated = controlled(held, scene, Timing()), 0
    for number in range(60):
        found.engine.push(
            "robot", scene.robot.pushed_frame, np.array([-120.0 if number < 25 else 0.0, 60.0, 0.0])
        )
        states = {name: found.state(name) for name in found.controllers}
        for name, command in found.advance().items():
            assert command.reason == ""
            body = found.controllers[name].body
            force = body.inverse_dynamics(*states[name], command.acceleration, command.feet, command.hands)
            assert np.abs(force[:ROOT]).max() < 1e-8 * body.total * 9.81
            assert command.torques == pytest.approx(force[body.rates], abs=1e-8 * body.total * 9.81)
            for foot, wrench in zip(body.agent.feet, command.feet, strict=True):
                assert min(foot_margins(wrench, foot.sole, scene.ground)) > -1e-6 * body.total
        torque = np.abs(command.torques).max() if name == "robot" else 0.0
        assert torque <= LIMIT * (1.0 + 1e-6)
        saturated += torque > 0.99 * LIMIT
    assert np.abs(found.state("robot")[1]).max() > 0.05, "the push moves the robot"


def test_a_limit_of_torque_is_kept_where_it_is_reached(held: Held) -> None:
    controller, target, (q, v) = _still(held, 0.7)
    v[0] = 0.4  # the root is thrown forwards
    command = controller.command(q, v, target)
    assert command.reason == ""
    limits = controller.limits.torque
    assert (np.abs(command.torques) <= limits * (1.0 + 1e-6)).all()
    assert (np.abs(command.torques) > limits * (1.0 - 1e-6)).any()


def _still(held: Held, least: float) -> tuple[WholeBodyController, Target, tuple[np.ndarray, np.ndarray]]:
    """A controller whose limits are what the plan asks of each joint and some N m."""
    robot, posture = held.scene.robot, held.solution.postures["robot"]
    body = MovingBody(robot, held.trees["robot"])
    planned = np.abs([posture.torques[name] for name in robot.joints])
    limits = replace(JointLimits.of(robot, held.trees["robot"]), torque=planned + least)
    controller = WholeBodyController(body, held.scene.ground, limits, hand_share(held.scene), Feedback())
    target = target_of(body, posture)
    return controller, target, (target.coordinates.copy(), target.velocity.copy())


def test_a_controller_that_finds_no_torques_says_so_in_a_sentence(held: Held) -> None:
    controller, target, state = _still(held, -20.0)
    command = controller.command(*state, target)
    assert command.reason == "no torques keep robot's limits: its limits exclude each other"
    broken = controller.command(state[0], np.full_like(state[1], np.nan), target)
    assert broken.reason == "no torques keep robot's limits: its numbers are not finite"
    for each in (command, broken):
        assert not each.torques.any()


@pytest.mark.parametrize("engine", SLOW_IN_DRAKE)
@pytest.mark.parametrize("grasp", Grasp)
def test_a_hold_without_a_push_is_the_static_plan(
    held_with: Callable[[Grasp], Held], grasp: Grasp, engine: EngineName
) -> None:
    """At first to rounding, and after half a second of simulation within 2 % of the plan's peak torque.

    Steps are short, for floors are the softer the longer they are, and knees that are straight bend where a
    floor gives way by a hundredth of a millimetre.
    """
    held = held_with(grasp)
    found = controlled(held, held.scene, Timing(substeps=32), engine)
    for share, after in ((1e-5, 1), (0.02, 125)):
        commands: dict[str, Command] = {}
        while found.number < after:
            commands = found.advance()
        for name, command in commands.items():
            posture, joints = held.solution.postures[name], found.controllers[name].body.agent.joints
            plan = np.array([posture.torques[joint] for joint in joints])
            assert np.abs(command.torques - plan).max() < max(
                share * np.abs(plan).max(), 0.02 if after > 1 else 0.0
            )
            assert np.abs(command.capture).max() < 1e-4


def test_wrenches_by_which_feet_work_against_each_other_have_the_weight_of_balance(held: Held) -> None:
    """Any wrench on the left foot and its opposite on the right one, about the same point of the world."""
    controller, _, state = _still(held, 1.0)
    body, generator = controller.body.at(*state), np.random.default_rng(0)
    left, right = body.feet
    force, moment = generator.normal(size=(2, 3))
    world = left.turn @ force, left.turn @ moment + np.cross(left.place - right.place, left.turn @ force)
    internal = np.concatenate([force, moment, *(-right.turn.T @ each for each in world)])
    scale = np.repeat([2.0, 5.0, 2.0, 5.0], 3)
    weights = wrench_weights(body.feet, scale)
    assert weights @ (scale * internal) == pytest.approx(scale * internal)
    moving = np.concatenate([foot.jacobian[:, :ROOT] for foot in body.feet]) @ generator.normal(size=ROOT)
    assert weights @ (moving / scale) == pytest.approx(LEVEL**1.5 * moving / scale)


def test_a_program_is_solved_as_its_optimality_says_and_gives_way_where_it_may() -> None:
    generator = np.random.default_rng(0)
    a, b = generator.normal(size=(8, 4)), generator.normal(size=8)
    c, least = np.eye(4), np.array([0.5, -1.0, -1.0, -1.0])
    found = least_squares(a, b, c, least, np.ones(4))
    assert found.reason == ""
    slope = 2.0 * a.T @ (a @ found.x - b)
    inside = (found.x > least + 1e-9) & (found.x < 1.0 - 1e-9)
    assert slope[inside] == pytest.approx(0.0, abs=1e-8)
    assert (slope[found.x <= least + 1e-9] >= -1e-8).all()
    assert (slope[found.x >= 1.0 - 1e-9] <= 1e-8).all()
    both = np.vstack([c[0], c[0]])
    ends = np.array([0.0, 2.0]), np.array([1.0, 3.0])
    assert least_squares(a, b, both, *ends).reason == "its limits exclude each other"
    given = least_squares(a, b, both, *ends, yielding=1)
    assert given.reason == ""
    assert given.x[0] == pytest.approx(1.0, abs=1e-6)
