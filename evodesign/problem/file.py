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
    """`hands`: the frames that meet the load, of both hands or of the one that holds it.

    Attributes:
        left: frame of the left hand.
        right: frame of the right hand.
    """

    left: Name | None = None
    right: Name | None = None


ICUB_HANDS = HandsTable(left="l_hand_frame", right="r_hand_frame")
"""Those of a robot that names none."""


class BaseTable(Table, frozen=True):
    """`[robot.base]`: the ground contact of a robot on wheels, in place of `soles`.

    Attributes:
        frame: frame on the ground, z up. Since 0.3.
        size_m: length and width of the rectangle about the frame on which the robot stands. Since 0.3.
    """

    frame: Name
    size_m: tuple[Positive, Positive]


class SolesTable(Table, frozen=True):
    """`soles`: frames under the feet, x ahead and z up, and the size of a sole.

    Attributes:
        left: frame under the left foot.
        right: frame under the right foot.
        size_m: length and width of a sole.
    """

    left: Name = "l_sole"
    right: Name = "r_sole"
    size_m: tuple[Positive, Positive] = (0.236, 0.100)


class FrameTable(Table, frozen=True):
    """`[[robot.frames]]`, `[[human.frames]]`: a frame that the URDF lacks, such as a palm or a sole.

    Attributes:
        name: name of the new frame.
        link: link that carries it.
        xyz_m: origin in the link's frame.
        rpy_rad: roll, pitch and yaw of its axes in the link's frame.
    """

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
    """`[robot]` or `[[robot]]`: a robot's model file, and the parts of it that matter.

    The design changes the first robot, at each of its `sides`; other robots stay as their files have them.

    Attributes:
        urdf: its file, URDF or MJCF (MJCF needs the extra `mjcf`), from the problem's folder.
        sides: sides of the load at which a copy of the robot stands and looks at the load, in the world's
            axes. Since 0.3.
        packages: folders in which `package://` and `model://` are found, besides `ROS_PACKAGE_PATH` and
            the URDF's own folders.
        meshes: false leaves out the visual meshes; their links then have no shape.
        facing: direction in the root link's axes in which the robot looks.
        inertia: source of masses and inertias: `shapes` computes them from primitive shapes of one
            density per link, `file` takes the file's, `auto` takes the file's for links with meshes and
            shapes for the others.
        frames: frames that the file lacks.
        hands: frames that meet the load.
        soles: frames under the feet; without it and without `base`, the iCub's `l_sole` and `r_sole`.
        base: for a robot on wheels, in place of `soles`. Since 0.3.
        trunk: frames that keep the distance `limits.trunk_clearance_m` from the load.
        joints: joints that move; empty: all.
        torque_limits: `hard` keeps every joint torque of every posture within the limits of the file and
            of `torque_limits_n_m`.
        torque_limits_n_m: limits of joints by name, in place of the file's.
        knee_flexion_deg: least knee flexion in postures, 0 is straight; without it, the joint's whole
            range. Since 0.3.
        elbow_flexion_deg: least elbow flexion in postures, 0 is straight; without it, the joint's whole
            range. Since 0.3.
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
    """`population` of a person: one person for each percentile of stature and mass.

    Attributes:
        sex: whose percentiles.
        percentiles: from 5 to 95, each once.
    """

    sex: PopulationSex
    percentiles: tuple[float, ...]


class JointRanges(StrEnum):
    """Whether each of a person's joints has all of its own range, they share ranges, or move together."""

    SEPARATE = "separate"
    COUPLED = "coupled"
    RHYTHM = "rhythm"


class HumanTable(Table, frozen=True):
    """`[human]` or `[[human]]`: a person of given stature, mass and sex, a population, or a URDF.

    People at different sides of the load hold it together; people at the same side hold it in turn.

    Docs: people.md, person.md.

    Attributes:
        name: name in results; each of several people has one, a population names its own.
        side: side of the load at which the person stands and looks at it, in the world's axes. Since 0.3.
        population: several people in place of one: `{ sex = "both", percentiles = [5, 50, 95] }`.
        stature_m: body height, from 1.45 to 2.05.
        mass_kg: body mass, from 40 to 140.
        sex: whose proportions and strengths.
        urdf: model file of a person, in place of stature, mass and sex.
        frames: frames that the URDF lacks.
        hands: as of a robot; only with `urdf`.
        soles: as of a robot; only with `urdf`.
        trunk: as of a robot; only with `urdf`.
        joints: as of a robot; only with `urdf`.
        strengths_n_m: largest torques of joints by name, in negative and positive direction, in place of
            published strengths.
        posture: `measured` draws the posture to those of measured people, `least_torque` minimises torque
            alone; without it, `measured` for a generated person and `least_torque` for a URDF. Since 0.3.
        joint_ranges: `separate` gives each joint its own range, `coupled` adds published ranges that
            joints of the spine share, `rhythm` makes the spine one flexion and one bending; without it,
            `rhythm` with a measured posture, otherwise `separate`. `rhythm` since 0.3.
        shoulder_width: distance of the shoulder joints: the outer shoulder width of Drillis and Contini,
            or that of the joint centres; without it, `drillis_contini`.
        gaze_cone_deg: largest angle of the load from the direction of the head; without it, no limit.
        spread: after a search, evaluate its front beside so many people drawn from the measured
            distribution. Since 0.3.
        posture_sample: take this one of the `spread` people in place of the mean. Since 0.3.
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
    """`robot_grasps_m`, `human_grasps_m`: grasp points from the box's centre, in the world's axes.

    Attributes:
        left: grasp point of the left hand, in m; left out where there is none.
        right: grasp point of the right hand, in m; likewise.
    """

    left: Point | None = None
    right: Point | None = None


class PayloadTable(Table, frozen=True):
    """`[payload]` or `[[payload]]`: a box; of several loads, each person holds each at each height.

    Attributes:
        size_m: depth (from robot to person), width and height.
        mass_kg: mass.
        name: name in results; without it, the mass.
        center_of_mass_m: centre of mass from the box's centre, inside the box.
        grasp: what a hand transmits: `point` a force, `rigid` a force and a moment.
        hand_moment_n_m: largest moment of a rigid hand about each axis; `inf` for no bound; without it,
            7.0, what wrists bear (Delp, Grierson and Buchanan 1996).
        grasp_direction: where forearms come from: `side` from outside and behind, `under` from below and
            behind.
        grasp_cone_deg: largest angle of a forearm from `grasp_direction`; without it, 60.
        robot_grasps_m: grasp points of the robot; without it, at 0.4 of the edge from its middle, 0.25
            beside a neighbour, in the middle for one hand.
        human_grasps_m: the same of the person.
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
    """`effort_weights`: weights of the squared joint torques in the posture problem.

    Attributes:
        robot: weight of the robot's torques.
        human: weight of the person's torques.
    """

    robot: NotNegative = 1.0
    human: NotNegative = 1.0


class LiftTable(Table, frozen=True):
    """`[[task.lift]]`: the load moves straight up or down, from rest to rest.

    Docs: motion.md.

    Attributes:
        from_m: height of the load's centre at the start. Since 0.3.
        to_m: height at the end. Since 0.3.
        seconds: duration. Since 0.3.
        profile: height over time: `minimum_jerk`, or `free` for the optimiser's choice. Since 0.3.
        knots: knots of the splines. Since 0.3.
    """

    from_m: Positive
    to_m: Positive
    seconds: Positive = 1.5
    profile: LoadProfile = LoadProfile.MINIMUM_JERK
    knots: Annotated[int, Meta(ge=FEWEST_KNOTS)] = 12


class TaskTable(Table, frozen=True):
    """`[task]`: heights at which the load is held, lifts, and how robot and person share the effort.

    Attributes:
        heights_m: heights of the load's centre; a design that misses one is infeasible by the missing
            distance.
        lift: lifts, besides or in place of `heights_m`. Since 0.3.
        effort_weights: weights of squared torques in the posture problem; without it, 1 and 1.
        robot_share: share of the load's weight that the robot carries, with rigid grasps; without it, the
            posture problem decides.
        disturbed_effort: effort over the undisturbed and all disturbed load cases: their `mean` or the
            `worst`.
    """

    heights_m: Annotated[tuple[Positive, ...], Meta(min_length=1)] | msgspec.UnsetType = msgspec.UNSET
    lift: tuple[LiftTable, ...] = ()
    effort_weights: WeightsTable | None = None
    robot_share: Share | None = None
    disturbed_effort: OverCases = OverCases.WORST


class DisturbanceTable(Table, frozen=True):
    """`[[disturbance]]`: a further load case of each posture, with its own torques and wrenches.

    Docs: disturbances.md.

    Attributes:
        name: name in results; without it, numbered.
        load_mass_share: added mass, as a share of the load's.
        center_of_mass_m: shift of the load's centre of mass.
        push_n: force in the world's axes: x from the robot to the person, z up.
        at: where it acts: `load`, or the last frame of an agent's trunk: `robot`, `human`, `robot_2`.
    """

    name: Name | None = None
    load_mass_share: Annotated[float, Meta(gt=-1.0)] = 0.0
    center_of_mass_m: Point = (0.0, 0.0, 0.0)
    push_n: Point = (0.0, 0.0, 0.0)
    at: Name = PushedAt.LOAD


class LimitsTable(Table, frozen=True):
    """`[limits]`: limits of ground contact and stance, for robots and people.

    Attributes:
        friction: Coulomb coefficient of soles on the ground; our choice.
        torsional_friction_m: largest moment about a foot's normal, over its normal force; our choice.
        least_foot_force_n: least normal force of a foot: contact is unilateral.
        trunk_clearance_m: least distance along x of the trunk's frames from the load's near edge; without
            it, 0.15 for a robot, half the trunk's depth and 2 cm for a person.
        feet_apart_m: least and largest sideways distance of the soles' origins; without it, [0.12, 0.50]
            for a robot; for a person from soles that touch to legs 20 degrees outwards.
        feet_stagger_m: largest difference of the soles' origins along x; our choice.
        feet_gap_m: least sideways distance of the soles' edges; without it, none; our choice.
        foot_yaw_rad: largest yaw of a foot; our choice.
        base_tilt_rad: largest roll, pitch and yaw of the root link; our choice.
        push_n: largest internal force between the agents; our choice.
    """

    friction: Positive = 0.5
    torsional_friction_m: NotNegative = 0.02
    least_foot_force_n: NotNegative = 0.0
    trunk_clearance_m: NotNegative | None = None
    feet_apart_m: tuple[NotNegative, NotNegative] | None = None
    feet_stagger_m: NotNegative = 0.30
    feet_gap_m: NotNegative | None = None
    foot_yaw_rad: NotNegative = 0.35
    base_tilt_rad: Positive = 0.60
    push_n: NotNegative = 5.0


class PushesTable(Table, frozen=True):
    """`[push]`: pushes on the robot's trunk that are simulated for quantities such as `push_margin`.

    Docs: control.md.

    Attributes:
        impulse_n_s: impulse of the push after which the load is tracked. Since 0.3.
        frequency_rad_s: bandwidth of all controllers. Since 0.3.
        damping_ratio: damping of all controllers. Since 0.3.
    """

    impulse_n_s: Positive = 10.0
    frequency_rad_s: Positive = 8.0
    damping_ratio: Positive = 1.0


class CollisionsTable(Table, frozen=True):
    """`[collisions]`: bodies do not overlap each other, load, floor or partner.

    Without the table they may overlap.

    Attributes:
        margin_m: least distance of bodies.
        ignore: pairs of links (or of a link and `load`, `floor`, `partner`) that may overlap, besides
            those that overlap as built; `evodesign check` lists these.
        part: pairs that every program separates, besides those that are found to come close.
    """

    margin_m: NotNegative = 0.005
    ignore: tuple[tuple[Name, Name], ...] = ()
    part: tuple[tuple[Name, Name], ...] = ()


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
