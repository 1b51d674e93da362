"""The problem file: its tables, keys, units and defaults, exactly as a user writes them.

Every key carries its unit. Decoding is strict: unknown keys, wrong types and values out of range are errors
that name file, key, what was wanted and what was found.

Beyond 300 lines: the file's tables, one after the other, with no function.
"""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated, TypeVar

import msgspec
from msgspec import Meta

from evodesign.body.placement import Matrix, Vector
from evodesign.hardware.catalogue import CatalogueRow
from evodesign.human.anthropometry_tables import Sex, ShoulderWidth
from evodesign.human.measured_posture import HumanPosture
from evodesign.human.population import PopulationSex
from evodesign.mechanics.disturbance import OverCases, PushedAt
from evodesign.mechanics.payload import Grasp, GraspDirection
from evodesign.nlp.method import MethodName
from evodesign.posture.postures import Symmetry
from evodesign.problem.baseline_table import BaselineTable
from evodesign.problem.design_table import DesignTable, DutyTable, HardwareTable, LoadCaseTable, MaterialTable
from evodesign.problem.table import Name, NotNegative, Point, Positive, Share, Table
from evodesign.tasks.lift import FEWEST_KNOTS, LoadProfile
from evodesign.tree.urdf_read import InertiaRule

T = TypeVar("T")

MOST_SAMPLES = 1000
"""People who are drawn from a distribution of measured ones."""


class HandsTable(Table, frozen=True):
    """Frames that meet the load: of both hands, or of the one that holds it."""

    left: Name | None = None
    right: Name | None = None


ICUB_HANDS = HandsTable(left="l_hand_frame", right="r_hand_frame")
"""Those of a robot that names none."""


class BaseTable(Table, frozen=True):
    """The frame on the ground of a robot on wheels, z up, and the rectangle about it on which it stands."""

    frame: Name
    size_m: tuple[Positive, Positive]


class SolesTable(Table, frozen=True):
    """Frames under the feet and the size of a sole (length, width)."""

    left: Name = "l_sole"
    right: Name = "r_sole"
    size_m: tuple[Positive, Positive] = (0.236, 0.100)


class FrameTable(Table, frozen=True):
    """A frame to add to a URDF that lacks it: a sole under a foot, a palm in a hand."""

    name: Name
    link: Name
    xyz_m: Point
    rpy_rad: Point = (0.0, 0.0, 0.0)


class Facing(StrEnum):
    """A direction in the axes of a root link, with x forward by REP 103."""

    FORWARD = "+x"
    LEFT = "+y"
    BACK = "-x"
    RIGHT = "-y"

    @property
    def ahead(self) -> Vector:
        """The direction as a unit vector."""
        sign = 1.0 if self.value[0] == "+" else -1.0
        return (sign, 0.0, 0.0) if self.value[1] == "x" else (0.0, sign, 0.0)

    @property
    def axes(self) -> Matrix:
        """The axes x ahead, y to the left, z up, as columns: a rotation into the root's axes."""
        x, y, _ = self.ahead
        return ((x, -y, 0.0), (y, x, 0.0), (0.0, 0.0, 1.0))


class Side(StrEnum):
    """The side of the load at which somebody stands and looks at it, in the world's axes."""

    BACK = "-x"
    RIGHT = "-y"
    FRONT = "+x"
    LEFT = "+y"

    @property
    def quarters(self) -> int:
        """Quarter turns about z that take the frame of who stands there to the world."""
        return [*Side].index(self)


class TorqueLimits(StrEnum):
    """Whether the limits of the robot's joint torques hold in every posture."""

    NONE = "none"
    HARD = "hard"


class RobotTable(Table, frozen=True):
    """`[robot]`: a URDF (or MJCF, which MuJoCo reads), and the parts of it that matter.

    `inertia` says where masses come from; see `InertiaRule`. `facing` is the direction in the root's axes in
    which the robot looks. `packages` are folders in which `package://` and `model://` are found, beside those
    of the environment; `meshes = false` leaves out what the URDF shows as meshes. `knee_flexion_deg` and
    `elbow_flexion_deg` are the least angles of knees and elbows in postures, zero for straight limbs; left
    out, joints take their whole ranges. One like it stands at each of `sides`. A robot on wheels has a `base`
    in place of `soles`.
    """

    urdf: Name
    sides: Annotated[tuple[Side, ...], Meta(min_length=1)] = (Side.BACK,)
    packages: tuple[Name, ...] = ()
    meshes: bool = True
    facing: Facing = Facing.FORWARD
    inertia: InertiaRule = InertiaRule.AUTO
    frames: tuple[FrameTable, ...] = ()
    hands: HandsTable = ICUB_HANDS
    soles: SolesTable | None = None
    base: BaseTable | None = None
    trunk: tuple[Name, ...] = ("root_link", "chest")
    joints: tuple[Name, ...] = ()
    torque_limits: TorqueLimits = TorqueLimits.NONE
    torque_limits_n_m: dict[str, Positive] = msgspec.field(default_factory=dict)
    knee_flexion_deg: NotNegative | None = None
    elbow_flexion_deg: NotNegative | None = None


class PopulationForm(Table, frozen=True):
    """People at percentiles of published distributions of stature and mass."""

    sex: PopulationSex
    percentiles: tuple[float, ...]


class JointRanges(StrEnum):
    """Whether each of a person's joints has all of its own range, they share ranges, or move together."""

    SEPARATE = "separate"
    COUPLED = "coupled"
    RHYTHM = "rhythm"


class HumanTable(Table, frozen=True):
    """`[human]` or `[[human]]`: a person by stature, mass and sex, or a URDF with the names of its parts.

    `population` stands for several people. `strengths_n_m` gives the largest torques of joints in their
    negative and positive direction, for a URDF or instead of published ones. `posture` says
    whether measured postures draw the person, `joint_ranges` whether the
    joints of the spine share ranges, or one flexion and one bending within them; `shoulder_width` how far a
    generated person's shoulder joints are apart. `gaze_cone_deg` is the largest angle of the load from where
    the head looks. Of a person with a measured posture, `spread` says beside how many people of the measured
    distribution a front is evaluated once its search has ended, `posture_sample` which of them this one is.
    People at different sides hold the load together; of those at one `side`, each in turn.
    """

    name: Name | None = None
    side: Side = Side.FRONT
    population: PopulationForm | None = None
    stature_m: Positive | None = None
    mass_kg: Positive | None = None
    sex: Sex | None = None
    urdf: Name | None = None
    frames: tuple[FrameTable, ...] = ()
    hands: HandsTable | None = None
    soles: SolesTable | None = None
    trunk: tuple[Name, ...] = ()
    joints: tuple[Name, ...] = ()
    strengths_n_m: dict[str, tuple[Positive, Positive]] = msgspec.field(default_factory=dict)
    posture: HumanPosture | None = None
    joint_ranges: JointRanges | None = None
    shoulder_width: ShoulderWidth | None = None
    gaze_cone_deg: Annotated[float, Meta(gt=0.0, lt=180.0)] | None = None
    spread: Annotated[int, Meta(ge=2, le=MOST_SAMPLES)] | None = None
    posture_sample: Annotated[int, Meta(ge=1, le=MOST_SAMPLES)] | None = None


class GraspsTable(Table, frozen=True):
    """Grasp points of an agent's hands, from the box's centre, in the world's axes."""

    left: Point
    right: Point


class PayloadTable(Table, frozen=True):
    """`[payload]` or `[[payload]]`: a box; size is depth (robot to person), width, height.

    `hand_moment_n_m` bounds each component of the moment that a rigid hand passes: left out, by what wrists
    bear; `inf` for no bound. `grasp_direction` says from where forearms may come to the load, within a cone
    of half angle `grasp_cone_deg`.
    """

    size_m: tuple[Positive, Positive, Positive]
    mass_kg: Positive
    name: Name | None = None
    center_of_mass_m: Point = (0.0, 0.0, 0.0)
    grasp: Grasp = Grasp.POINT
    hand_moment_n_m: NotNegative | None = None
    grasp_direction: GraspDirection = GraspDirection.FREE
    grasp_cone_deg: Annotated[float, Meta(gt=0.0, lt=180.0)] | None = None
    robot_grasps_m: GraspsTable | None = None
    human_grasps_m: GraspsTable | None = None


class WeightsTable(Table, frozen=True):
    """Weights of the squared torques in the posture problem."""

    robot: NotNegative = 1.0
    human: NotNegative = 1.0


class LiftTable(Table, frozen=True):
    """`[[task.lift]]`: the load goes straight up or down, from rest to rest; see `tasks.Lift`."""

    from_m: Positive
    to_m: Positive
    seconds: Positive = 1.5
    profile: LoadProfile = LoadProfile.MINIMUM_JERK
    knots: Annotated[int, Meta(ge=FEWEST_KNOTS)] = 12


class TaskTable(Table, frozen=True):
    """`[task]`: heights at which the load is held, lifts, and how robot and person divide the work.

    `robot_share` is the part of the load's weight that the robot carries; left out: the share of least cost.
    """

    heights_m: Annotated[tuple[Positive, ...], Meta(min_length=1)] | msgspec.UnsetType = msgspec.UNSET
    lift: tuple[LiftTable, ...] = ()
    effort_weights: WeightsTable | None = None
    robot_share: Share | None = None
    disturbed_effort: OverCases = OverCases.WORST


class DisturbanceTable(Table, frozen=True):
    """`[[disturbance]]`: a further load case of a posture, with wrenches and torques of its own.

    `load_mass_share` adds to the load's mass, `center_of_mass_m` to its centre of mass; `push_n` is a force
    in the world's axes (x from the robot to the person, z up) on the load's centre or on the last frame of
    an agent's trunk.
    """

    name: Name | None = None
    load_mass_share: Annotated[float, Meta(gt=-1.0)] = 0.0
    center_of_mass_m: Point = (0.0, 0.0, 0.0)
    push_n: Point = (0.0, 0.0, 0.0)
    at: Name = PushedAt.LOAD


class LimitsTable(Table, frozen=True):
    """`[limits]`: ground and stance; see `StanceLimits` and `Ground` for each.

    Left out, clearance of the trunk and distance of the feet follow from the size of a generated person.
    """

    friction: Positive = 0.5
    torsional_friction_m: NotNegative = 0.02
    least_foot_force_n: NotNegative = 0.0
    trunk_clearance_m: NotNegative | None = None
    feet_apart_m: tuple[NotNegative, Positive] | None = None
    feet_stagger_m: NotNegative = 0.30
    feet_gap_m: NotNegative | None = None
    foot_yaw_rad: NotNegative = 0.35
    base_tilt_rad: Positive = 0.60
    push_n: NotNegative = 5.0


class PushesTable(Table, frozen=True):
    """`[push]`: pushes on the robot's trunk that are simulated for quantities such as `push_margin`.

    `impulse_n_s` is that of the push after which the load is tracked; `frequency_rad_s` and `damping_ratio`
    set all gains of the controllers.
    """

    impulse_n_s: Positive = 10.0
    frequency_rad_s: Positive = 8.0
    damping_ratio: Positive = 1.0


class CollisionsTable(Table, frozen=True):
    """`[collisions]`: bodies keep clear of each other, of load, floor and partner by at least `margin_m`.

    `ignore` names pairs that may overlap, `part` pairs that have rows in programs beside those that are found
    to come near each other. Left out, bodies may pass through anything.
    """

    margin_m: NotNegative = 0.005
    ignore: tuple[tuple[Name, Name], ...] = ()
    part: tuple[tuple[Name, Name], ...] = ()


class ObjectivesTable(Table, frozen=True):
    """`[objectives]`: names from the registry of objectives."""

    minimise: tuple[Name, ...] = ()
    maximise: tuple[Name, ...] = ()


class BoundsTable(Table, frozen=True):
    """An entry of `[constraints]`: a lower bound, an upper one, or both, in the unit that its key carries."""

    lower: float | None = None
    upper: float | None = None


class DescriptorTable(Table, frozen=True):
    """`[[search.descriptor]]`: what tells kinds of designs apart, as in `records.Descriptor`."""

    name: Name
    lower: float | None = None
    upper: float | None = None
    cells: Annotated[int, Meta(ge=1, le=1000)] = 20


class SearchTable(Table, frozen=True):
    """`[search]`: how the design space is searched; `start` names a file of designs to begin with.

    `population` left out is what suits the algorithm: 8 for `surrogate`, which learns once a generation, 48
    for the others. `gradients` says whether every evaluation comes with its gradients; left out, as the
    algorithm wants it. `reference` names values of objectives beyond which a design counts for nothing to a
    search that measures hypervolumes against a point (`surrogate`). Descriptors tell kinds of designs apart
    for `map-elites`.
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
    """`[solver]`: how the inner problems are solved; limits of a solve and of a whole evaluation."""

    symmetry: Symmetry = Symmetry.AUTO
    start_portfolio: bool = True
    method: MethodName = MethodName.NATIVE
    compile: bool = True
    iterations: Annotated[int, Meta(ge=1)] = 300
    seconds: Positive = 20.0
    evaluation_seconds: Positive = 600.0
    evaluation_memory_gb: Annotated[float, Meta(ge=0.5)] = 8.0


class ProblemFile(Table, frozen=True):
    """A whole problem file; `description` says in a sentence what it is about.

    A design changes the first robot, wherever it stands; others stay as their files have them. Without
    `human` robots hold the load alone, without `robot` people do, and there is no `design`.
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
