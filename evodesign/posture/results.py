"""What a posture problem gives: postures, or the reason why there is none."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from evodesign.records import Status

__all__ = ["AgentPosture", "Attempt", "HeightSolution", "Instant", "Neighbour"]

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class AgentPosture:
    """How one agent stands, and what it carries. The agent's frame looks along +x at the load.

    Args:
        base_position: origin of the root link in the agent's frame [m], shape (3,).
        base_angles: roll, pitch, yaw of the root link in the agent's frame [rad], shape (3,).
        joints: position [rad] of each joint that moves.
        torques: torque [N m] of each joint that moves.
        hand_wrenches: force [N] and moment about the grasp point [N m] on the hand, by side, in the agent's
            frame, shape (6,).
        foot_wrenches: force [N] and moment [N m] on the foot, by side, in the sole frame, shape (6,).
    """

    base_position: Array
    base_angles: Array
    joints: Mapping[str, float]
    torques: Mapping[str, float]
    hand_wrenches: Mapping[str, Array]
    foot_wrenches: Mapping[str, Array]

    @property
    def torque_norm(self) -> float:
        """Euclidean norm of the joint torques [N m]."""
        return float(np.linalg.norm(list(self.torques.values())))


@dataclass(frozen=True, slots=True)
class Instant:
    """A moment of a task; a hold has one.

    Args:
        time: since the task began [s].
        postures: by agent name.
        disturbed: by disturbance and agent name, the same base and joints with what is carried then; empty
            without disturbances.
    """

    time: float
    postures: Mapping[str, AgentPosture]
    disturbed: Mapping[str, Mapping[str, AgentPosture]] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Attempt:
    """One start of a posture problem and how it ended.

    Args:
        formulation: name of the formulation that was solved.
        start: name of the start within it.
        status: solved, or why not.
        reason: IPOPT's word, or what the check found.
        iterations: of the solve.
        seconds: wall time [s].
        cost: of the last iterate.
    """

    formulation: str
    start: str
    status: Status
    reason: str
    iterations: int
    seconds: float
    cost: float

    @property
    def name(self) -> str:
        """Formulation and start, such as `decoupled: start 2`."""
        return f"{self.formulation}: {self.start}"


@dataclass(frozen=True, slots=True)
class HeightSolution:
    """The best checked posture at one height, or why there is none.

    Args:
        height: of the load's centre [m].
        status: solved, or why not.
        reason: a sentence.
        postures: by agent name; empty unless solved.
        residuals: what the independent check found, by name (SI units); empty unless solved.
        attempts: every start tried, in order.
        attempt: that led to the postures; None unless solved.
        disturbed: by disturbance and agent name, the same base and joints with what is carried then; empty
            without disturbances.
        scene: which of the problem's scenes it is in, from zero.
    """

    height: float
    status: Status
    reason: str
    postures: Mapping[str, AgentPosture]
    residuals: Mapping[str, float]
    attempts: tuple[Attempt, ...]
    attempt: Attempt | None = None
    scene: int = 0
    disturbed: Mapping[str, Mapping[str, AgentPosture]] = field(default_factory=dict)

    @property
    def solved(self) -> bool:
        """Whether there is a checked posture."""
        return self.status is Status.SOLVED


@dataclass(frozen=True, slots=True)
class Neighbour:
    """What is known when the same design was solved at the same height in a similar scene.

    Args:
        solution: solved; its person has the joints of the one sought.
        same_load: whether only the person differs.
    """

    solution: HeightSolution
    same_load: bool
