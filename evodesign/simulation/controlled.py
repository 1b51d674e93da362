"""Robot, person and load in MuJoCo, each agent under a whole-body controller of its own.

Controllers answer at a rate of their own, with torques that last until the next answer; MuJoCo moves on in
finer steps. A controller knows the state of its own body, as it was some time ago where sensors are late, and
the plan; of the others it knows nothing but what the load does to its hands.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import mujoco
import numpy as np

from evodesign.control.controller import Command, HandShare, WholeBodyController
from evodesign.control.feedback import Feedback
from evodesign.control.limits import JointLimits
from evodesign.control.moving_body import MovingBody
from evodesign.control.target import Target
from evodesign.mechanics.payload import Grasp, Payload
from evodesign.mechanics.scene import Scene
from evodesign.posture.results import AgentPosture, Array
from evodesign.simulation.model import SimulatedScene, simulated_scene
from evodesign.tree.model import Tree

CONTROL_STEP = 4e-3
"""Time between two answers of a controller [s]."""

SUBSTEPS = 4
"""Steps of MuJoCo's integration between two answers."""

Targets = Callable[[int], Mapping[str, Target]]
"""From the number of a controller's answer to the targets of all agents, by name."""


def hand_share(payload: Payload, scene: Scene) -> HandShare:
    """An equal part of the load for every hand of the scene."""
    hands = sum(len(agent.hands) for agent in scene.agents)
    spin = float(np.trace(np.array(payload.inertia.about_center))) / 3.0
    rigid = payload.grasp is Grasp.RIGID
    return HandShare(payload.mass / hands, spin / hands if rigid else 0.0)


@dataclass(frozen=True, slots=True)
class Snapshot:
    """A moment to which a scene can return."""

    data: mujoco.MjData
    number: int
    seen: Mapping[str, tuple[tuple[Array, Array], ...]]


class ControlledScene:
    """A scene that moves on from answer to answer.

    Args:
        scene: undisturbed.
        trees: of agents by name, of a design.
        postures: by agent name, with which it begins.
        height: of the load's centre [m].
        targets: of the controllers.
        feedback: that sets the gains of all of them.
        step: between two answers [s].
        substeps: of the integration between two answers.
        delay: answers after which a state is seen.
        planned: the scene that the plan and the controllers know; None: the same.
    """

    def __init__(
        self,
        scene: Scene,
        trees: Mapping[str, Tree],
        postures: Mapping[str, AgentPosture],
        height: float,
        targets: Targets,
        feedback: Feedback,
        step: float = CONTROL_STEP,
        substeps: int = SUBSTEPS,
        delay: int = 0,
        planned: Scene | None = None,
    ) -> None:
        known = scene if planned is None else planned
        self.found = simulated_scene(scene, trees, postures, height, step / substeps)
        self.step, self._substeps, self._targets = step, substeps, targets
        share = hand_share(known.payload, known)
        self.controllers = {}
        for agent in known.agents:
            body, limits = MovingBody(agent, trees[agent.name]), JointLimits.of(agent, trees[agent.name])
            self.controllers[agent.name] = WholeBodyController(body, known.ground, limits, share, feedback)
        self._seen = {name: deque([self._state(name)], delay + 1) for name in self.controllers}
        self.number = 0

    def _state(self, name: str) -> tuple[Array, Array]:
        """Pinocchio's configuration and velocities of an agent."""
        found, parts = self.found, self.found.agents[name]
        model, data, body = found.model, found.data, self.controllers[name].body
        joint = model.body_jntadr[parts.root]
        place, rate = model.jnt_qposadr[joint], model.jnt_dofadr[joint]
        v = np.empty(body.size)
        turn = data.xmat[parts.root].reshape(3, 3)
        v[:3], v[3:6] = turn.T @ data.qvel[rate : rate + 3], data.qvel[rate + 3 : rate + 6]
        v[body.rates] = data.qvel[parts.rates]
        return body.coordinates(data.qpos[place : place + 7], data.qpos[parts.positions]), v

    def targets(self) -> Mapping[str, Target]:
        """Of this moment."""
        return self._targets(self.number)

    def commands(self) -> dict[str, Command]:
        """What the controllers answer now; torques of those who find none stay as they were."""
        targets, commands = self.targets(), {}
        for name, controller in self.controllers.items():
            self._seen[name].append(self._state(name))
            commands[name] = controller.command(*self._seen[name][0], targets[name])
            if not commands[name].reason:
                self.found.data.ctrl[self.found.agents[name].actuators] = commands[name].torques
        return commands

    def advance(self) -> None:
        """To the next answer."""
        for _ in range(self._substeps):
            mujoco.mj_step(self.found.model, self.found.data)
        mujoco.mj_forward(self.found.model, self.found.data)
        self.number += 1

    def push(self, name: str, frame: str, force: Array) -> None:
        """A force on the centre of mass of an agent's link, in the world [N], until another is said."""
        body = self.found.model.body(f"{name}/{frame}").id
        self.found.data.xfrc_applied[body, :3] = force

    def snapshot(self) -> Snapshot:
        """This moment."""
        copied = mujoco.MjData(self.found.model)
        mujoco.mj_copyData(copied, self.found.model, self.found.data)
        return Snapshot(copied, self.number, {name: tuple(states) for name, states in self._seen.items()})

    def restore(self, moment: Snapshot) -> None:
        """Return to a moment."""
        mujoco.mj_copyData(self.found.data, self.found.model, moment.data)
        self.number = moment.number
        self._seen = {name: deque(moment.seen[name], each.maxlen) for name, each in self._seen.items()}
