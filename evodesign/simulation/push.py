"""A push on somebody's trunk, and what comes of it: who falls, where the load goes, which limits break.

A push is a horizontal force on the trunk's centre of mass. A simulation ends when somebody
falls, the load is too far off, a limit is broken for too long, or all have recovered and a lift is over.
Whether a push is survived is known before capture points and load are back, as soon as they are near.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np

from evodesign.control.controller import Command
from evodesign.control.limits import WATCHED_SECONDS
from evodesign.posture.results import Array
from evodesign.simulation.controlled import ControlledScene, Snapshot
from evodesign.simulation.outcome import FALLEN
from evodesign.simulation.rollout import FRAME

PUSH_SECONDS = 0.1
"""How long a push lasts [s], unless another time is said."""

LOAD_OFF = 0.1
"""How far the load may be from its path [m]."""

BROKEN_SECONDS = 0.05
"""How long a limit may be broken [s]."""


@dataclass(frozen=True, slots=True)
class Recovery:
    """When a simulation ends well: at its end no limit is broken, and nothing goes away from the plan.

    Args:
        within: nearer than this to the plan are capture points and load [m].
        seconds: for which that lasts [s].
    """

    within: float
    seconds: float


BACK = Recovery(0.01, 0.2)
"""Everything is back."""

SURVIVING = Recovery(0.04, 0.1)
"""Who is so near will be back: of 403 pushes of bisections none was lost after it, and none after 5 cm."""

BEYOND = math.radians(2.0)
"""By which a joint may push its stop in [rad]."""

EXPLODED = 300.0
"""A speed of a joint [rad/s] that nobody's is: the simulation explodes."""


@dataclass(frozen=True, slots=True)
class Push:
    """On an agent's trunk.

    Args:
        impulse: [N s].
        direction: to which it pushes, from the agent's forward direction to its left [rad].
        agent: its name.
        seconds: how long it lasts [s].
    """

    impulse: float
    direction: float
    agent: str = "robot"
    seconds: float = PUSH_SECONDS


@dataclass(frozen=True, slots=True, eq=False)
class PushOutcome:
    """What came of a push.

    Args:
        push: that was given.
        reason: why it was not survived, a sentence; empty where it was.
        seconds: from the push to the end of the simulation [s].
        recovery: from the push until capture points and load are back, or so near as was awaited, for good
            [s]; None: never.
        load_off: largest distance of the load from its path [m].
        saturation: share of the time in which a motor of the pushed agent is at its limit [1].
        capture: largest distance of the pushed agent's capture point from the planned one [m].
        states: the engine's coordinates at frames, shape (f, q); none unless they were asked for.
        forces: the push at frames, in the world [N], shape (f, 3), likewise.
    """

    push: Push
    reason: str
    seconds: float
    recovery: float | None
    load_off: float
    saturation: float
    capture: float
    states: Array = field(default_factory=lambda: np.zeros((0, 0)))
    forces: Array = field(default_factory=lambda: np.zeros((0, 3)))

    @property
    def survived(self) -> bool:
        """Whether nobody fell, the load stayed near its path and limits were kept."""
        return not self.reason


class PushTest:
    """Pushes at one moment of a plan.

    Args:
        scene: with its controllers.
        path: height of the load's centre at each answer [m], the last one from then on; None without a load.
        moment: of the pushes.
        is_symmetric: whether everything is its own mirror image, so that a push to the left does what one to
            the right does.
    """

    def __init__(
        self, scene: ControlledScene, path: Array | None, moment: Snapshot, *, is_symmetric: bool
    ) -> None:
        self.scene, self._path, self._moment, self.is_symmetric = scene, path, moment, is_symmetric

    def pushed(self, push: Push, frames: bool = False, awaited: Recovery = BACK) -> PushOutcome:
        """What comes of a push.

        Args:
            push: on one of the agents.
            frames: whether states are kept.
            awaited: with which the simulation ends.
        """
        scene = self.scene
        scene.restore(self._moment)
        agent = scene.controllers[push.agent].body.agent
        angle = agent.facing + push.direction
        force = push.impulse / push.seconds * np.array([math.cos(angle), math.sin(angle), 0.0])
        watched = _PushRecord(scene, push.agent, awaited)
        states, forces, every = [], [], max(1, round(FRAME / scene.timing.step))
        lasting = round(push.seconds / scene.timing.step)
        ending = lasting + round(awaited.seconds / scene.timing.step)
        ending = max(ending, 0 if self._path is None else len(self._path) - 1 - scene.number)
        for number in range(max(ending, round(WATCHED_SECONDS / scene.timing.step))):
            now = force if number < lasting else np.zeros(3)
            scene.engine.push(push.agent, agent.pushed_frame, now)
            if frames and number % every == 0:
                states.append(np.array(scene.engine.coordinates))
                forces.append(now)
            watched.saw(scene.advance(), self.load_off())
            if watched.reason or (number >= ending and watched.is_back):
                break
        return PushOutcome(
            push=push,
            reason=watched.reason,
            seconds=watched.seconds,
            recovery=watched.last if not watched.reason and watched.is_back else None,
            load_off=watched.load_off,
            saturation=watched.saturated / watched.seconds,
            capture=watched.capture,
            states=np.array(states),
            forces=np.array(forces).reshape(-1, 3),
        )

    def load_off(self) -> float:
        """Distance of the load from its path now [m]."""
        if self._path is None:
            return 0.0
        height = self._path[min(self.scene.number, len(self._path) - 1)]
        return float(np.linalg.norm(self.scene.engine.load - [0.0, 0.0, height]))


class _PushRecord:
    """What has been seen since a push.

    Attributes:
        seconds: since the push [s].
        last: when capture points or load were off last [s].
        reason: why the push is not survived.
        load_off, capture: largest so far [m].
        saturated: for how long [s].
    """

    def __init__(self, scene: ControlledScene, pushed: str, awaited: Recovery) -> None:
        self._scene, self._pushed, self._awaited = scene, pushed, awaited
        self.seconds = self.last = self.load_off = self.capture = self.saturated = 0.0
        self.reason = ""
        self._broken: dict[str, float] = {}
        self._offs: deque[Array] = deque(maxlen=1 + round(awaited.seconds / scene.timing.step))

    @property
    def is_back(self) -> bool:
        """Whether all have been back for long enough."""
        nearer = (self._offs[-1] <= np.maximum(self._offs[0], BACK.within)).all()
        return bool(nearer) and not self._broken and self.seconds - self.last >= self._awaited.seconds

    def saw(self, commands: Mapping[str, Command], load_off: float) -> None:
        """Another answer of the controllers, and where everything is after it."""
        scene, step = self._scene, self._scene.timing.step
        self.seconds += step
        engine, targets = scene.engine, scene.targets()
        if not (np.isfinite(engine.coordinates).all() and np.abs(engine.velocities).max() < EXPLODED):
            self.reason = "the simulation explodes"
            return
        self.load_off = max(self.load_off, load_off)
        if load_off > LOAD_OFF:
            self.reason = f"the load is more than {100 * LOAD_OFF:g} cm off its path"
        off = {name: float(np.linalg.norm(each.capture)) for name, each in commands.items()}
        self.capture = max(self.capture, off[self._pushed])
        self._offs.append(np.array([*off.values(), load_off]))
        if self._offs[-1].max() > self._awaited.within:
            self.last = self.seconds
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
        torques, limits = commands[self._pushed].torques, scene.controllers[self._pushed].limits.torque
        if (np.abs(torques) >= (1.0 - 1e-6) * limits).any():
            self.saturated += step

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
