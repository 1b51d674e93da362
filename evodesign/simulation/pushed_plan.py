"""Tests of pushes at moments of holds and lifts, with all who hold the load, or with one robot alone.

Alone a robot holds nothing, stands as in the plan, and brings its centre of mass above the middle of its
soles before it is pushed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from evodesign.control.gains import Feedback
from evodesign.control.moving_body import MovingBody
from evodesign.control.target import Target, lift_targets, target_of
from evodesign.mechanics.balance import GRAVITY
from evodesign.mechanics.scene import Scene
from evodesign.motion.course import LiftCourse
from evodesign.posture.results import AgentPosture
from evodesign.simulation.controlled import ControlledScene, Targets, Timing
from evodesign.simulation.engine import EngineMaker
from evodesign.simulation.mujoco_engine import MujocoEngine
from evodesign.simulation.push import PushTest
from evodesign.tree.model import Tree

SETTLING = 0.1
"""Before a push in a hold [s]: contacts have taken the weight."""

SHIFTING = 3.0
"""Before a push on a robot alone at most [s]: it comes above its soles."""

ABOVE = 1e-3
"""Nearer than this is its capture point then [m]."""

LIFT_SHARES = (1.0 / 3.0, 2.0 / 3.0)
"""Of a lift's time at which it is pushed."""


@dataclass(frozen=True, slots=True)
class PushConditions:
    """How everything is that a plan does not say.

    Args:
        feedback: of the controllers.
        timing: of the controllers.
        friction: of the floor, as a factor.
        mass: of the load, as a factor; controllers know nothing of either.
        engine: that moves everything.
    """

    feedback: Feedback = field(default_factory=Feedback)
    timing: Timing = field(default_factory=Timing)
    friction: float = 1.0
    mass: float = 1.0
    engine: EngineMaker = MujocoEngine

    def changed(self, scene: Scene) -> Scene:
        """The scene as it is."""
        ground = replace(scene.ground, friction=self.friction * scene.ground.friction)
        payload = replace(scene.payload, mass=self.mass * scene.payload.mass)
        return replace(scene, ground=ground, payload=payload)


def hold_test(
    scene: Scene,
    trees: Mapping[str, Tree],
    postures: Mapping[str, AgentPosture],
    height: float,
    conditions: PushConditions,
) -> PushTest:
    """Pushes while a load is held.

    Args:
        scene: undisturbed.
        trees: of agents by name, of a design.
        postures: by agent name.
        height: of the load's centre [m].
        conditions: of everything else.
    """
    targets = {a.name: target_of(MovingBody(a, trees[a.name]), postures[a.name]) for a in scene.agents}
    controlled = _controlled(scene, trees, postures, height, lambda _: targets, conditions)
    _advance(controlled, SETTLING)
    return PushTest(controlled, np.array([height]), controlled.snapshot())


def alone_test(
    scene: Scene, trees: Mapping[str, Tree], postures: Mapping[str, AgentPosture], conditions: PushConditions
) -> PushTest:
    """Pushes on the first robot alone, in its posture of a hold; arguments as `hold_test`."""
    robot = replace(scene.robot, contacts=scene.robot.feet)
    body, own = MovingBody(robot, trees[robot.name]), postures[robot.name]
    posture = replace(own, wrenches={foot.name: own.wrenches[foot.name] for foot in robot.feet})
    target = target_of(body, posture)
    feet = body.at(target.coordinates, target.velocity).feet
    middle = np.mean([foot.place for foot in feet], axis=0)
    place = np.array([*middle[:2], target.center.place[2]])
    weight = np.array([0.0, 0.0, body.total * GRAVITY / len(feet), 0.0, 0.0, 0.0])
    standing = {
        robot.name: replace(
            target, center=replace(target.center, place=place), feet_wrenches=np.tile(weight, (len(feet), 1))
        )
    }
    controlled = _controlled(
        scene.only(robot), trees, {robot.name: posture}, 0.0, lambda _: standing, conditions
    )
    _advance(controlled, SETTLING)
    while controlled.number * conditions.timing.step < SHIFTING:
        if np.linalg.norm(controlled.advance()[robot.name].capture) < ABOVE:
            break
    return PushTest(controlled, None, controlled.snapshot())


def lift_tests(
    scene: Scene, trees: Mapping[str, Tree], course: LiftCourse, conditions: PushConditions
) -> dict[float, PushTest]:
    """Pushes in the course of a lift, by the time of the push [s]; arguments as `hold_test`."""
    step, seconds = conditions.timing.step, course.lift.seconds
    times = np.minimum(step * np.arange(int(np.ceil(seconds / step)) + 1), seconds)
    bodies = [MovingBody(agent, trees[agent.name]) for agent in scene.agents]
    planned = lift_targets(bodies, course, times)

    def targets(number: int) -> Mapping[str, Target]:
        return {name: each[min(number, len(times) - 1)] for name, each in planned.items()}

    first, heights = course.instants([0.0])[0].postures, course.heights(times)
    tests: dict[float, PushTest] = {}
    controlled = _controlled(scene, trees, first, float(heights[0]), targets, conditions)
    for share in LIFT_SHARES:
        _advance(controlled, share * seconds - controlled.number * step)
        tests[share * seconds] = PushTest(controlled, heights, controlled.snapshot())
    return tests


def _controlled(
    scene: Scene,
    trees: Mapping[str, Tree],
    postures: Mapping[str, AgentPosture],
    height: float,
    targets: Targets,
    conditions: PushConditions,
) -> ControlledScene:
    return ControlledScene(
        conditions.changed(scene),
        trees,
        postures,
        height,
        targets,
        conditions.feedback,
        conditions.timing,
        planned=scene,
        engine=conditions.engine,
    )


def _advance(scene: ControlledScene, seconds: float) -> None:
    for _ in range(round(seconds / scene.timing.step)):
        scene.advance()
