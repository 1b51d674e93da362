"""Robot and person walk with the load in a simulation: whether anybody falls, and what it takes."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache

import numpy as np

from evodesign.control.controller import Command
from evodesign.control.limits import JointLimits
from evodesign.control.moving_body import MovingBody
from evodesign.control.target import Target, target_of
from evodesign.control.walk import Walk, Way, walk_of
from evodesign.posture.results import AgentPosture, Array
from evodesign.simulation.controlled import ControlledScene, hand_share
from evodesign.simulation.pushed_plan import PushConditions, PushedPlan
from evodesign.simulation.rollout import FRAME
from evodesign.simulation.scene_record import SceneRecord


@dataclass(frozen=True, slots=True)
class CarriedBy:
    """What an agent does while it carries.

    Args:
        torque: the largest of any joint [N m].
        joint: which one that is.
        saturation: share of the time in which a motor is at its limit [1].
        saturated: joints whose torque reached its limit.
        capture: largest distance of the capture point from the planned one [m].
    """

    torque: float
    joint: str
    saturation: float
    saturated: tuple[str, ...]
    capture: float


@dataclass(frozen=True, slots=True, eq=False)
class CarryOutcome:
    """What came of a walk with the load.

    Args:
        reason: why it ended early, a sentence; empty where everybody stands at its end.
        seconds: that were simulated [s].
        distance: of the load along the way [m].
        length: of a step [m].
        steps: of each agent.
        tilt: largest angle of the load from level [rad].
        load_off: largest distance of the load from its path [m].
        agents: by name.
        instants: what everybody does at frames, by agent name.
        states: the engine's coordinates at frames, shape (f, q).
        scene: with everything as it is at the end; None where nobody began.
    """

    reason: str
    seconds: float = 0.0
    distance: float = 0.0
    length: float = 0.0
    steps: int = 0
    tilt: float = 0.0
    load_off: float = 0.0
    agents: Mapping[str, CarriedBy] = field(default_factory=dict)
    instants: Mapping[str, tuple[AgentPosture, ...]] = field(default_factory=dict)
    states: Array = field(default_factory=lambda: np.zeros((0, 0)))
    scene: ControlledScene | None = None


def walk_from(plan: PushedPlan, distance: float, direction: float) -> Walk:
    """The walk that begins in a hold.

    Args:
        plan: of the hold.
        distance: [m].
        direction: from the robot's forwards to its left [rad].
    """
    scene = plan.scene
    bodies = [MovingBody(agent, plan.trees[agent.name]) for agent in scene.agents]
    return walk_of(
        bodies,
        {body.agent.name: target_of(body, plan.postures[body.agent.name]) for body in bodies},
        {agent.name: JointLimits.of(agent, plan.trees[agent.name]) for agent in scene.agents},
        hand_share(scene),
        Way(distance, scene.robot.facing + direction),
    )


def carried(plan: PushedPlan, distance: float, direction: float, conditions: PushConditions) -> CarryOutcome:
    """What comes of a walk from a hold; arguments as `walk_from`, and the conditions of everything else."""
    walk, step = walk_from(plan, distance, direction), conditions.timing.step
    if walk.reason:
        return CarryOutcome(walk.reason, length=walk.gait.length)
    times = np.minimum(step * np.arange(math.ceil(walk.seconds / step) + 1), walk.seconds)

    @lru_cache(maxsize=2)
    def targets(number: int) -> Mapping[str, Target]:
        return walk.targets(float(times[min(number, len(times) - 1)]))

    bodies = {agent.name: MovingBody(agent, plan.trees[agent.name]) for agent in plan.scene.agents}
    first = {name: _posture(body, targets(0)[name]) for name, body in bodies.items()}
    scene = replace(plan, postures=first).controlled(targets, conditions)
    record, start = _CarryRecord(scene, conditions), scene.engine.load.copy()
    for time in times[1:]:
        commands = scene.advance()
        path = start + walk.load(float(time))[0]
        if not record.saw(commands, float(np.linalg.norm(scene.engine.load - path))) or record.reason:
            break
    along = np.append(walk.way.along, 0.0)
    return CarryOutcome(
        reason=record.reason,
        seconds=record.seconds,
        distance=float((record.load - start) @ along),
        length=walk.gait.length,
        steps=walk.steps,
        tilt=record.tilt,
        load_off=record.load_off,
        agents={name: record.carried_by(name) for name in bodies},
        instants={name: tuple(own) for name, own in record.instants.items()},
        states=np.array(record.states),
        scene=scene,
    )


def _posture(body: MovingBody, target: Target) -> AgentPosture:
    """Of an agent at rest that does what it is to do; its torques are left to the controller."""
    still, wrenches = np.zeros(len(body.rates)), (target.feet_wrenches, target.hand_wrenches)
    return body.posture(target.coordinates, target.velocity, still, *wrenches)


class _CarryRecord(SceneRecord):
    """What has been seen of a walk.

    Attributes:
        load: where it was last [m], shape (3,).
        tilt: largest angle of the load from level [rad].
        instants: postures at frames, by agent name.
        states: the engine's coordinates at frames.
    """

    def __init__(self, scene: ControlledScene, conditions: PushConditions) -> None:
        super().__init__(scene)
        self.load, self.tilt = scene.engine.load.copy(), 0.0
        self.instants: dict[str, list[AgentPosture]] = {name: [] for name in scene.controllers}
        self.states: list[Array] = []
        self._every, self._count = max(1, round(FRAME / conditions.timing.step)), 0
        self._torques = {name: np.zeros(len(each.body.rates)) for name, each in scene.controllers.items()}
        self._capture = dict.fromkeys(scene.controllers, 0.0)
        self._saturated = dict.fromkeys(scene.controllers, 0.0)

    def saw(self, commands: Mapping[str, Command], load_off: float) -> bool:
        """As `SceneRecord`."""
        if not super().saw(commands, load_off):
            return False
        engine = self._scene.engine
        self.load, self.tilt = engine.load.copy(), max(self.tilt, engine.tilt)
        for name, command in commands.items():
            self._torques[name] = np.maximum(self._torques[name], np.abs(command.torques))
            self._capture[name] = max(self._capture[name], float(np.linalg.norm(command.capture)))
            if self.saturates(name, command):
                self._saturated[name] += self._scene.timing.step
        if self._count % self._every == 0:
            self.states.append(np.array(engine.coordinates))
            for name, command in commands.items():
                body, (q, v) = self._scene.controllers[name].body, self._scene.state(name)
                self.instants[name].append(body.posture(q, v, command.torques, command.feet, command.hands))
        self._count += 1
        return True

    def carried_by(self, name: str) -> CarriedBy:
        """What an agent has done."""
        most, controller = self._torques[name], self._scene.controllers[name]
        joints, limits = controller.body.agent.joints, controller.limits.torque
        return CarriedBy(
            torque=float(most.max()),
            joint=joints[int(most.argmax())],
            saturation=self._saturated[name] / self.seconds,
            saturated=tuple(joints[place] for place in np.flatnonzero(most >= (1.0 - 1e-6) * limits)),
            capture=self._capture[name],
        )
