"""Postures of robot and person, as a log keeps them."""

from __future__ import annotations

import math

import msgspec

from evodesign.records.cases import Case
from evodesign.tasks import Hold, Record


class AgentDetail(Record, frozen=True, omit_defaults=True):
    """Posture, torques and wrenches of an agent.

    The agent's own frame has its origin on the ground under the load, x in the direction in which the agent
    looks at the load, z up: the robot's is the world's, the person's the world's turned half round about z.

    Attributes:
        base_position_m: origin of the root link in the agent's own frame [m], three coordinates.
        base_rpy_rad: roll, pitch and yaw [rad] of the root link in it, as a URDF has them: the rotation
            R_z(yaw) R_y(pitch) R_x(roll).
        joints_rad: position by name of each joint that moves [rad], of a slide [m].
        torques_n_m: torque by name of each joint that moves [N m], of a slide the force [N]; what the joint
            exerts on its child, positive about its axis.
        wrenches: on the agent, by contact (`left_foot`, `right_foot`, `left_hand`, `right_hand`) six numbers:
            force [N], then moment [N m]. On a hand the moment is about the grasp point, and both are in the
            agent's own frame; on a foot it is about the sole's origin, and both are in the frame of the sole,
            whose z is its normal.
        speeds_rad_s: speed by name of each joint that moves [rad/s], of a slide [m/s]; none of a load held
            still.
    Example:
        >>> person = design.postures[0].agents["human"]
        >>> person
        <posture of 33 joints, |torque| 0.08849 N m>
        >>> [round(each, 2) for each in person.base_position_m]
        [-0.5, -0.0, 0.85]
        >>> round(person.joints_rad["jLeftElbow_rotz"], 2)
        -0.82
        >>> force_n, moment_n_m = person.wrenches["left_hand"][:3], person.wrenches["left_hand"][3:]
        >>> round(force_n[2], 1)
        -13.7
    """

    base_position_m: tuple[float, ...]
    base_rpy_rad: tuple[float, ...]
    joints_rad: dict[str, float]
    torques_n_m: dict[str, float]
    wrenches: dict[str, tuple[float, ...]]
    speeds_rad_s: dict[str, float] = msgspec.field(default_factory=dict)

    def __repr__(self) -> str:
        return f"<posture of {len(self.joints_rad)} joints, |torque| {self.torque_norm_n_m:.4g} N m>"

    @property
    def torque_norm_n_m(self) -> float:
        """Euclidean norm of the joint torques [N m]."""
        return math.hypot(*self.torques_n_m.values())


class LoadCaseDetail(Record, frozen=True):
    """Torques [N m] and wrenches [N, N m] of an agent under a disturbance, in the same posture.

    Attributes:
        torques_n_m: as in `AgentDetail`, like the others.
        wrenches: six numbers by contact.
    Example:
        >>> design.postures[0].instants[0].disturbed["heavier"]["robot"]
        <load case of 13 joints, |torque| 0.1779 N m>
    """

    torques_n_m: dict[str, float]
    wrenches: dict[str, tuple[float, ...]]

    def __repr__(self) -> str:
        norm = math.hypot(*self.torques_n_m.values())
        return f"<load case of {len(self.torques_n_m)} joints, |torque| {norm:.4g} N m>"


class InstantDetail(Record, frozen=True, omit_defaults=True):
    """The postures at one moment of a task.

    Attributes:
        time_s: since the task began [s]; 0 for a load held still.
        agents: the posture of `robot` and of `human`.
        disturbed: torques and wrenches in the same postures, by the disturbance's name, then by agent.
        load_height_m: height of the load's centre above the ground [m]; None where it is held still, and the
            task has its height.
    Example:
        >>> instant = design.postures[0].instants[0]
        >>> instant.time_s, sorted(instant.agents), sorted(instant.disturbed)
        (0.0, ['human', 'robot'], ['heavier'])
    """

    time_s: float
    agents: dict[str, AgentDetail]
    disturbed: dict[str, dict[str, LoadCaseDetail]] = msgspec.field(default_factory=dict)
    load_height_m: float | None = None

    def __repr__(self) -> str:
        return f"<postures at {self.time_s:g} s: {_norms(self)}>"


def _norms(instant: InstantDetail) -> str:
    """The torque norm of each agent [N m]."""
    return ", ".join(f"{name} {agent.torque_norm_n_m:.4g} N m" for name, agent in instant.agents.items())


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
    """The postures of an undisturbed case that was solved.

    Attributes:
        case: person, load and task; `case.name` says all of it, such as `short, 5 kg, 0.8 m`.
        instants: one of a load held still, many of a lift, in order of time.
        limits: those that hold the postures, the most expensive first; a lift has none.
    Example:
        >>> design.postures[0]
        <postures of short, 0.8 m: robot 0.1603 N m, human 0.08849 N m>
        >>> design.postures[0].case.person, design.postures[0].height_m
        ('short', 0.8)
        >>> round(design.postures[0].agents["robot"].torques_n_m["l_elbow"], 4)
        -0.0547
    """

    case: Case
    instants: tuple[InstantDetail, ...]
    limits: tuple[ActiveLimit, ...] = ()

    def __repr__(self) -> str:
        told = f"{len(self.instants)} instants" if len(self.instants) != 1 else _norms(self.instants[0])
        return f"<postures of {self.case.name}: {told}>"

    @property
    def agents(self) -> dict[str, AgentDetail]:
        """The posture of `robot` and of `human` at the only instant; a lift has many, in `instants`."""
        (instant,) = self.instants
        return instant.agents

    @property
    def time_s(self) -> float:
        """Of the only instant, since the task began [s]."""
        (instant,) = self.instants
        return instant.time_s

    @property
    def height_m(self) -> float:
        """Of the load's centre above the ground at the only instant [m]."""
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
        """The moment at which the person's torques [N m] are largest; the only one of a load held still."""

        def persons_torque(moment: CaseDetail) -> float:
            person = moment.agents.get("human")
            return 0.0 if person is None else person.torque_norm_n_m

        return max(self.moments, key=persons_torque)

    def thinned(self, most: int) -> CaseDetail:
        """The same with so many instants at most: both ends, and what lies evenly between."""
        places = evenly(len(self.instants), most)
        kept = tuple(self.instants[place] for place in places)
        return CaseDetail(case=self.case, instants=kept, limits=self.limits)

    @property
    def few_moments(self) -> tuple[CaseDetail, ...]:
        """All instants of a load held still; five of a lift, for where there is room for few."""
        return self.thinned(5).moments
