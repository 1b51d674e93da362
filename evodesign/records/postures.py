"""Postures of robot and person, as a log keeps them."""

from __future__ import annotations

import math

import msgspec

from evodesign.records.cases import Case
from evodesign.tasks import Hold, Record

__all__ = ["AgentDetail", "CaseDetail", "InstantDetail", "LoadCaseDetail", "evenly"]


class AgentDetail(Record, frozen=True, omit_defaults=True):
    """Posture, torques and wrenches of an agent, in its own frame (looking along +x at the load).

    Attributes:
        base_position_m: origin of the root link, three coordinates.
        base_rpy_rad: roll, pitch and yaw of the root link.
        joints_rad: position of each joint that moves.
        torques_n_m: torque of each joint that moves.
        hand_wrenches: by side, force [N] and moment about the grasp point [N m] on the hand.
        foot_wrenches: by side, force [N] and moment [N m] on the foot, in the sole frame.
        speeds_rad_s: of each joint that moves; none of a load held still.
    """

    base_position_m: tuple[float, ...]
    base_rpy_rad: tuple[float, ...]
    joints_rad: dict[str, float]
    torques_n_m: dict[str, float]
    hand_wrenches: dict[str, tuple[float, ...]]
    foot_wrenches: dict[str, tuple[float, ...]]
    speeds_rad_s: dict[str, float] = msgspec.field(default_factory=dict)


class LoadCaseDetail(Record, frozen=True):
    """Torques and wrenches of an agent under a disturbance, in the same posture; as in `AgentDetail`."""

    torques_n_m: dict[str, float]
    hand_wrenches: dict[str, tuple[float, ...]]
    foot_wrenches: dict[str, tuple[float, ...]]


class InstantDetail(Record, frozen=True, omit_defaults=True):
    """The postures at one moment of a task, by the agents' names.

    `time_s` is counted from the task's beginning, 0 for a load held still; `disturbed` holds torques and
    wrenches in the same postures, by disturbance and agent. `load_height_m` is there where the load moves.
    """

    time_s: float
    agents: dict[str, AgentDetail]
    disturbed: dict[str, dict[str, LoadCaseDetail]] = msgspec.field(default_factory=dict)
    load_height_m: float | None = None


def evenly(count: int, most: int) -> tuple[int, ...]:
    """So many places at most of a list of some length: both ends, and what lies evenly between."""
    return tuple(dict.fromkeys(round((count - 1) * share / (most - 1)) for share in range(most)))


class CaseDetail(Record, frozen=True):
    """The postures of an undisturbed case that was solved: one instant of a hold, many of a lift."""

    case: Case
    instants: tuple[InstantDetail, ...]

    @property
    def agents(self) -> dict[str, AgentDetail]:
        """The postures of the only instant, by the agents' names."""
        (instant,) = self.instants
        return instant.agents

    @property
    def time_s(self) -> float:
        """Of the only instant."""
        (instant,) = self.instants
        return instant.time_s

    @property
    def height_m(self) -> float:
        """Of the load's centre at the only instant."""
        (instant,) = self.instants
        return self.case.task.heights[0] if instant.load_height_m is None else instant.load_height_m

    @property
    def place(self) -> str:
        """Height and, in a lift, time of the only instant, such as `1.07 m at 0.8 s`."""
        if isinstance(self.case.task, Hold):
            return str(self.case.task)
        return f"{self.height_m:.3g} m at {self.time_s:.3g} s"

    @property
    def moments(self) -> tuple[CaseDetail, ...]:
        """Its instants, each for itself."""
        return tuple(CaseDetail(case=self.case, instants=(instant,)) for instant in self.instants)

    @property
    def hardest(self) -> CaseDetail:
        """The moment at which the person's torques are largest; the only one of a load held still."""
        return max(self.moments, key=lambda moment: math.hypot(*moment.agents["human"].torques_n_m.values()))

    def thinned(self, most: int) -> CaseDetail:
        """The same with so many instants at most: both ends, and what lies evenly between."""
        places = evenly(len(self.instants), most)
        return CaseDetail(case=self.case, instants=tuple(self.instants[place] for place in places))

    @property
    def few_moments(self) -> tuple[CaseDetail, ...]:
        """All instants of a load held still; five of a lift, for where there is room for few."""
        return self.thinned(5).moments
