"""What is remembered: the values that cross process borders and reach the disk.

Every record is immutable, refuses unknown fields, and is written as JSON. Units are SI; torque norms
are Euclidean norms over an agent's moving joints [N m]. A value that does not exist (the torque of a
height that was not reached) is absent or None, never a large number.
"""

from __future__ import annotations

from collections.abc import Mapping
from enum import StrEnum

import msgspec

__all__ = [
    "FORMAT_VERSION",
    "AgentDetail",
    "Assessed",
    "Assessment",
    "Detail",
    "Evaluation",
    "Front",
    "Generation",
    "Genome",
    "HeightDetail",
    "HeightOutcome",
    "LoadCaseDetail",
    "Objective",
    "Parameter",
    "ProblemSource",
    "ReachOutcome",
    "RunHeader",
    "SearchSettings",
    "SearchStage",
    "Sense",
    "Status",
    "Turn",
    "choice_at",
    "design_of",
    "materials_of",
    "middle_of",
    "worst_status",
]

FORMAT_VERSION = 1
"""Version of the records below; a reader refuses a log of a later one."""

Genome = tuple[float, ...]
"""A point of the unit cube, one coordinate per design parameter."""


class Status(StrEnum):
    """How a computation ended. The order is from best to worst."""

    SOLVED = "solved"
    INFEASIBLE = "infeasible"
    ITERATION_LIMIT = "iteration limit"
    TIME_LIMIT = "time limit"
    NUMERICAL_FAILURE = "numerical failure"
    WORKER_LOST = "worker lost"


def worst_status(statuses: list[Status]) -> Status:
    """The last of the given statuses in the order of `Status`; SOLVED for none."""
    order = list(Status)
    return max(statuses, key=order.index, default=Status.SOLVED)


class Sense(StrEnum):
    """Direction in which an objective improves."""

    MINIMISE = "minimise"
    MAXIMISE = "maximise"


class Record(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Base of all records: immutable, strict, keyword-only."""


class Objective(Record, frozen=True):
    """One objective of a problem, in its natural sense and unit."""

    name: str
    sense: Sense
    unit: str


class Parameter(Record, frozen=True, omit_defaults=True):
    """One design parameter: a length multiplier (unit "1") or a density (unit "kg/m^3").

    A genome's coordinate u in [0, 1] stands for (1 - u) lower + u upper. With n choices, it stands for the
    choice in whose n-th part of [0, 1] it lies, and is the middle of that part.

    Attributes:
        choices: the only values that there are, rising; none if every value within the bounds is one.
        materials: the choices' names.
    """

    name: str
    lower: float
    upper: float
    unit: str
    choices: tuple[float, ...] = ()
    materials: tuple[str, ...] = ()

    def value_at(self, coordinate: float) -> float:
        """The value that a genome's coordinate stands for."""
        if self.choices:
            return self.choices[choice_at(coordinate, len(self.choices))]
        return _between(self.lower, self.upper, coordinate)

    def material_of(self, value: float) -> str | None:
        """The material of a value; None for a parameter without materials."""
        return dict(zip(self.choices, self.materials, strict=False)).get(value)


def choice_at(coordinate: float, count: int) -> int:
    """Which of so many equal parts of [0, 1] holds a coordinate."""
    return min(max(int(coordinate * count), 0), count - 1)


def middle_of(choice: int, count: int) -> float:
    """The middle of one of so many equal parts of [0, 1]: the coordinate of a choice."""
    return (choice + 0.5) / count


def design_of(parameters: tuple[Parameter, ...], genome: Genome) -> dict[str, float]:
    """Parameter values, by name, of a genome."""
    return {
        parameter.name: parameter.value_at(coordinate)
        for parameter, coordinate in zip(parameters, genome, strict=True)
    }


def _between(lower: float, upper: float, share: float) -> float:
    """The number at a share of the way from lower to upper, never past them by rounding."""
    return min(max(lower * (1.0 - share) + upper * share, lower), upper)


def materials_of(parameters: tuple[Parameter, ...], design: Mapping[str, float]) -> dict[str, str]:
    """The material's name of each parameter that has one in a design."""
    found = {parameter.name: parameter.material_of(design[parameter.name]) for parameter in parameters}
    return {name: material for name, material in found.items() if material is not None}


class ReachOutcome(Record, frozen=True):
    """Interval of load heights [m] that the robot can hold; bounds are None when not solved."""

    lowest_m: float | None
    highest_m: float | None
    status: Status
    reason: str


class HeightOutcome(Record, frozen=True, omit_defaults=True):
    """One posture problem of one design, in short; person and load are named where there are several.

    `disturbed` holds torque norms by disturbance and agent, where the problem has disturbances.
    """

    height_m: float
    status: Status
    reason: str
    robot_torque_norm: float | None
    human_torque_norm: float | None
    iterations: int
    residual: float | None
    human_name: str = ""
    payload_name: str = ""
    disturbed: dict[str, dict[str, float]] = {}


class Assessment(Record, frozen=True):
    """The results of a design: a property of problem and genome alone.

    `objectives` holds natural values (a maximised one is not negated) and lacks those that do not exist.
    `violation` is the sum of constraint violations [m], zero for a feasible design, None when a failure
    left it unknown.
    """

    design: dict[str, float]
    objectives: dict[str, float]
    violation: float | None
    status: Status
    reason: str
    reach: ReachOutcome | None = None
    heights: tuple[HeightOutcome, ...] = ()


class AgentDetail(Record, frozen=True):
    """Posture, torques and wrenches of an agent, in its own frame (looking along +x at the load).

    Attributes:
        base_position_m: origin of the root link, three coordinates.
        base_rpy_rad: roll, pitch and yaw of the root link.
        joints_rad: position of each joint that moves.
        torques_n_m: torque of each joint that moves.
        hand_wrenches: by side, force [N] and moment about the grasp point [N m] on the hand.
        foot_wrenches: by side, force [N] and moment [N m] on the foot, in the sole frame.
    """

    base_position_m: tuple[float, ...]
    base_rpy_rad: tuple[float, ...]
    joints_rad: dict[str, float]
    torques_n_m: dict[str, float]
    hand_wrenches: dict[str, tuple[float, ...]]
    foot_wrenches: dict[str, tuple[float, ...]]


class LoadCaseDetail(Record, frozen=True):
    """Torques and wrenches of an agent under a disturbance, in the same posture; as in `AgentDetail`."""

    torques_n_m: dict[str, float]
    hand_wrenches: dict[str, tuple[float, ...]]
    foot_wrenches: dict[str, tuple[float, ...]]


class HeightDetail(Record, frozen=True, omit_defaults=True):
    """The postures at one height of the load, by the agents' names; who and what as in `HeightOutcome`.

    `disturbed` holds torques and wrenches in the same postures, by disturbance and agent.
    """

    height_m: float
    agents: dict[str, AgentDetail]
    human_name: str = ""
    payload_name: str = ""
    disturbed: dict[str, dict[str, LoadCaseDetail]] = {}


class Assessed(Record, frozen=True):
    """What a worker gives back: the results of a genome, and its postures at the heights that were solved."""

    assessment: Assessment
    heights: tuple[HeightDetail, ...] = ()


class Detail(Record, frozen=True):
    """The postures of an evaluation that no earlier one dominates: every design of a front has one."""

    evaluation: int
    heights: tuple[HeightDetail, ...]


class Turn(Record, frozen=True):
    """When an asynchronous search was asked for a genome.

    Attributes:
        number: in the order of asking.
        told: how many evaluations the search had been told.
    """

    number: int
    told: int


class Evaluation(Record, frozen=True, omit_defaults=True):
    """One assessed genome with its place in the run. Only `seconds` and `worker` may differ between runs.

    An asynchronous run has a `turn`, and counts its evaluations in the order in which they came.
    """

    number: int
    generation: int
    genome: Genome
    assessment: Assessment
    seconds: float
    worker: str
    turn: Turn | None = None

    @property
    def feasible(self) -> bool:
        """Whether every constraint holds."""
        return self.assessment.violation == 0.0


class Generation(Record, frozen=True):
    """State of a run after a generation, as scalars that a plot panel shows.

    `hypervolume` is taken against `reference` (natural values, fixed at the first generation that holds a
    feasible design); both are None before that.
    """

    number: int
    evaluations: int
    feasible_share: float
    hypervolume: float | None
    reference: dict[str, float] | None
    best: dict[str, float]
    seconds: float


class Front(Record, frozen=True):
    """Numbers of the non-dominated feasible evaluations after a generation."""

    generation: int
    evaluations: tuple[int, ...]


class SearchStage(Record, frozen=True):
    """What a search was for its first so many generations, before a branch made it another one."""

    algorithm: str
    population: int
    seed: int
    generations: int


class SearchSettings(Record, frozen=True):
    """Everything that determines a search beside the evaluations it is told.

    `past` holds the stages that a branch went through before, the earliest first; `start` is of the earliest.
    `choices` is left out where no coordinate is discrete; else it says of each coordinate how many choices
    there are, 0 for a continuous one.
    """

    algorithm: str
    dimension: int
    objectives: int
    population: int
    seed: int
    start: tuple[Genome, ...] = ()
    past: tuple[SearchStage, ...] = ()
    asynchronous: bool = False
    choices: tuple[int, ...] | msgspec.UnsetType = msgspec.UNSET

    @property
    def counts(self) -> tuple[int, ...]:
        """The choices of every coordinate, 0 for a continuous one."""
        return (0,) * self.dimension if self.choices is msgspec.UNSET else self.choices

    @property
    def discrete(self) -> bool:
        """Whether some coordinate is discrete."""
        return any(self.counts)


class ProblemSource(Record, frozen=True):
    """A problem and every file that it names, as text: enough to rebuild it on any machine.

    Attributes:
        path: where the problem file was read, for messages.
        text: the problem file.
        files: the files that it names, by the name that it uses.
        symmetry: of postures, if it was chosen beside the file.
    """

    path: str
    text: str
    files: dict[str, str]
    symmetry: str | None = None


class RunHeader(Record, frozen=True):
    """First message of every segment of a run's log.

    `budget` counts evaluations of the run, `hours` wall time of each session, and `stagnation_generations`
    generations in which the hypervolume may stand still.
    """

    format_version: int
    problem: ProblemSource
    problem_name: str
    parameters: tuple[Parameter, ...]
    objectives: tuple[Objective, ...]
    search: SearchSettings
    budget: int
    versions: dict[str, str]
    git: str | None
    started: str
    hours: float | None = None
    stagnation_generations: int | None = None
