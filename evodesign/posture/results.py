"""What a posture problem gives for a case: postures, or the reason why there is none."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from evodesign.nlp.method import MethodName
from evodesign.nlp.solver import RawSolution
from evodesign.records import Case, Status

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class AgentPosture:
    """How one agent stands, and what it carries. The agent's frame looks along +x at the load.

    Args:
        base_position: origin of the root link in the agent's frame [m], shape (3,).
        base_angles: roll, pitch, yaw of the root link in the agent's frame [rad], shape (3,).
        joints: position [rad] of each joint that moves.
        torques: torque [N m] of each joint that moves.
        wrenches: force [N] and moment [N m] on the agent by the name of its contact, shape (6,): on a hand
            about the grasp point in the agent's frame, on a foot in the sole frame.
        speeds: of each joint that moves [rad/s]; none of a load held still.
    """

    base_position: Array
    base_angles: Array
    joints: Mapping[str, float]
    torques: Mapping[str, float]
    wrenches: Mapping[str, Array]
    speeds: Mapping[str, float] = field(default_factory=dict)

    @property
    def torque_norm(self) -> float:
        """Euclidean norm of the joint torques [N m]."""
        return float(np.linalg.norm(list(self.torques.values())))


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
        method: who solved.
    """

    formulation: str
    start: str
    status: Status
    reason: str
    iterations: int
    seconds: float
    cost: float
    method: MethodName

    @property
    def name(self) -> str:
        """Formulation and start, such as `symmetric: start 2`."""
        return f"{self.formulation}: {self.start}"


@dataclass(frozen=True, slots=True)
class Instant:
    """How the agents stand at one moment of a task, and what they carry.

    Args:
        time: since the task began [s]; 0 for a load held still.
        postures: by agent name.
        disturbed: by disturbance and agent name, the same base and joints with what is carried then; empty
            without disturbances.
        height: of the load's centre [m] where it moves; None for a load held still.
    """

    time: float
    postures: Mapping[str, AgentPosture]
    disturbed: Mapping[str, Mapping[str, AgentPosture]] = field(default_factory=dict)
    height: float | None = None


@dataclass(frozen=True, slots=True)
class CaseSolution:
    """The best checked posture in a case, or why there is none.

    Args:
        case: undisturbed; what is carried under disturbances goes with its instants.
        status: solved, or why not.
        reason: a sentence.
        instants: of the task, one for a load held still; none unless solved.
        residuals: what the independent check found, by name (SI units); empty unless solved.
        attempts: every start tried, in order.
        attempt: that led to the postures; None unless solved.
        raw: the solve that gave the instants.
    """

    case: Case
    status: Status
    reason: str
    instants: tuple[Instant, ...] = ()
    residuals: Mapping[str, float] = field(default_factory=dict)
    attempts: tuple[Attempt, ...] = ()
    attempt: Attempt | None = None
    raw: RawSolution | None = None

    @property
    def solved(self) -> bool:
        """Whether there is a checked posture."""
        return self.status is Status.SOLVED

    @property
    def times(self) -> tuple[float, ...]:
        """Of the instants [s]."""
        return tuple(instant.time for instant in self.instants)

    @property
    def postures(self) -> Mapping[str, AgentPosture]:
        """Those of the only instant, by agent name."""
        (instant,) = self.instants
        return instant.postures

    @property
    def disturbed(self) -> Mapping[str, Mapping[str, AgentPosture]]:
        """What is borne in the only instant, by disturbance and agent name."""
        (instant,) = self.instants
        return instant.disturbed


@dataclass(frozen=True, slots=True)
class Neighbour:
    """What is known when the same design did the same task in a similar scene.

    Args:
        solution: solved; its person has the joints of the one sought.
        unchecked: whether nothing differs, and the solution is to be checked.
    """

    solution: CaseSolution
    unchecked: bool = False
