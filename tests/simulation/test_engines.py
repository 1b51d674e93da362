"""What every engine has to do, and that both do the same where nothing is left to an engine's choice."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from evodesign.body.inertia import Inertia
from evodesign.control.gains import Feedback
from evodesign.control.moving_body import MovingBody
from evodesign.control.target import target_of
from evodesign.errors import ModelError
from evodesign.hardware.actuators import actuator_law
from evodesign.mechanics.agent import Agent
from evodesign.mechanics.balance import GRAVITY
from evodesign.mechanics.payload import Grasp
from evodesign.posture.results import AgentPosture
from evodesign.simulation.controlled import ControlledScene, Timing
from evodesign.simulation.engine import Engine, engine_named
from evodesign.simulation.installed import EngineName
from evodesign.simulation.push import Push
from evodesign.tree.equip import with_actuators
from evodesign.tree.model import Tree
from tests.control.pendulum import Pendulum
from tests.simulation.conftest import HEIGHT, Held
from tests.simulation.engines import ENGINES

STEP = 5e-4
LIMIT = 9.0
PUSHED = np.array([30.0, -20.0, 0.0])


def above_ground(held: Held) -> tuple[Agent, Tree, AgentPosture]:
    """The robot a metre above its place, away from the ends of its ranges, with empty hands.

    It has a motor in a knee and weak elbows.
    """
    robot, posture = held.scene.robot, held.solution.postures["robot"]
    limits = dict.fromkeys(("l_elbow", "r_elbow"), LIMIT)
    tree = with_actuators(robot.tree, {"l_knee": actuator_law().at(30.0)})
    joints = {
        joint: float(
            np.clip(
                posture.joints[joint],
                tree.joint_by_name[joint].lower + 0.1,
                tree.joint_by_name[joint].upper - 0.1,
            )
        )
        for joint in robot.joints
    }
    lifted = replace(posture, base_position=posture.base_position + np.array([0.0, 0.0, 1.0]), joints=joints)
    return replace(robot, contacts=robot.feet, torque_limits=limits), tree, lifted


def flying(held: Held, name: EngineName) -> Engine:
    robot, tree, posture = above_ground(held)
    scene = held.scene.only(robot)
    return engine_named(name)(scene, {"robot": tree}, {"robot": posture}, HEIGHT, STEP, Feedback())


@pytest.mark.parametrize("name", ENGINES)
def test_what_nobody_holds_falls_as_a_stone_does_and_a_push_moves_its_centre_of_mass(
    held: Held, name: EngineName
) -> None:
    """With the speed of the end of each step: z = z0 - g h^2 n (n + 1) / 2."""
    engine, count = flying(held, name), 100
    robot, tree, _ = above_ground(held)
    body = MovingBody(robot, tree)

    def center() -> np.ndarray:
        now = engine.state("robot")
        return body.at(body.coordinates(now.root, now.positions), np.zeros(body.size)).center.place

    before, fallen = center(), STEP**2 * count * (count + 1) / 2.0
    engine.push("robot", robot.pushed_frame, PUSHED)
    engine.advance(count)
    assert engine.load == pytest.approx([0.0, 0.0, HEIGHT - GRAVITY * fallen], abs=1e-9)
    moved = fallen * (PUSHED / body.total - [0.0, 0.0, GRAVITY])
    assert center() - before == pytest.approx(moved, abs=1e-5)


@pytest.mark.needs_drake
def test_in_the_air_the_engines_move_alike(held: Held) -> None:
    """Masses, inertias, rotors, damping at a step's end, limits of torque, pushes; contacts play no part.

    The first step, from rest, is the same to rounding; the next ones but for how orientations are integrated.
    """
    ends: dict[int, list[np.ndarray]] = {1: [], 5: []}
    for name in EngineName:
        engine = flying(held, name)
        size = len(engine.state("robot").rates)
        inputs = np.random.default_rng(0).normal(0.0, 10.0, size)
        engine.drive("robot", inputs, np.full(size, 0.01))
        engine.push("robot", held.scene.robot.pushed_frame, PUSHED)
        for count, found in ends.items():
            engine.restore(started := engine.moment())
            engine.advance(count)
            now = engine.state("robot")
            found.append(np.concatenate([now.twist, now.rates]))
            engine.restore(started)
    for count, (first, second) in ends.items():
        assert np.abs(first).max() > 0.2
        assert second == pytest.approx(first, abs=1e-9 if count == 1 else 1e-5 * np.abs(first).max())


@pytest.mark.needs_drake
@pytest.mark.parametrize("grasp", Grasp)
def test_dampings_follow_from_the_same_inertias(held_with: object, grasp: Grasp) -> None:
    held: Held = held_with(grasp)  # type: ignore[operator]
    made = [
        engine_named(name)(held.scene, held.trees, held.solution.postures, HEIGHT, STEP, Feedback()).damping
        for name in EngineName
    ]
    for agent in held.scene.agents:
        assert made[1][agent.name] == pytest.approx(made[0][agent.name], rel=1e-8)


@pytest.mark.parametrize("name", ENGINES)
@pytest.mark.parametrize("grasp", Grasp)
def test_soles_stay_on_the_floor_and_hands_on_the_load(
    held_with: object, grasp: Grasp, name: EngineName
) -> None:
    """While everybody is pushed hard: to a tenth of a millimetre."""
    held: Held = held_with(grasp)  # type: ignore[operator]
    scene, postures = held.scene, held.solution.postures
    targets = {a.name: target_of(MovingBody(a, held.trees[a.name]), postures[a.name]) for a in scene.agents}
    found = ControlledScene(
        scene,
        held.trees,
        postures,
        HEIGHT,
        lambda _: targets,
        Feedback(),
        Timing(),
        engine=engine_named(name),
    )
    found.engine.push("robot", scene.robot.pushed_frame, np.array([60.0, 60.0, 0.0]))
    for _ in range(30):
        found.advance()
    load = found.engine.load
    assert np.linalg.norm(load - [0.0, 0.0, HEIGHT]) > 1e-3
    grips = []
    for agent in scene.agents:
        body = found.controllers[agent.name].body.at(*found.state(agent.name))
        assert all(abs(foot.place[2]) < 1e-4 for foot in body.feet)
        points = [agent.turn @ scene.payload.grasp_point(agent, hand) for hand in agent.hands]
        grips += [(hand.place, point) for hand, point in zip(body.hands, points, strict=True)]
    places, points = (np.array(each) for each in zip(*grips, strict=True))
    apart = np.linalg.norm(places - places[:1], axis=1)
    assert apart == pytest.approx(np.linalg.norm(points - points[:1], axis=1), abs=1e-4)


def test_an_explosion_in_mujoco_is_an_outcome_and_leaves_no_file_behind(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    test = Pendulum(0.2).test()
    assert test.pushed(Push(1e30, 0.0)).reason
    assert test.pushed(Push(0.1, 0.0)).survived
    assert not list(tmp_path.iterdir())


@pytest.mark.needs_drake
def test_a_step_that_drake_does_not_find_is_an_explosion_and_the_next_push_is_none(held: Held) -> None:
    test = Pendulum(0.2).test(engine=engine_named(EngineName.DRAKE))
    outcome = test.pushed(Push(1e30, 0.0))
    assert outcome.reason == "the simulation explodes"
    assert test.pushed(Push(0.1, 0.0)).survived


@pytest.mark.needs_drake
def test_a_body_that_cannot_be_is_refused_with_drakes_reason(held: Held) -> None:
    robot, tree, posture = above_ground(held)
    links = tuple(
        replace(
            link,
            solids=(),
            own_inertia=Inertia(1.0, (0.0, 0.0, 0.0), ((1.0, 0, 0), (0, 0.1, 0), (0, 0, 0.1))),
        )
        if link.name == tree.root
        else link
        for link in tree.links
    )
    impossible = tree.reshaped(links, tree.joints)
    with pytest.raises(ModelError, match="bodies that Drake can move"):
        engine_named(EngineName.DRAKE)(
            held.scene.only(robot), {"robot": impossible}, {"robot": posture}, HEIGHT, STEP, Feedback()
        )
