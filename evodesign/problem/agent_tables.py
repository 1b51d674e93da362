"""`[robot]` and `[human]` of a problem file: who holds the load."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated

import msgspec
from msgspec import Meta

from evodesign.body.placement import Matrix, Vector
from evodesign.human.anthropometry_tables import Sex, ShoulderWidth
from evodesign.human.measured_posture import HumanPosture
from evodesign.human.population import PopulationSex
from evodesign.problem.table import Name, NotNegative, Point, Positive, Table
from evodesign.tree.urdf_read import InertiaRule

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
