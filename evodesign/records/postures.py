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


STEPS = {"m": (0.01, "cm"), "rad": (math.pi / 180.0, "degree"), "1": (0.01, "0.01")}
"""By unit, a small change of a limit, and what it is called; of other units it is one."""

PLURALS = {"degree": "degrees"}


class ActiveLimit(Record, frozen=True):
    """A limit that holds the postures of a case where they are, and what it costs.

    Attributes:
        name: what is limited, in words, such as `feet apart`.
        value: of the limit, in `unit`: `m`, `rad`, `N`, `N m` or `1`; empty where a term does not say.
        price_n_m: derivative of the case's effort by the value [N m per unit] (`posture.active_limits`):
            negative where a larger value saves effort.
        at_most: whether the value is the most that is allowed; otherwise the least.
        agent: whose limit it is; empty for one of robot, person and load together.
        part: joints or bodies that it is about; of a mirrored pair both, whose price is that of both.
        key: where the problem file has it, if it does.
    """

    name: str
    value: float
    unit: str
    price_n_m: float
    at_most: bool = False
    agent: str = ""
    part: str = ""
    key: str = ""

    @property
    def step(self) -> tuple[float, str]:
        """A small change of the value, and what it is called, such as `cm`."""
        return STEPS.get(self.unit, (1.0, self.unit or "unit"))

    @property
    def change_n_m(self) -> float:
        """By how much the effort changes with such a step more [N m], to first order."""
        return self.price_n_m * self.step[0]

    @property
    def words(self) -> str:
        """What is limited, and at which value, such as `feet apart, at most 50 cm`."""
        size, unit = self.step
        whole = (
            f"{self.value:.3g}" if self.unit == "1" else f"{self.value / size:.3g} {PLURALS.get(unit, unit)}"
        )
        whose = f"{self.name} of {self.part}" if self.part else self.name
        return f"{whose}, at {'most' if self.at_most else 'least'} {whole}"

    @property
    def identity(self) -> tuple[str, str, str, bool]:
        """What tells it from the other limits of a case."""
        return self.agent, self.name, self.part, self.at_most


class CaseDetail(Record, frozen=True, omit_defaults=True):
    """The postures of an undisturbed case that was solved: one instant of a hold, many of a lift.

    `limits` are those that hold the postures, the most expensive first; a lift has none.
    """

    case: Case
    instants: tuple[InstantDetail, ...]
    limits: tuple[ActiveLimit, ...] = ()

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
        return tuple(
            CaseDetail(case=self.case, instants=(instant,), limits=self.limits) for instant in self.instants
        )

    @property
    def hardest(self) -> CaseDetail:
        """The moment at which the person's torques are largest; the only one of a load held still."""
        return max(self.moments, key=lambda moment: math.hypot(*moment.agents["human"].torques_n_m.values()))

    def thinned(self, most: int) -> CaseDetail:
        """The same with so many instants at most: both ends, and what lies evenly between."""
        places = evenly(len(self.instants), most)
        kept = tuple(self.instants[place] for place in places)
        return CaseDetail(case=self.case, instants=kept, limits=self.limits)

    @property
    def few_moments(self) -> tuple[CaseDetail, ...]:
        """All instants of a load held still; five of a lift, for where there is room for few."""
        return self.thinned(5).moments
