"""What came of designs, one by one, generation by generation, on the front, and beside people by chance."""

from __future__ import annotations

import msgspec

from evodesign.records.cases import Case, Status
from evodesign.records.parameters import Genome
from evodesign.records.postures import CaseDetail
from evodesign.tasks import Record


class ReachOutcome(Record, frozen=True, omit_defaults=True):
    """Interval of load heights [m] that the robot can hold; bounds are None when not solved.

    `or_lower` says that loads below the lowest may be held, too: it is the lowest that is asked for.

    Example:
        >>> design.reach.highest_m, design.reach.reason
        (1.343..., 'holds loads from 0.193 to 1.343 m')
    """

    lowest_m: float | None
    highest_m: float | None
    status: Status
    reason: str
    or_lower: bool = False


class CaseOutcome(Record, frozen=True, omit_defaults=True):
    """One undisturbed case of one design, in short.

    `disturbed` holds torque norms [N m] by disturbance and agent, where the problem has disturbances.
    `fallbacks` counts solves by IPOPT because the native method had found no posture.

    Example:
        >>> design.cases[0]
        <short, 0.8 m: solved, robot 0.1603 N m, human 0.08849 N m>
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

    def __repr__(self) -> str:
        norms = {"robot": self.robot_torque_norm, "human": self.human_torque_norm}
        known = [f"{name} {norm:.4g} N m" for name, norm in norms.items() if norm is not None]
        return f"<{', '.join([f'{self.case.name}: {self.status}', *known])}>"


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


class WeakestPush(Record, frozen=True):
    """Where a push margin is least.

    Attributes:
        moment: of the plan, such as `short, 0.8 m`.
        direction_deg: to which the push goes, from forwards to the robot's left.
        reason: what a larger one does; empty where none was tried.
    """

    moment: str
    direction_deg: float
    reason: str


class Assessment(Record, frozen=True):
    """The results of a design: a property of problem and genome alone.

    `objectives` holds natural values (a maximised one is not negated) and lacks those that do not exist, as
    does `constraints`, which is left out where there are none. `violation` is zero for a feasible design,
    None when a failure left it unknown, and otherwise what designs are ranked by: the metres by which
    required heights are missed, plus for each constraint its excess relative to its bound
    (`evodesign.violations`). `judged` holds the objectives of a design that IPOPT solved, too, to judge the
    native method (`evodesign.evaluation.judge`). `gradients` is there where the search asked for them.
    `rated` holds the rated torques [N m] of sized actuators, by the parameter that is their margin.
    `weakest` says of each push margin where it is least.
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
    weakest: dict[str, WeakestPush] | msgspec.UnsetType = msgspec.UNSET

    def __repr__(self) -> str:
        return f"<assessment: {self.summary}>"

    @property
    def summary(self) -> str:
        """Three of its objectives at most, in their own units, or why they do not count."""
        if self.violation is None:
            return str(self.status)
        if self.violation > 0.0:
            return f"not feasible, violation {self.violation:.4g}"
        told = [f"{name} {value:.4g}" for name, value in self.objectives.items()]
        return ", ".join(told if len(told) <= 3 else [*told[:3], ".."])

    @property
    def rated_torques(self) -> dict[str, float]:
        """Those of sized actuators [N m], by the parameter that is their margin, if there are any."""
        return {} if self.rated is msgspec.UNSET else self.rated

    @property
    def weakest_pushes(self) -> dict[str, WeakestPush]:
        """Where each push margin is least, by its name, if there are any."""
        return {} if self.weakest is msgspec.UNSET else self.weakest

    @property
    def constrained(self) -> dict[str, float]:
        """Values of constrained quantities by name, without those that do not exist."""
        return {} if self.constraints is msgspec.UNSET else self.constraints


class Assessed(Record, frozen=True):
    """What a worker gives back: the results of a genome, and its postures in the cases that were solved.

    `gradient_seconds` is what the gradients took of the evaluation's time [s].
    """

    assessment: Assessment
    cases: tuple[CaseDetail, ...] = ()
    gradient_seconds: float = NO_SECONDS

    def __repr__(self) -> str:
        return f"<assessed: {self.assessment.summary}>"


class Detail(Record, frozen=True):
    """The postures of an evaluation that no earlier one dominates: every design of a front has one."""

    evaluation: int
    cases: tuple[CaseDetail, ...]

    def __repr__(self) -> str:
        return f"<postures of evaluation {self.evaluation} in {len(self.cases)} cases>"


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

    def __repr__(self) -> str:
        return f"<evaluation {self.number}: {self.assessment.summary}>"

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

    def __repr__(self) -> str:
        share = f"{self.evaluations} evaluations, {self.feasible_share:.1%} feasible"
        volume = "" if self.hypervolume is None else f", hypervolume {self.hypervolume:.4g}"
        return f"<generation {self.number}: {share}{volume}>"


class Front(Record, frozen=True):
    """Numbers of the non-dominated feasible evaluations after a generation."""

    generation: int
    evaluations: tuple[int, ...]


class SampledDesign(Record, frozen=True):
    """A design beside the people of one sample.

    Attributes:
        sample: its number, from 1; it is the problem's `posture_sample`.
        design: number of the evaluation that the design is in the run.
        assessment: as of any evaluation.
        seconds: that it took.
    """

    sample: int
    design: int
    assessment: Assessment
    seconds: float


class SampledPeople(Record, frozen=True):
    """What is kept of all samples of a run.

    Attributes:
        problem: digest of the run's problem.
        versions: of the packages by which it was evaluated.
        samples: how many were asked for.
        reference: number of the design that others are compared with; None for none.
        designs: in the order in which they were evaluated.
    """

    problem: str
    versions: dict[str, str]
    samples: int
    reference: int | None
    designs: tuple[SampledDesign, ...]

    def __repr__(self) -> str:
        return f"<{len(self.designs)} evaluations beside {self.samples} samples of people>"
