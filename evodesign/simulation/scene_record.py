"""What is seen of a controlled scene from answer to answer: falls, a load off its path, broken limits."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

import numpy as np

from evodesign.control.controller import Command
from evodesign.simulation.controlled import ControlledScene
from evodesign.simulation.outcome import FALLEN

LOAD_OFF = 0.1
"""How far the load may be from its path [m]."""

BROKEN_SECONDS = 0.05
"""How long a limit may be broken [s]."""

BEYOND = math.radians(2.0)
"""By which a joint may push its stop in [rad]."""

EXPLODED = 300.0
"""A speed of a joint [rad/s] that nobody's is: the simulation explodes."""


class SceneRecord:
    """What has been seen so far.

    Attributes:
        seconds: that have been seen [s].
        load_off: largest distance of the load from its path [m].
        reason: why it ends, a sentence; empty where it goes on.
    """

    def __init__(self, scene: ControlledScene) -> None:
        self._scene = scene
        self.seconds = self.load_off = 0.0
        self.reason = ""
        self._broken: dict[str, float] = {}

    def saw(self, commands: Mapping[str, Command], load_off: float) -> bool:
        """Another answer of the controllers, and where everything is after it.

        Returns:
            Whether all are where they can be compared with the plan.
        """
        scene, step = self._scene, self._scene.timing.step
        self.seconds += step
        engine, targets = scene.engine, scene.targets()
        if not (np.isfinite(engine.coordinates).all() and np.abs(engine.velocities).max() < EXPLODED):
            self.reason = "the simulation explodes"
            return False
        self.load_off = max(self.load_off, load_off)
        if load_off > LOAD_OFF:
            self.reason = f"the load is more than {100 * LOAD_OFF:g} cm off its path"
            return False
        for name in scene.controllers:
            root = engine.state(name).root[:3]
            if np.linalg.norm(root - targets[name].coordinates[:3]) > FALLEN:
                self.reason = f"{name} falls"
        broken = {what for name, each in commands.items() for what in self._broken_by(name, each)}
        self._broken = {what: self._broken.get(what, 0.0) + step for what in sorted(broken)}
        lasting = next(
            (what for what, time in self._broken.items() if time > BROKEN_SECONDS + step / 2), None
        )
        self.reason = self.reason or lasting or ""
        return True

    def saturates(self, name: str, command: Command) -> bool:
        """Whether one of an agent's motors is at its limit."""
        limits = self._scene.controllers[name].limits.torque
        return bool((np.abs(command.torques) >= (1.0 - 1e-6) * limits).any())

    def _broken_by(self, name: str, command: Command) -> Iterator[str]:
        """Sentences about limits of an agent that are broken now."""
        if command.reason:
            yield command.reason
        controller, (q, v) = self._scene.controllers[name], self._scene.state(name)
        limits, joints = controller.limits, controller.body.agent.joints
        positions, speeds = q[controller.body.places], v[controller.body.rates]
        beyond = np.maximum(limits.lower - positions, positions - limits.upper) > BEYOND
        for place in np.flatnonzero(beyond):
            yield f"{name}'s {joints[place]} is beyond its range"
        for place in np.flatnonzero(np.abs(speeds) > 1.01 * limits.speed):
            yield f"{name}'s {joints[place]} is faster than it can be"
