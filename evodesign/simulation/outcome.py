"""What came of a simulation: how far load, joints, torques, soles and bodies are from the plan."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from evodesign.posture.results import Array
from evodesign.simulation.plan import AgentPlan, Plan

FALLEN = 0.2
"""How far the root link of somebody who fell is from its place [m]."""

SETTLED = 0.2
"""Time after which torques are compared [s]."""


@dataclass(frozen=True, slots=True, eq=False)
class AgentRollout:
    """What an agent did at n times, of which f are frames; j joints in the agent's order.

    Args:
        roots: places of the root link in the world [m], and its quaternions wxyz, shape (n, 7).
        positions: of the joints [rad], shape (n, j).
        torques: of the joints [N m], shape (n, j).
        soles: origins of the left and right sole in the world [m], shape (n, 2, 3).
        limits: largest torque of each joint [N m], infinite without one, shape (j,).
        feet: wrenches on the left and right foot at frames, force [N] and moment about the sole's origin
            [N m], in the sole frame, shape (f, 2, 6).
        hands: wrenches on the left and right hand, in the agent's frame, about the grasp point, likewise.
    """

    roots: Array
    positions: Array
    torques: Array
    soles: Array
    limits: Array
    feet: Array
    hands: Array


@dataclass(frozen=True, slots=True, eq=False)
class Rollout:
    """What everything did at n times.

    Args:
        times: [s], shape (n,); fewer than planned where somebody fell.
        loads: places of the load in the world [m], and its quaternions wxyz, shape (n, 7).
        agents: by name.
        fallen: who fell, by name; empty for nobody.
        frames: which times are frames of a recording, f of them.
        states: MuJoCo's `qpos` at frames, shape (f, q).
        model: MuJoCo's, for pictures.
    """

    times: Array
    loads: Array
    agents: Mapping[str, AgentRollout]
    fallen: tuple[str, ...]
    frames: tuple[int, ...]
    states: Array
    model: object


@dataclass(frozen=True, slots=True)
class AgentOutcome:
    """How far one agent is from the plan at most.

    Args:
        tracking: of any joint [rad].
        torque: of any joint after `SETTLED` [N m].
        peak: the largest planned torque of a joint [N m].
        torque_joint: which joint differs most.
        slip: of a sole along the ground from where it stood [m].
        at_limit: joints whose torque reached its limit.
        fell: whether it did.
    """

    tracking: float
    torque: float
    peak: float
    torque_joint: str
    slip: float
    at_limit: tuple[str, ...]
    fell: bool

    @property
    def torque_share(self) -> float:
        """Largest difference of a torque from the plan, relative to the plan's peak [1]."""
        return self.torque / self.peak


@dataclass(frozen=True, slots=True)
class SimulationOutcome:
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


def outcome_of(plan: Plan, rollout: Rollout) -> SimulationOutcome:
    """What a rollout says beside its plan."""
    count = len(rollout.times)
    path = np.zeros((count, 3))
    path[:, 2] = plan.heights[:count]
    upright = 1.0 - 2.0 * (rollout.loads[:, 4] ** 2 + rollout.loads[:, 5] ** 2)
    return SimulationOutcome(
        seconds=float(rollout.times[-1]),
        drift=float(np.linalg.norm(rollout.loads[:, :3] - path, axis=1).max()),
        tilt=float(np.arccos(np.clip(upright, -1.0, 1.0)).max()),
        agents={
            name: _agent(plan.agents[name], each, rollout.times, fell=name in rollout.fallen)
            for name, each in rollout.agents.items()
        },
    )


def _agent(plan: AgentPlan, rollout: AgentRollout, times: Array, *, fell: bool) -> AgentOutcome:
    count, names = len(times), list(plan.first.joints)
    off = np.abs(rollout.torques - plan.torques[:count])
    worst = off[times >= min(SETTLED, times[-1])].max(axis=0)
    most = np.abs(rollout.torques).max(axis=0)
    limited = most >= rollout.limits * (1.0 - 1e-9)
    moved = rollout.soles[:, :, :2] - rollout.soles[0, :, :2]
    return AgentOutcome(
        tracking=float(np.abs(rollout.positions - plan.positions[:count]).max()),
        torque=float(worst.max()),
        peak=plan.peak,
        torque_joint=names[int(worst.argmax())],
        slip=float(np.linalg.norm(moved, axis=2).max()),
        at_limit=tuple(name for name, each in zip(names, limited, strict=True) if each),
        fell=fell,
    )
