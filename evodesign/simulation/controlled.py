"""Robot, person and load in an engine, each agent under a whole-body controller of its own.

Controllers answer at a rate of their own; the engine moves on in finer steps. Between two answers motors
follow

    tau = tau* + d (v* + a* t - v),        d = 2 z w I

with the torques tau* and accelerations a* of the answer, the speeds v* that it was given, and I of each joint
as in `feedback`: feet, which are light, would flutter under torques alone. A controller knows the state of
its own body, as it was some time ago where sensors are late, and the plan; of the others it knows nothing.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from evodesign.control.controller import Command, HandShare, WholeBodyController
from evodesign.control.gains import Feedback
from evodesign.control.limits import JointLimits
from evodesign.control.moving_body import MovingBody
from evodesign.control.target import Target
from evodesign.mechanics.floating_base import ROOT
from evodesign.mechanics.payload import Grasp
from evodesign.mechanics.scene import Scene
from evodesign.posture.results import AgentPosture, Array
from evodesign.simulation.engine import EngineMaker
from evodesign.simulation.mujoco_engine import MujocoEngine
from evodesign.tree.model import Tree

Targets = Callable[[int], Mapping[str, Target]]
"""From the number of an answer to the targets of all agents, by name."""

State = tuple[Array, Array]
"""Pinocchio's configuration and velocities."""


@dataclass(frozen=True, slots=True)
class Timing:
    """When controllers answer and what they see.

    Args:
        step: between two answers [s].
        substeps: of the integration between two answers.
        delay: answers after which a state is seen.
    """

    step: float = 4e-3
    substeps: int = 8
    delay: int = 0


def hand_share(scene: Scene) -> HandShare | None:
    """An equal part of the load for every hand of the scene; None without hands."""
    hands = sum(len(agent.hands) for agent in scene.agents)
    if not hands:
        return None
    spin = float(np.trace(np.array(scene.payload.inertia.about_center))) / 3.0
    return HandShare(scene.payload.mass / hands, spin / hands if scene.payload.grasp is Grasp.RIGID else 0.0)


@dataclass(frozen=True, slots=True, eq=False)
class Snapshot:
    """A moment to which a scene can return.

    Args:
        moment: of the engine.
        number: of the next answer.
        seen: states that controllers are still to see, by agent name.
    """

    moment: object
    number: int
    seen: Mapping[str, tuple[State, ...]]


class ControlledScene:
    """A scene that moves on from answer to answer.

    Args:
        scene: undisturbed, as it is.
        trees: of agents by name, of a design.
        postures: by agent name, with which it begins.
        height: of the load's centre [m].
        targets: of the controllers.
        feedback: that sets all gains.
        timing: of the answers.
        planned: the scene that the controllers know; None: as it is.
        engine: that moves it.
    Attributes:
        engine: with everything as it is now.
        controllers: by agent name.
        number: of the next answer.
    """

    def __init__(
        self,
        scene: Scene,
        trees: Mapping[str, Tree],
        postures: Mapping[str, AgentPosture],
        height: float,
        targets: Targets,
        feedback: Feedback,
        timing: Timing,
        planned: Scene | None = None,
        engine: EngineMaker = MujocoEngine,
    ) -> None:
        known = scene if planned is None else planned
        self._substep = timing.step / timing.substeps
        self.engine = engine(scene, trees, postures, height, self._substep, feedback)
        self.timing, self._targets, self.number = timing, targets, 0
        self.controllers: dict[str, WholeBodyController] = {}
        for agent in known.agents:
            body, limits = MovingBody(agent, trees[agent.name]), JointLimits.of(agent, trees[agent.name])
            self.controllers[agent.name] = WholeBodyController(
                body, known.ground, limits, hand_share(known), feedback
            )
        self._seen = {name: deque([self.state(name)], timing.delay + 1) for name in self.controllers}

    def state(self, name: str) -> State:
        """Of an agent, now."""
        now, body = self.engine.state(name), self.controllers[name].body
        v = np.empty(body.size)
        v[:ROOT], v[body.rates] = now.twist, now.rates
        return body.coordinates(now.root, now.positions), v

    def targets(self) -> Mapping[str, Target]:
        """Of this moment."""
        return self._targets(self.number)

    def advance(self) -> dict[str, Command]:
        """Answers of this moment, by agent name, and on to the next; without one torques stay."""
        targets, commands = self.targets(), {}
        for name, controller in self.controllers.items():
            self._seen[name].append(self.state(name))
            q, v = self._seen[name][0]
            command = commands[name] = controller.command(q, v, targets[name])
            if command.reason:
                self.engine.hold(name)
                continue
            rates, damping = controller.body.rates, self.engine.damping[name]
            rise = self._substep * damping * command.acceleration[rates]  # to the end of each step
            self.engine.drive(name, command.torques + damping * v[rates], rise)
        self.engine.advance(self.timing.substeps)
        self.number += 1
        return commands

    def snapshot(self) -> Snapshot:
        """This moment."""
        seen = {name: tuple(states) for name, states in self._seen.items()}
        return Snapshot(self.engine.moment(), self.number, seen)

    def restore(self, moment: Snapshot) -> None:
        """Return to a moment."""
        self.engine.restore(moment.moment)
        self.number = moment.number
        self._seen = {name: deque(moment.seen[name], each.maxlen) for name, each in self._seen.items()}
