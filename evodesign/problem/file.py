"""The problem file: its tables, keys, units and defaults, exactly as a user writes them.

Every key carries its unit. Decoding is strict: unknown keys, wrong types and values out of range are errors
that name file, key, what was wanted and what was found.
"""

from __future__ import annotations

from typing import Annotated, TypeVar

import msgspec
from msgspec import Meta

from evodesign.hardware.catalogue import CatalogueRow
from evodesign.nlp.method import MethodName
from evodesign.posture.postures import Symmetry
from evodesign.problem.agent_tables import HumanTable, RobotTable
from evodesign.problem.design_table import DesignTable, DutyTable, HardwareTable, LoadCaseTable, MaterialTable
from evodesign.problem.table import Name, NotNegative, Positive, Table
from evodesign.problem.task_tables import (
    CollisionsTable,
    DisturbanceTable,
    LimitsTable,
    PayloadTable,
    PushesTable,
    TaskTable,
)

T = TypeVar("T")


class ObjectivesTable(Table, frozen=True):
    """`[objectives]`: quantities to optimise, by [name](#quantities).

    Attributes:
        minimise: those to minimise.
        maximise: those to maximise.
    """

    minimise: tuple[Name, ...] = ()
    maximise: tuple[Name, ...] = ()


class BoundsTable(Table, frozen=True):
    """An entry of `[constraints]`: bounds of a [quantity](#quantities), in the unit that the key carries.

    Attributes:
        lower: lower bound.
        upper: upper bound.
    """

    lower: float | None = None
    upper: float | None = None


class DescriptorTable(Table, frozen=True):
    """`[[search.descriptor]]`: an axis that tells kinds of designs apart, for `map-elites`.

    Attributes:
        name: a parameter, quantity or torque at a height, or a sum such as `length.upper_arm +
            length.forearm`.
        lower: lower end; without it, that of the parameters.
        upper: upper end; without it, that of the parameters.
        cells: cells between the ends.
    """

    name: Name
    lower: float | None = None
    upper: float | None = None
    cells: Annotated[int, Meta(ge=1, le=1000)] = 20


class SearchTable(Table, frozen=True):
    """`[search]`: how the design space is searched.

    Attributes:
        algorithm: `surrogate`, `nsga2`, `cma-es`, `map-elites`, `random`, or `MODULE:CLASS`.
        population: evaluations of a generation; without it, 8 for `surrogate`, 48 for the others.
        evaluations: evaluations of the whole run.
        seed: seed of all random numbers.
        hours: wall time of a session; without it, no limit.
        stagnation_generations: stop when the hypervolume has not grown for so many generations.
        least_growth_percent: stop when doubling the budget is unlikely to add this much hypervolume.
        start: file of named designs that are evaluated first.
        asynchronous: true works without generations, so that no worker waits for others.
        gradients: whether evaluations come with gradients; without it, as the algorithm uses them.
        reference: values of objectives beyond which a design does not count for the surrogate's
            hypervolume.
        descriptor: axes of `map-elites`.
    """

    algorithm: Name = "surrogate"
    population: Annotated[int, Meta(ge=2, le=100_000)] | None = None
    evaluations: Annotated[int, Meta(ge=1)] = 1920
    seed: Annotated[int, Meta(ge=0)] = 1
    hours: Positive | None = None
    stagnation_generations: Annotated[int, Meta(ge=0)] | None = None
    least_growth_percent: Positive | None = None
    start: Name | None = None
    asynchronous: bool = False
    gradients: bool | None = None
    reference: dict[str, float] = msgspec.field(default_factory=dict)
    descriptor: Annotated[tuple[DescriptorTable, ...], Meta(max_length=4)] = ()


class SolverTable(Table, frozen=True):
    """`[solver]`: how the inner problems are solved, and limits of an evaluation.

    Attributes:
        symmetry: `auto` solves symmetric problems symmetrically, averaging what nearly is; `on` refuses
            others, `off` solves the whole, `polish` solves symmetrically, then whole.
        start_portfolio: false starts each solve from two fixed starts only.
        method: `native` is our interior-point method in C, with IPOPT where it fails; `ipopt` is IPOPT
            alone.
        compile: compile the inner problems: with TinyCC at once, with gcc or clang in the background.
        iterations: most iterations of a solve.
        seconds: longest time of a solve.
        evaluation_seconds: an evaluation that takes longer is ended.
        evaluation_memory_gb: an evaluation that takes more memory is ended.
    """

    symmetry: Symmetry = Symmetry.AUTO
    start_portfolio: bool = True
    method: MethodName = MethodName.NATIVE
    compile: bool = True
    iterations: Annotated[int, Meta(ge=1)] = 300
    seconds: Positive = 20.0
    evaluation_seconds: Positive = 600.0
    evaluation_memory_gb: Annotated[float, Meta(ge=0.5)] = 8.0


class TaskWeightsTable(Table, frozen=True):
    """`[baseline.weights]`: W1 to W4 of the paper's tasks.

    Attributes:
        torque: weight of the squared norm of torques in (10 N m)^2.
        density: weight of the product of distances to the preferred densities in 1000 kg/m^3.
        center_of_pressure: weight of squared distances from the sole's middle in m^2.
        mass_height: weight of 1 / z^2 of the standing robot's centre of mass in 1/m^2.
    """

    torque: Positive = 1.0
    density: NotNegative = 0.0
    center_of_pressure: NotNegative = 0.0
    mass_height: NotNegative = 0.0


class BaselineTable(Table, frozen=True):
    """`[baseline]`: the paper's joint problem, postures of all heights and the design in one program.

    Attributes:
        start: designs of the file `search.start` to start from; without it, all.
        weights: weights of the paper's tasks.
        preferred_densities_kg_per_m3: densities that the task of densities prefers.
        joint_limits: false drops the limits of joints.
        contact_limits: false drops the limits of contacts.
        stance_limits: false drops the limits of stance.
        length_bounds: false drops the bounds of lengths.
        compile: compile the program; takes longer than it saves below hundreds of starts.
        iterations: most iterations of a solve.
        seconds: longest time of a solve.
    """

    start: tuple[Name, ...] | None = None
    weights: TaskWeightsTable = TaskWeightsTable()
    preferred_densities_kg_per_m3: tuple[Positive, ...] = ()
    joint_limits: bool = True
    contact_limits: bool = True
    stance_limits: bool = True
    length_bounds: bool = True
    compile: bool = False
    iterations: Annotated[int, Meta(ge=1)] = 1000
    seconds: Positive = 60.0


class ProblemFile(Table, frozen=True):
    """A whole problem file.

    Without `human` robots hold the load alone; without `robot` people do, and there is no `design`.

    Attributes:
        name: name of the problem.
        payload: the load.
        task: what is done with it.
        objectives: what is optimised.
        robot: the robot.
        design: what may change of the robot.
        human: the person.
        constraints: bounds of quantities.
        material: materials besides the catalogue's.
        actuator: actuators besides the catalogue's.
        hardware: settings of hollow links.
        duty: how the robot is used, for winding temperatures. Since 0.3.
        load_case: what else actuators are sized for.
        limits: limits of ground contact and stance.
        search: how to search.
        solver: how to solve.
        baseline: the paper's joint problem.
        disturbance: further load cases of postures.
        collisions: whether bodies may overlap.
        push: pushes that are simulated, for quantities such as `push_margin`. Since 0.3.
        description: one sentence on the problem.
    """

    name: Name
    payload: PayloadTable | Annotated[tuple[PayloadTable, ...], Meta(min_length=1)]
    task: TaskTable
    objectives: ObjectivesTable
    robot: RobotTable | Annotated[tuple[RobotTable, ...], Meta(min_length=1)] | None = None
    design: DesignTable = DesignTable()
    human: HumanTable | Annotated[tuple[HumanTable, ...], Meta(min_length=1)] | None = None
    constraints: dict[str, BoundsTable] = msgspec.field(default_factory=dict)
    material: tuple[MaterialTable, ...] = ()
    actuator: tuple[CatalogueRow, ...] = ()
    hardware: HardwareTable = HardwareTable()
    duty: DutyTable | None = None
    load_case: tuple[LoadCaseTable, ...] = ()
    limits: LimitsTable = LimitsTable()
    search: SearchTable = SearchTable()
    solver: SolverTable = SolverTable()
    baseline: BaselineTable = BaselineTable()
    disturbance: tuple[DisturbanceTable, ...] = ()
    collisions: CollisionsTable | None = None
    push: PushesTable | None = None
    description: str = ""

    @property
    def robots(self) -> dict[str, RobotTable]:
        """The tables of robots by their keys, for messages; none where people hold the load without them."""
        return {} if self.robot is None else _listed("robot", self.robot)

    @property
    def designed(self) -> RobotTable | None:
        """The table of the robot that a design changes."""
        return next(iter(self.robots.values()), None)

    @property
    def people(self) -> dict[str, HumanTable]:
        """The tables of people by their keys, for messages; none where the robot holds the load alone."""
        return {} if self.human is None else _listed("human", self.human)

    @property
    def loads(self) -> dict[str, PayloadTable]:
        """The tables of loads by their keys, for messages."""
        return _listed("payload", self.payload)


def _listed(key: str, tables: T | tuple[T, ...]) -> dict[str, T]:
    """One table or a list of tables, each with its key."""
    if isinstance(tables, tuple):
        return {f"{key}[{position}]": table for position, table in enumerate(tables)}
    return {key: tables}
