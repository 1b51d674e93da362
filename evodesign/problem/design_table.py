"""`[design]` and `[[material]]`: what of the robot may change."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated

import msgspec
from msgspec import Meta

from evodesign.hardware.mounting import Mount
from evodesign.problem.table import Name, Point, Positive, Share, Table

Margin = Annotated[float, Meta(ge=1.0)]


class LengthTable(Table, frozen=True):
    """`[[design.length]]`: a length multiplier shared by links.

    With `keep_mass` their masses stay those of the file, so that densities fall as links get longer.
    """

    name: Name
    links: Annotated[tuple[Name, ...], Meta(min_length=1)]
    lower: Positive
    upper: Positive
    keep_mass: bool = False


class SectionTable(Table, frozen=True):
    """`[[design.section]]`: a multiplier of links' sections, across the axis along which they get longer.

    `across` names the only axis, in each link's frame, along which they change.
    """

    name: Name
    links: Annotated[tuple[Name, ...], Meta(min_length=1)]
    lower: Positive
    upper: Positive
    across: Point | None = None


class JointTable(Table, frozen=True):
    """`[[design.joint]]`: a joint, or two that are mirror images; bounds of what changes of them.

    `offset_m` moves the first joint's origin along `along`, an axis of its parent link; `tilt_deg` turns its
    axis about `about`, an axis of its own frame; `lower_deg` and `upper_deg` are its limits. The other joint
    of a pair changes as the mirror image.
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
    """`[[design.density]]`: a density shared by links: within bounds, or that of one of some materials."""

    name: Name
    links: Annotated[tuple[Name, ...], Meta(min_length=1)]
    lower_kg_per_m3: Positive | None = None
    upper_kg_per_m3: Positive | None = None
    materials: tuple[Name, ...] | None = None


class MaterialTable(Table, frozen=True):
    """`[[material]]`: a material beside those of the catalogue, and where its density comes from."""

    name: Name
    density_kg_per_m3: Positive
    source: Name


class WallTable(Table, frozen=True):
    """`[[design.wall]]`: links that are hollow: a fixed thickness or bounds of it, and what they are made of.

    Without `material`, a `[[design.density]]` of the same links chooses it.
    """

    name: Name
    links: Annotated[tuple[Name, ...], Meta(min_length=1)]
    thickness_m: (
        float | tuple[float, float]
    )  # bounds in such a union end msgspec 0.20 with a segmentation fault
    material: Name | None = None


class ActuatorTable(Table, frozen=True):
    """`[[design.actuator]]`: what drives a group of joints.

    Any rated torque within bounds, a model, or as many times what is asked of it as `margin` bounds. One that
    is no model follows the law of its `gear`. With `mount` it is a body, the cylinder of its housing about
    each joint's axis; left out, a ball of its mass.
    """

    name: Name
    joints: Annotated[tuple[Name, ...], Meta(min_length=1)]
    rated_torque_n_m: tuple[Positive, Positive] | None = None
    models: tuple[Name, ...] | None = None
    margin: tuple[Margin, Margin] | None = None
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
    """`hold` of a load case: a payload in hands, each with the same part of its weight.

    With `height_m` the joints `raised_by` move by one offset until the first of the hands is there, above the
    soles.
    """

    mass_kg: Positive
    hand: Hands = Hands.BOTH
    height_m: Positive | None = None
    raised_by: tuple[Name, ...] = ()


class PushTable(Table, frozen=True):
    """`push` of a load case: a level force on the robot; 0 degrees is ahead, 90 to its left."""

    force_n: Positive
    at: Pushed = Pushed.HANDS
    direction_deg: float = 180.0


class LoadCaseTable(Table, frozen=True):
    """`[[load_case]]`: a posture in which the robot stands alone, for what it asks of actuators.

    It may `hold` a payload or be given a `push`, or both. `joints_deg` gives the joints that are not at zero.
    `balance` names groups of joints that each move by one offset until the robot is balanced: one group on
    both feet, two on one. The actuators' peak torque is `factor` times the torques of the case.
    """

    name: Name
    balance: Annotated[tuple[tuple[Name, ...], ...], Meta(min_length=1)]
    feet: Feet = Feet.BOTH
    joints_deg: dict[str, float] = msgspec.field(default_factory=dict)
    factor: Positive = 2.0
    hold: HoldTable | None = None
    push: PushTable | None = None


class HardwareTable(Table, frozen=True):
    """`[hardware]`: the share of a hollow link's mass in the file that stays beside its wall."""

    non_structural_share: Share = 0.3


class DutyTable(Table, frozen=True):
    """`[duty]`: how often and how long the robot holds the load, and what its windings bear.

    `winding_limit_c` is what the rated torque leads to in the end, in air of 25 degrees.
    """

    lifts_per_hour: Positive
    hold_s: Positive
    shift_h: Positive
    winding_limit_c: Annotated[float, Meta(gt=60.0, le=250.0)]
    thermal_time_constant_s: Positive
    air_c: Annotated[float, Meta(ge=-40.0, le=55.0)] = 25.0


class AllocationTable(Table, frozen=True):
    """`[[design.allocation]]`: how a design shares the load; see `design.allocation` for the names."""

    name: Name
    lower: float
    upper: float


class DesignTable(Table, frozen=True):
    """`[design]`: what may change."""

    length: tuple[LengthTable, ...] = ()
    section: tuple[SectionTable, ...] = ()
    joint: tuple[JointTable, ...] = ()
    density: tuple[DensityTable, ...] = ()
    wall: tuple[WallTable, ...] = ()
    actuator: tuple[ActuatorTable, ...] = ()
    allocation: tuple[AllocationTable, ...] = ()
