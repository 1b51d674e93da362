"""What came of a simulation: how far load, joints, torques, soles and bodies are from the plan."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from evodesign.posture.results import Array
from evodesign.simulation.plan import AgentPlan, Plan

__all__ = ["FALLEN", "SETTLED", "AgentOutcome", "AgentRecord", "Outcome", "Record", "outcome_of"]

FALLEN = 0.2
"""How far the root link of somebody who fell is from its place [m]."""

SETTLED = 0.2
"""Time after which torques are compared [s]."""


@dataclass(frozen=True, slots=True, eq=False)
class AgentRecord:
    """What an agent did at n times, j joints in the agent's order.

    Args:
        roots: places of the root link in the world [m], and its quaternions wxyz, shape (n, 7).
        positions: of the joints [rad], shape (n, j).
        torques: of the joints [N m], shape (n, j).
        soles: origins of the left and right sole in the world [m], shape (n, 2, 3).
        feet: wrenches on the left and right foot, force [N] and moment [N m] about the sole's origin, in
            the sole frame, shape (n, 2, 6).
        hands: wrenches on the left and right hand, in the agent's frame, about the grasp point, likewise.
        limits: largest torque of each joint [N m], infinite without one, shape (j,).
    """

    roots: Array
    positions: Array
    torques: Array
    soles: Array
    limits: Array


@dataclass(frozen=True, slots=True, eq=False)
class Record:
    """What everything did at n times.

    Args:
        times: [s], shape (n,); fewer than planned where somebody fell.
        loads: places of the load in the world [m], and its quaternions wxyz, shape (n, 7).
        agents: by name.
        fallen: who fell, by name; empty for nobody.
    """

    times: Array
    loads: Array
    agents: Mapping[str, AgentRecord]
    fallen: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class AgentOutcome:
    """How far one agent is from the plan at most.

    Args:
        tracking: of any joint [rad].
        torque: of any joint after `SETTLED`, as a share of the largest planned torque of a joint [1].
        torque_joint: which joint that is.
        slip: of a sole along the ground from where it stood [m].
        at_limit: joints whose torque reached its limit.
        fell: whether it did.
    """

    tracking: float
    torque: float
    torque_joint: str
    slip: float
    at_limit: tuple[str, ...]
    fell: bool


@dataclass(frozen=True, slots=True)
class Outcome:
    """What a simulation says of a hold or lift.

    Args:
        seconds: that were simulated [s].
        drift: largest distance of the load's centre from its path [m].
        tilt: largest angle of the load from level [rad].
        agents: by name.
    """

    seconds: float
    drift: float
    tilt: float
    agents: Mapping[str, AgentOutcome]

    @property
    def stands(self) -> bool:
        """Whether nobody fell."""
        return not any(agent.fell for agent in self.agents.values())


def outcome_of(plan: Plan, record: Record) -> Outcome:
    """What a record says beside its plan."""
    count = len(record.times)
    path = np.zeros((count, 3))
    path[:, 2] = plan.heights[:count]
    upright = 1.0 - 2.0 * (record.loads[:, 4] ** 2 + record.loads[:, 5] ** 2)
    agents = {
        name: _agent(plan.agents[name], each, record.times, fell=name in record.fallen)
        for name, each in record.agents.items()
    }
    return Outcome(
        seconds=float(record.times[-1]),
        drift=float(np.linalg.norm(record.loads[:, :3] - path, axis=1).max()),
        tilt=float(np.arccos(np.clip(upright, -1.0, 1.0)).max()),
        agents=agents,
    )


def _agent(plan: AgentPlan, record: AgentRecord, times: Array, *, fell: bool) -> AgentOutcome:
    count = len(times)
    names = list(plan.first.joints)
    off = np.abs(record.torques - plan.torques[:count]) / plan.peak
    settled = off[times >= SETTLED]
    worst = settled.max(axis=0) if len(settled) else off.max(axis=0)
    limited = (np.abs(record.torques) >= record.limits * (1.0 - 1e-9)).any(axis=0)
    moved = record.soles[:, :, :2] - record.soles[0, :, :2]
    return AgentOutcome(
        tracking=float(np.abs(record.positions - plan.positions[:count]).max()),
        torque=float(worst.max()),
        torque_joint=names[int(worst.argmax())],
        slip=float(np.linalg.norm(moved, axis=2).max()),
        at_limit=tuple(name for name, each in zip(names, limited, strict=True) if each),
        fell=fell,
    )
