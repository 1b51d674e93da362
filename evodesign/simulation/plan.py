"""What a simulation is to follow: positions, speeds and torques of every joint over time.

A hold stays what it is. A lift is sampled from its splines at every step, so that nothing is interpolated
twice.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from evodesign.mechanics.floating_base import ROOT
from evodesign.motion.course import LiftCourse
from evodesign.posture.results import AgentPosture

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class AgentPlan:
    """One agent's part at n times, with j joints in the agent's order.

    Args:
        first: the posture at the beginning, in the agent's own frame.
        bases: places of the root link in that frame [m], shape (n, 3).
        positions: of the joints [rad], shape (n, j).
        rates: of the joints [rad/s], shape (n, j).
        torques: of the joints [N m], shape (n, j).
    """

    first: AgentPosture
    bases: Array
    positions: Array
    rates: Array
    torques: Array

    @property
    def peak(self) -> float:
        """The largest torque of any joint at any time [N m]."""
        return float(np.abs(self.torques).max())


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """What robot, person and load shall do.

    Args:
        step: time between two samples [s].
        agents: by name.
        heights: of the load's centre [m], shape (n,).
    """

    step: float
    agents: Mapping[str, AgentPlan]
    heights: Array

    @property
    def times(self) -> Array:
        """Of the samples [s], shape (n,)."""
        return np.asarray(self.step * np.arange(len(self.heights)))


def hold_plan(postures: Mapping[str, AgentPosture], height: float, seconds: float, step: float) -> Plan:
    """Robot and person stand still.

    Args:
        postures: by agent name.
        height: of the load's centre [m].
        seconds: for which they do [s].
        step: between two samples [s].
    """
    count = round(seconds / step) + 1
    agents = {name: _agent([posture] * count, None) for name, posture in postures.items()}
    return Plan(step, agents, np.full(count, height))


def lift_plan(course: LiftCourse, step: float) -> Plan:
    """Robot and person move as a lift says.

    Args:
        course: of the lift.
        step: between two samples [s], at most; the lift's time is a multiple of it.
    """
    times = np.linspace(0.0, course.lift.seconds, int(np.ceil(course.lift.seconds / step - 1e-9)) + 1)
    instants, motions = course.instants(times), course.motions(times)
    agents = {
        name: _agent(
            [instant.postures[name] for instant in instants],
            np.array([motion.agents[name].rates[ROOT:] for motion in motions]),
        )
        for name in instants[0].postures
    }
    return Plan(float(times[1]), agents, course.heights(times))


def _agent(postures: Sequence[AgentPosture], rates: Array | None) -> AgentPlan:
    positions = np.array([[*posture.joints.values()] for posture in postures])
    names = list(postures[0].joints)
    return AgentPlan(
        first=postures[0],
        bases=np.array([posture.base_position for posture in postures]),
        positions=positions,
        rates=np.zeros_like(positions) if rates is None else rates,
        torques=np.array([[posture.torques[name] for name in names] for posture in postures]),
    )
