"""What a run is of: its problem, its search, its budget."""

from __future__ import annotations

from typing import Annotated

import msgspec
from msgspec import Meta

from evodesign.records.parameters import Constraint, Genome, Objective, Parameter
from evodesign.tasks import Record

FORMAT_VERSION = 3
"""Version of the records; a reader refuses a log of a later one, and upgrades an earlier one."""


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

    def __repr__(self) -> str:
        return f"<search {self.algorithm}: population {self.population}, seed {self.seed}>"

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

    def __repr__(self) -> str:
        return f"<problem file {self.path} with {len(self.files)} more>"


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

    def __repr__(self) -> str:
        return f"<header of {self.problem_name}: {self.search.algorithm}, budget {self.budget}>"

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
