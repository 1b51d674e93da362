"""What is remembered: the values that cross process borders and reach the disk.

Every record is immutable, refuses unknown fields, and is written as JSON. Units are SI; torque norms
are Euclidean norms over an agent's moving joints [N m]. A value that does not exist (the torque of a
case that was not solved) is absent or None, never a large number.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from enum import StrEnum
from typing import Annotated, Any

import msgspec
from msgspec import Meta

from evodesign.tasks import Hold, Lift, Record, Task

__all__ = [
    "FORMAT_VERSION",
    "NO_SECONDS",
    "SUM",
    "AgentDetail",
    "Assessed",
    "Assessment",
    "Case",
    "CaseDetail",
    "CaseGradient",
    "CaseOutcome",
    "Constraint",
    "Descriptor",
    "Detail",
    "Evaluation",
    "Front",
    "Generation",
    "Genome",
    "Gradients",
    "Hold",
    "InstantDetail",
    "Lift",
    "LoadCaseDetail",
    "Objective",
    "Parameter",
    "ProblemSource",
    "ReachOutcome",
    "Record",
    "RunHeader",
    "SearchSettings",
    "SearchStage",
    "Sense",
    "Status",
    "Task",
    "Turn",
    "choice_at",
    "design_of",
    "evenly",
    "materials_of",
    "middle_of",
    "task_names",
    "worst_status",
]

FORMAT_VERSION = 2
"""Version of the records below; a reader refuses a log of a later one, and upgrades an earlier one."""

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


class Case(Record, frozen=True, kw_only=True, omit_defaults=True):
    """A person who does a task with a load, undisturbed or under a disturbance.

    Person, load and disturbance are names of the problem, empty where there is one person or load, or no
    disturbance.
    """

    person: str = ""
    payload: str = ""
    task: Task
    disturbance: str = ""

    @property
    def pair(self) -> tuple[str, str]:
        """Names of person and load."""
        return self.person, self.payload

    @property
    def label(self) -> str:
        """Person and load, such as `short, 5 kg`; empty where there is one of each."""
        return ", ".join(name for name in self.pair if name)

    @property
    def name(self) -> str:
        """Everything that tells it from other cases, such as `short, 5 kg, 0.8 m, pushed`."""
        return ", ".join(name for name in (self.label, str(self.task), self.disturbance) if name)


def task_names(case: Case) -> dict[str, Any]:
    """A case as JSON files for others tell it: height or lift, and names only where there are several."""
    names = {"human_name": case.person, "payload_name": case.payload}
    task = msgspec.to_builtins(case.task)
    told = {key: value for key, value in task.items() if key not in ("kind", "knots")}
    return {**told, **{key: name for key, name in names.items() if name}}


class Objective(Record, frozen=True):
    """One objective of a problem, in its natural sense and unit."""

    name: str
    sense: Sense
    unit: str


class Constraint(Record, frozen=True):
    """Bounds of a quantity, in its unit; at least one of them is there."""

    name: str
    unit: str
    lower: float | None
    upper: float | None


class Parameter(Record, frozen=True, omit_defaults=True):
    """One design parameter: length multiplier or allocation (unit "1"), density, wall or rated torque.

    A genome's coordinate u in [0, 1] stands for (1 - u) lower + u upper, or on a logarithmic scale for
    lower^(1 - u) upper^u. With n choices, it stands for the choice in whose n-th part of [0, 1] it lies, and
    is the middle of that part.

    Attributes:
        choices: the only values that there are, rising; none if every value within the bounds is one.
        materials: the choices' names: materials, or models of actuators.
        logarithmic: whether the scale is.
    """

    name: str
    lower: float
    upper: float
    unit: str
    choices: tuple[float, ...] = ()
    materials: tuple[str, ...] = ()
    logarithmic: bool = False

    def value_at(self, coordinate: float) -> float:
        """The value that a genome's coordinate stands for."""
        if self.choices:
            return self.choices[choice_at(coordinate, len(self.choices))]
        if self.logarithmic:
            value = float(self.lower * (self.upper / self.lower) ** coordinate)
            return min(max(value, self.lower), self.upper)
        return _between(self.lower, self.upper, coordinate)

    def share_of(self, value: float) -> float:
        """How far a value lies between the bounds, on the parameter's scale."""
        if self.logarithmic:
            return math.log(value / self.lower) / math.log(self.upper / self.lower)
        return (value - self.lower) / (self.upper - self.lower)

    def slope_at(self, value: float) -> float:
        """How fast the value grows with the genome's coordinate; 0 for one of choices."""
        if self.choices:
            return 0.0
        return value * math.log(self.upper / self.lower) if self.logarithmic else self.upper - self.lower

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


class CaseOutcome(Record, frozen=True, omit_defaults=True):
    """One undisturbed case of one design, in short.

    `disturbed` holds torque norms by disturbance and agent, where the problem has disturbances. `fallbacks`
    counts solves by IPOPT because the native method had found no posture.
    """

    case: Case
    status: Status
    reason: str
    robot_torque_norm: float | None
    human_torque_norm: float | None
    iterations: int
    residual: float | None
    disturbed: dict[str, dict[str, float]] = msgspec.field(default_factory=dict)
    fallbacks: int = 0


NO_SECONDS = 0.0
"""One object, by whose identity msgspec leaves a default out of what is written."""


class CaseGradient(Record, frozen=True, omit_defaults=True):
    """A quantity in one case, in its unit, and how it moves with the genome.

    Attributes:
        value: of the quantity.
        slopes: as in `Gradients.values`, in the order of the continuous parameters; None where the
            posture has no derivative.
    """

    value: float
    slopes: tuple[float, ...] | None = None


class Gradients(Record, frozen=True, omit_defaults=True):
    """How quantities of a design move with its genome.

    Attributes:
        values: by quantity (objectives, constrained quantities, and `height` for the margin by which required
            heights are missed) and by parameter, the derivative in the quantity's unit per unit of the
            genome's coordinate. Discrete parameters have none.
        absent: by quantity, why its gradient does not exist.
        cases: by objective that is the mean over a few cases, what it is the mean of.
    """

    values: dict[str, dict[str, float]]
    absent: dict[str, str]
    cases: dict[str, tuple[CaseGradient, ...]] = msgspec.field(default_factory=dict)


class Assessment(Record, frozen=True):
    """The results of a design: a property of problem and genome alone.

    `objectives` holds natural values (a maximised one is not negated) and lacks those that do not exist, as
    does `constraints`, which is left out where there are none. `violation` is zero for a feasible design,
    None when a failure left it unknown, and otherwise what designs are ranked by: the metres by which
    required heights are missed, plus for each constraint its excess relative to its bound
    (`evodesign.violations`). `judged` holds the objectives of a design that IPOPT solved, too, to judge the
    native method (`evodesign.problem.judge`). `gradients` is there where the search asked for them. `rated`
    holds the rated torques [N m] of sized actuators, by the parameter that is their margin.
    """

    design: dict[str, float]
    objectives: dict[str, float]
    violation: float | None
    status: Status
    reason: str
    reach: ReachOutcome | None = None
    cases: tuple[CaseOutcome, ...] = ()
    constraints: dict[str, float] | msgspec.UnsetType = msgspec.UNSET
    judged: dict[str, float] | msgspec.UnsetType = msgspec.UNSET
    gradients: Gradients | msgspec.UnsetType = msgspec.UNSET
    rated: dict[str, float] | msgspec.UnsetType = msgspec.UNSET

    @property
    def rated_torques(self) -> dict[str, float]:
        """Those of sized actuators [N m], by the parameter that is their margin, if there are any."""
        return {} if self.rated is msgspec.UNSET else self.rated

    @property
    def constrained(self) -> dict[str, float]:
        """Values of constrained quantities by name, without those that do not exist."""
        return {} if self.constraints is msgspec.UNSET else self.constraints


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


class Assessed(Record, frozen=True):
    """What a worker gives back: the results of a genome, and its postures in the cases that were solved.

    `gradient_seconds` is what the gradients took of the evaluation's time [s].
    """

    assessment: Assessment
    cases: tuple[CaseDetail, ...] = ()
    gradient_seconds: float = NO_SECONDS


class Detail(Record, frozen=True):
    """The postures of an evaluation that no earlier one dominates: every design of a front has one."""

    evaluation: int
    cases: tuple[CaseDetail, ...]


class Turn(Record, frozen=True):
    """When an asynchronous search was asked for a genome.

    Attributes:
        number: in the order of asking.
        told: how many evaluations the search had been told.
    """

    number: int
    told: int


class Evaluation(Record, frozen=True, omit_defaults=True):
    """One assessed genome with its place in the run. Only times and `worker` may differ between runs.

    `gradient_seconds` are those of `seconds` that gradients took. An asynchronous run has a `turn`, and
    counts its evaluations in the order in which they came.
    """

    number: int
    generation: int
    genome: Genome
    assessment: Assessment
    seconds: float
    worker: str
    turn: Turn | None = None
    gradient_seconds: float = NO_SECONDS

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


SUM = " + "
"""Between the names of quantities that a descriptor adds up."""


class Descriptor(Record, frozen=True):
    """What tells kinds of designs apart: the sum of some quantities, within bounds in so many parts.

    Attributes:
        name: of a quantity, as conditions name it; several are joined by ` + `.
        lower: of the bounds; None where designs tell.
        upper: likewise.
        cells: parts between them.
    """

    name: str
    lower: float | None
    upper: float | None
    cells: Annotated[int, Meta(ge=1, le=1000)]


class SearchSettings(Record, frozen=True):
    """Everything that determines a search beside the evaluations it is told.

    `past` holds the stages that a branch went through before, the earliest first; `start` is of the earliest.
    `choices` is left out where no coordinate is discrete; else it says of each coordinate how many choices
    there are, 0 for a continuous one. `gradients` is left out where evaluations have none, `reference`
    where none is given: of each objective, as it is minimised, the value beyond which a design counts for
    nothing. `descriptors` is left out where none are named.
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
    gradients: bool | msgspec.UnsetType = msgspec.UNSET
    reference: tuple[float | None, ...] | msgspec.UnsetType = msgspec.UNSET
    descriptors: tuple[Descriptor, ...] | msgspec.UnsetType = msgspec.UNSET

    @property
    def described(self) -> tuple[Descriptor, ...]:
        """The descriptors that are named."""
        return () if self.descriptors is msgspec.UNSET else self.descriptors

    @property
    def reference_values(self) -> tuple[float | None, ...]:
        """Of the reference point, by objective; None where the search decides."""
        return (None,) * self.objectives if self.reference is msgspec.UNSET else self.reference

    @property
    def with_gradients(self) -> bool:
        """Whether evaluations come with their gradients."""
        return self.gradients is True

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
        method: of the solver, where it was settled: in a run, whose sessions all solve alike.
    """

    path: str
    text: str
    files: dict[str, str]
    symmetry: str | None = None
    method: str | None = None


class RunHeader(Record, frozen=True):
    """First message of every segment of a run's log.

    `budget` counts evaluations of the run, `hours` wall time of each session, and `stagnation_generations`
    generations in which the hypervolume may stand still. `constraints` is left out where there are none, as
    is `least_growth_percent`, the growth that a doubling of the evaluations must promise.
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
    constraints: tuple[Constraint, ...] | msgspec.UnsetType = msgspec.UNSET
    least_growth_percent: float | msgspec.UnsetType = msgspec.UNSET

    @property
    def least_growth(self) -> float | None:
        """Growth [%] that a doubling of the evaluations must promise; None for any."""
        return None if self.least_growth_percent is msgspec.UNSET else self.least_growth_percent

    @property
    def constrained(self) -> tuple[Constraint, ...]:
        """The problem's constraints, in the file's order."""
        return () if self.constraints is msgspec.UNSET else self.constraints

    @property
    def constrained_alone(self) -> tuple[Constraint, ...]:
        """The constraints of quantities that are no objectives."""
        names = {objective.name for objective in self.objectives}
        return tuple(constraint for constraint in self.constrained if constraint.name not in names)
