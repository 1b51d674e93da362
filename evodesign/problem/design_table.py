"""`[design]` and `[[material]]`: what of the robot may change.

Beyond 300 lines: the file's tables, one after the other, with no function.
"""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated

import msgspec
from msgspec import Meta

from evodesign.hardware.mounting import Mount
from evodesign.problem.table import Name, Point, Positive, Share, Table


class LengthTable(Table, frozen=True):
    """`[[design.length]]`: a length multiplier that links share.

    Attributes:
        name: name of the parameter.
        links: links that get longer.
        lower: least multiplier.
        upper: largest multiplier.
        keep_mass: whether the links keep the masses of the file, so that densities fall as links get longer.
    """

    name: Name
    links: Annotated[tuple[Name, ...], Meta(min_length=1)]
    lower: Positive
    upper: Positive
    keep_mass: bool = False


class SectionTable(Table, frozen=True):
    """`[[design.section]]`: a multiplier of links' cross sections.

    Attributes:
        name: name of the parameter. Since 0.3.
        links: links that get thicker. Since 0.3.
        lower: least multiplier. Since 0.3.
        upper: largest multiplier. Since 0.3.
        across: the only axis along which boxes change, in each link's frame; without it, both. Since 0.3.
    """

    name: Name
    links: Annotated[tuple[Name, ...], Meta(min_length=1)]
    lower: Positive
    upper: Positive
    across: Point | None = None


class JointTable(Table, frozen=True):
    """`[[design.joint]]`: place, axis and limits of a joint, or of a mirrored pair.

    Attributes:
        name: name of the parameter. Since 0.3.
        joints: one joint, or two that are mirror images: the second changes as the first's image. Since
            0.3.
        offset_m: bounds of the origin's offset along `along`. Since 0.3.
        along: axis of the parent link. Since 0.3.
        tilt_deg: bounds of the angle by which the joint's axis turns about `about`. Since 0.3.
        about: axis of the joint's own frame. Since 0.3.
        lower_deg: bounds of the joint's lower limit. Since 0.3.
        upper_deg: bounds of the joint's upper limit. Since 0.3.
    """

    name: Name
    joints: Annotated[tuple[Name, ...], Meta(min_length=1, max_length=2)]
    offset_m: tuple[float, float] | None = None
    along: Point | None = None
    tilt_deg: tuple[float, float] | None = None
    about: Point | None = None
    lower_deg: tuple[float, float] | None = None
    upper_deg: tuple[float, float] | None = None


class DensityTable(Table, frozen=True):
    """`[[design.density]]`: a density that links share: within bounds, or of one of some materials.

    Docs: materials.md.

    Attributes:
        name: name of the parameter.
        links: links of that density.
        lower_kg_per_m3: least density.
        upper_kg_per_m3: largest density.
        materials: names of materials, in place of bounds.
    """

    name: Name
    links: Annotated[tuple[Name, ...], Meta(min_length=1)]
    lower_kg_per_m3: Positive | None = None
    upper_kg_per_m3: Positive | None = None
    materials: tuple[Name, ...] | None = None


class MaterialTable(Table, frozen=True):
    """`[[material]]`: a material besides those of the catalogue.

    Attributes:
        name: its name.
        density_kg_per_m3: density.
        source: where the density comes from.
    """

    name: Name
    density_kg_per_m3: Positive
    source: Name


class WallTable(Table, frozen=True):
    """`[[design.wall]]`: links that are hollow.

    Docs: hardware.md.

    Attributes:
        name: name of the parameter.
        links: hollow links.
        thickness_m: thickness of the wall, or bounds of it.
        material: what the wall is made of; without it, a `[[design.density]]` of the same links says.
    """

    name: Name
    links: Annotated[tuple[Name, ...], Meta(min_length=1)]
    thickness_m: (
        float | tuple[float, float]
    )  # bounds in such a union end msgspec 0.20 with a segmentation fault
    material: Name | None = None


class ActuatorTable(Table, frozen=True):
    """`[[design.actuator]]`: what drives a group of joints.

    One of `rated_torque_n_m`, `models` and `margin` is given.

    Docs: hardware.md.

    Attributes:
        name: name of the parameter.
        joints: joints that have this actuator.
        rated_torque_n_m: bounds of the rated torque.
        models: names of catalogue rows or `[[actuator]]` tables to choose from.
        margin: factor of at least 1 by which the actuator exceeds what postures and load cases ask of it, or
            bounds of it. A number since 0.3.
        mount: makes it a body: the housing's cylinder about each joint's axis, `inline` in the joint or
            `offset` to one side; without it, a ball of its mass. Since 0.3.
        gear: whose scaling law it follows: `planetary` or `strain_wave`; without it, `planetary`. Since
            0.3.
    """

    name: Name
    joints: Annotated[tuple[Name, ...], Meta(min_length=1)]
    rated_torque_n_m: tuple[Positive, Positive] | None = None
    models: tuple[Name, ...] | None = None
    margin: float | tuple[float, float] | None = None  # as of `WallTable.thickness_m`
    mount: Mount | None = None
    gear: Name | None = None


class Feet(StrEnum):
    """On which feet a robot stands."""

    BOTH = "both"
    LEFT = "left"
    RIGHT = "right"


class Hands(StrEnum):
    """Which hands hold something."""

    BOTH = "both"
    LEFT = "left"
    RIGHT = "right"


class Pushed(StrEnum):
    """Where a push meets the robot: hands alike, one hand, or its trunk."""

    HANDS = "hands"
    LEFT = "left"
    RIGHT = "right"
    TRUNK = "trunk"


class HoldTable(Table, frozen=True):
    """`hold` of a load case: a payload in the hands.

    Attributes:
        mass_kg: its mass.
        hand: which hands, each with the same part of its weight.
        height_m: height of the first hand above the soles; without it, as the posture has it.
        raised_by: joints that move by one offset until the hand is at `height_m`.
    """

    mass_kg: Positive
    hand: Hands = Hands.BOTH
    height_m: Positive | None = None
    raised_by: tuple[Name, ...] = ()


class PushTable(Table, frozen=True):
    """`push` of a load case: a level force on the robot.

    Attributes:
        force_n: the force.
        at: where it acts.
        direction_deg: 0 pushes ahead, 90 to the robot's left.
    """

    force_n: Positive
    at: Pushed = Pushed.HANDS
    direction_deg: float = 180.0


class LoadCaseTable(Table, frozen=True):
    """`[[load_case]]`: a posture in which the robot stands alone, for which actuators are sized.

    Docs: hardware.md.

    Attributes:
        name: name in results.
        balance: groups of joints that move by one offset each until the robot is balanced: one group on
            both feet, two on one.
        feet: feet on which it stands.
        joints_deg: angles of joints by name; others are at 0.
        factor: peak torque of the actuators over the torques of the case.
        hold: a payload in its hands.
        push: a force on it.
        dropped_from_m: height from which the payload of `hold` falls into the hands, or without one the robot
            onto its feet; links must withstand it. Since 0.3.
    """

    name: Name
    balance: Annotated[tuple[tuple[Name, ...], ...], Meta(min_length=1)]
    feet: Feet = Feet.BOTH
    joints_deg: dict[str, float] = msgspec.field(default_factory=dict)
    factor: Positive = 2.0
    hold: HoldTable | None = None
    push: PushTable | None = None
    dropped_from_m: Positive | None = None


class HardwareTable(Table, frozen=True):
    """`[hardware]`: what hollow links keep, and what gears do.

    Attributes:
        non_structural_share: share of a hollow link's mass in the file that stays besides its wall.
        least_wall_m: least wall that can be made; without it, that of the material. Since 0.3.
        gear_friction: whether friction in the gears of `[[design.actuator]]` counts: it helps motors to hold,
            and they work against it in a lift. Since 0.3.
    """

    non_structural_share: Share = 0.3
    least_wall_m: Positive | None = None
    gear_friction: bool = False


class DutyTable(Table, frozen=True):
    """`[duty]`: how often and how long the robot holds the load, and what its windings bear.

    Docs: hardware.md.

    Attributes:
        lifts_per_hour: lifts in an hour. Since 0.3.
        hold_s: duration of a hold. Since 0.3.
        shift_h: duration of a shift. Since 0.3.
        winding_limit_c: winding temperature that the rated torque leads to, in air of 25 degrees. Since
            0.3.
        thermal_time_constant_s: thermal time constant of the winding. Since 0.3.
        air_c: temperature of the air. Since 0.3.
        life_shifts: shifts in the robot's life, for `fatigue_safety_factor`. Since 0.3.
    """

    lifts_per_hour: Positive
    hold_s: Positive
    shift_h: Positive
    winding_limit_c: Annotated[float, Meta(gt=60.0, le=250.0)]
    thermal_time_constant_s: Positive
    air_c: Annotated[float, Meta(ge=-40.0, le=55.0)] = 25.0
    life_shifts: Positive | None = None


class AllocationTable(Table, frozen=True):
    """`[[design.allocation]]`: how a design shares the load; needs rigid grasps.

    Docs: sharing.md.

    Attributes:
        name: `effort_ratio`: log10 of the robot's effort weight over the person's; or `robot_share`: the
            robot's share of the load's weight.
        lower: lower bound.
        upper: upper bound.
    """

    name: Name
    lower: float
    upper: float


class DesignTable(Table, frozen=True):
    """`[design]`: what may change of the robot; each table is one design parameter or a group of them.

    Attributes:
        length: lengths.
        section: cross sections. Since 0.3.
        joint: joints. Since 0.3.
        density: densities.
        wall: walls of hollow links.
        actuator: actuators.
        allocation: sharing of the load.
    """

    length: tuple[LengthTable, ...] = ()
    section: tuple[SectionTable, ...] = ()
    joint: tuple[JointTable, ...] = ()
    density: tuple[DensityTable, ...] = ()
    wall: tuple[WallTable, ...] = ()
    actuator: tuple[ActuatorTable, ...] = ()
    allocation: tuple[AllocationTable, ...] = ()
