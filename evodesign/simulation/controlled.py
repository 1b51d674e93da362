"""Robot, person and load in MuJoCo, each agent under a whole-body controller of its own.

Controllers answer at a rate of their own; MuJoCo moves on in finer steps. Between two answers motors follow

    tau = tau* + d (v* + a* t - v),        d = 2 z w I

with the torques tau* and accelerations a* of the answer, the speeds v* that it was given, and I of each joint
as in `feedback`: feet, which are light, would flutter under torques alone. d is taken at the end of a step
(`set_damping`). A controller knows the state of its own body, as it was some time ago where sensors are late,
and the plan; of the others it knows nothing.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import mujoco
import numpy as np

from evodesign.control.controller import Command, HandShare, WholeBodyController
from evodesign.control.gains import Feedback
from evodesign.control.limits import JointLimits
from evodesign.control.moving_body import MovingBody
from evodesign.control.target import Target
from evodesign.mechanics.payload import Grasp
from evodesign.mechanics.scene import Scene
from evodesign.posture.results import AgentPosture, Array
from evodesign.simulation.feedback import joint_inertias, set_damping
from evodesign.simulation.model import simulated_scene
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
        data: MuJoCo's.
        number: of the next answer.
        seen: states that controllers are still to see, by agent name.
    """

    data: mujoco.MjData
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
    Attributes:
        found: MuJoCo's model and state.
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
    ) -> None:
        known = scene if planned is None else planned
        self.found = simulated_scene(scene, trees, postures, height, timing.step / timing.substeps)
        self.timing, self._targets, self.number = timing, targets, 0
        self.controllers: dict[str, WholeBodyController] = {}
        for agent in known.agents:
            body, limits = MovingBody(agent, trees[agent.name]), JointLimits.of(agent, trees[agent.name])
            self.controllers[agent.name] = WholeBodyController(
                body, known.ground, limits, hand_share(known), feedback
            )
        model = self.found.model
        self._ramp = np.zeros(model.nu)
        for parts in self.found.agents.values():
            set_damping(self.found, parts, joint_inertias(self.found, parts), feedback)
        self._damping = -model.actuator_biasprm[:, 2]
        mujoco.mj_forward(model, self.found.data)
        self._seen = {name: deque([self.state(name)], timing.delay + 1) for name in self.controllers}

    def state(self, name: str) -> State:
        """Of an agent, now."""
        found, parts, body = self.found, self.found.agents[name], self.controllers[name].body
        model, data = found.model, found.data
        joint = model.body_jntadr[parts.root]
        place, rate = model.jnt_qposadr[joint], model.jnt_dofadr[joint]
        v, turn = np.empty(body.size), data.xmat[parts.root].reshape(3, 3)
        v[:3], v[3:6] = turn.T @ data.qvel[rate : rate + 3], data.qvel[rate + 3 : rate + 6]
        v[body.rates] = data.qvel[parts.rates]
        return body.coordinates(data.qpos[place : place + 7], data.qpos[parts.positions]), v

    def targets(self) -> Mapping[str, Target]:
        """Of this moment."""
        return self._targets(self.number)

    def advance(self) -> dict[str, Command]:
        """Answers of this moment, by agent name, and on to the next; without one torques stay."""
        model, data, targets, commands = self.found.model, self.found.data, self.targets(), {}
        for name, controller in self.controllers.items():
            self._seen[name].append(self.state(name))
            q, v = self._seen[name][0]
            command = commands[name] = controller.command(q, v, targets[name])
            rates, actuators = controller.body.rates, self.found.agents[name].actuators
            self._ramp[actuators] = 0.0
            if not command.reason:
                damping = self._damping[actuators]
                self._ramp[actuators] = model.opt.timestep * damping * command.acceleration[rates]
                data.ctrl[actuators] = command.torques + damping * v[rates]
        for place in range(self.timing.substeps):
            data.ctrl += self._ramp  # the speed at the end of the step
            if place:
                mujoco.mj_step1(model, data)
            mujoco.mj_step2(model, data)
        mujoco.mj_step1(model, data)
        self.number += 1
        return commands

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
