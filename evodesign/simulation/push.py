"""A push on somebody's trunk, and what comes of it: who falls, where the load goes, which limits break.

A push is a horizontal force on the trunk's centre of mass. A simulation ends when somebody
falls, the load is too far off, a limit is broken for too long, or all have recovered and a lift is over.
Whether a push is survived is known before capture points and load are back, as soon as they are near.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from evodesign.control.controller import Command
from evodesign.control.limits import WATCHED_SECONDS
from evodesign.posture.results import Array
from evodesign.simulation.controlled import ControlledScene, Snapshot
from evodesign.simulation.rollout import FRAME
from evodesign.simulation.scene_record import SceneRecord

PUSH_SECONDS = 0.1
"""How long a push lasts [s], unless another time is said."""


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


class _PushRecord(SceneRecord):
    """What has been seen since a push.

    Attributes:
        last: when capture points or load were off last [s].
        capture: largest distance of the pushed agent's capture point from the planned one so far [m].
        saturated: for how long one of its motors was at its limit [s].
    """

    def __init__(self, scene: ControlledScene, pushed: str, awaited: Recovery) -> None:
        super().__init__(scene)
        self._pushed, self._awaited = pushed, awaited
        self.last = self.capture = self.saturated = 0.0
        self._offs: deque[Array] = deque(maxlen=1 + round(awaited.seconds / scene.timing.step))

    @property
    def is_back(self) -> bool:
        """Whether all have been back for long enough."""
        nearer = (self._offs[-1] <= np.maximum(self._offs[0], BACK.within)).all()
        return bool(nearer) and not self._broken and self.seconds - self.last >= self._awaited.seconds

    def saw(self, commands: Mapping[str, Command], load_off: float) -> bool:
        """As `SceneRecord`."""
        if not super().saw(commands, load_off):
            return False
        off = {name: float(np.linalg.norm(each.capture)) for name, each in commands.items()}
        self.capture = max(self.capture, off[self._pushed])
        self._offs.append(np.array([*off.values(), load_off]))
        if self._offs[-1].max() > self._awaited.within:
            self.last = self.seconds
        if self.saturates(self._pushed, commands[self._pushed]):
            self.saturated += self._scene.timing.step
        return True
