"""MuJoCo as the engine of a controlled simulation, with damping at the end of a step (`set_damping`)."""

from __future__ import annotations

from collections.abc import Mapping

import mujoco
import numpy as np

from evodesign.control.gains import Feedback
from evodesign.mechanics.scene import Scene
from evodesign.posture.results import AgentPosture, Array
from evodesign.simulation.engine import EngineState, tilt_of
from evodesign.simulation.feedback import joint_inertias, set_damping
from evodesign.simulation.model import simulated_scene
from evodesign.tree.model import Tree


class MujocoEngine:
    """A scene in MuJoCo; arguments as `EngineMaker`.

    Attributes:
        found: MuJoCo's model and state, its kinematics and contacts those of this moment.
        damping: as `Engine`.
    """

    def __init__(
        self,
        scene: Scene,
        trees: Mapping[str, Tree],
        postures: Mapping[str, AgentPosture],
        height: float,
        step: float,
        feedback: Feedback,
    ) -> None:
        self.found = simulated_scene(scene, trees, postures, height, step)
        model, agents = self.found.model, self.found.agents
        self._rise = np.zeros(model.nu)
        self.damping: dict[str, Array] = {}
        for name, parts in agents.items():
            set_damping(self.found, parts, joint_inertias(self.found, parts), feedback)
            self.damping[name] = -model.actuator_biasprm[parts.actuators, 2]
        mujoco.mj_forward(model, self.found.data)

    @property
    def coordinates(self) -> Array:
        """MuJoCo's `qpos`."""
        return np.asarray(self.found.data.qpos)

    @property
    def velocities(self) -> Array:
        """MuJoCo's `qvel`."""
        return np.asarray(self.found.data.qvel)

    @property
    def load(self) -> Array:
        """As `Engine`."""
        return np.asarray(self.found.data.xpos[self.found.load])

    @property
    def tilt(self) -> float:
        """As `Engine`."""
        return tilt_of(self.found.data.xmat[self.found.load].reshape(3, 3))

    def state(self, name: str) -> EngineState:
        """As `Engine`."""
        parts, model, data = self.found.agents[name], self.found.model, self.found.data
        joint = model.body_jntadr[parts.root]
        place, rate = model.jnt_qposadr[joint], model.jnt_dofadr[joint]
        turn = data.xmat[parts.root].reshape(3, 3)
        return EngineState(
            root=data.qpos[place : place + 7],
            twist=np.concatenate([turn.T @ data.qvel[rate : rate + 3], data.qvel[rate + 3 : rate + 6]]),
            positions=data.qpos[parts.positions],
            rates=data.qvel[parts.rates],
        )

    def drive(self, name: str, inputs: Array, rise: Array) -> None:
        """As `Engine`."""
        actuators = self.found.agents[name].actuators
        self.found.data.ctrl[actuators], self._rise[actuators] = inputs, rise

    def hold(self, name: str) -> None:
        """As `Engine`."""
        self._rise[self.found.agents[name].actuators] = 0.0

    def push(self, name: str, frame: str, force: Array) -> None:
        """As `Engine`."""
        body = self.found.model.body(f"{name}/{frame}").id
        self.found.data.xfrc_applied[body, :3] = force

    def advance(self, steps: int) -> None:
        """As `Engine`."""
        model, data = self.found.model, self.found.data
        for place in range(steps):
            data.ctrl += self._rise
            if place:
                mujoco.mj_step1(model, data)
            mujoco.mj_step2(model, data)
        mujoco.mj_step1(model, data)

    def moment(self) -> mujoco.MjData:
        """As `Engine`."""
        copied = mujoco.MjData(self.found.model)
        mujoco.mj_copyData(copied, self.found.model, self.found.data)
        return copied

    def restore(self, moment: mujoco.MjData) -> None:
        """As `Engine`."""
        mujoco.mj_copyData(self.found.data, self.found.model, moment)
