"""One number that a design chooses: what it changes, within which bounds, and on which scale.

An allocation parameter belongs to no link: it says how robot and person share the load, so that a front can
span from "the robot carries" to "the person carries".

    robot_share     part of the load's weight that the robot carries, 0 to 1
    effort_ratio    log10(w_r / w_h), where w_r + w_h = 2 weigh the agents' squared torques

An actuator parameter is the rated torque of all actuators of a group of joints: any within bounds, by the law
of the catalogue, or that of a model. A margin says how many times what is asked of it an actuator's rated
torque is; programs are given the rated torque in its place (`evaluation.sizing`).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import StrEnum

from evodesign.body.material import Material
from evodesign.body.placement import Scalar
from evodesign.hardware.actuators import Actuator, ActuatorLaw, PowerLaw, actuator_among, actuator_law
from evodesign.hardware.catalogue import Gear
from evodesign.hardware.friction import GearFriction
from evodesign.hardware.heat import Duty
from evodesign.hardware.mounting import Mounting
from evodesign.records import Parameter, middle_of
from evodesign.tree.joint_changes import JointChange
from evodesign.tree.sections import SectionChange

ROBOT_SHARE, EFFORT_RATIO = "robot_share", "effort_ratio"


@dataclass(frozen=True, slots=True)
class Allocation:
    """The range of an allocation parameter.

    Args:
        usual: its value in the unscaled robot.
        lowest, highest: between which it means something.
    """

    usual: float
    lowest: float
    highest: float

    @property
    def wanted(self) -> str:
        """Its range in words."""
        return f"a number from {self.lowest:g} to {self.highest:g}"

    def means(self, value: float) -> bool:
        """Whether a value means something."""
        return self.lowest <= value <= self.highest


ALLOCATIONS: Mapping[str, Allocation] = {
    ROBOT_SHARE: Allocation(usual=0.5, lowest=0.0, highest=1.0),
    EFFORT_RATIO: Allocation(usual=0.0, lowest=-6.0, highest=6.0),
}


class ParameterKind(StrEnum):
    """What a parameter changes; the value is the word in its full name."""

    LENGTH = "length"
    DENSITY = "density"
    WALL = "wall"
    ACTUATOR = "actuator"
    MARGIN = "margin"
    ALLOCATION = "allocation"
    SECTION = "section"
    OFFSET = "offset"
    TILT = "tilt"
    LOWER = "lower"
    UPPER = "upper"


UNITS = {
    ParameterKind.LENGTH: "1",
    ParameterKind.DENSITY: "kg/m^3",
    ParameterKind.WALL: "m",
    ParameterKind.ACTUATOR: "N m",
    ParameterKind.MARGIN: "1",
    ParameterKind.ALLOCATION: "1",
    ParameterKind.SECTION: "1",
    ParameterKind.OFFSET: "m",
    ParameterKind.TILT: "rad",
    ParameterKind.LOWER: "rad",
    ParameterKind.UPPER: "rad",
}


@dataclass(frozen=True, slots=True)
class DesignParameter:
    """One number that a design chooses, for a group of links or joints, or on the allocation of the load.

    Args:
        kind: length multiplier [-], density [kg/m^3], wall [m], actuator [N m] or allocation parameter [-].
        group: name of the group, unique among the parameters of its kind; of an allocation parameter, its
            own.
        links: names of the links that share the value; none for an actuator or allocation parameter.
        lower, upper: bounds; equal ones fix the value.
        materials: of which a density must be one's, the lightest first; none if every value within the
            bounds will do.
        joints: names of the joints that share an actuator.
        models: of which an actuator must be one, the weakest first; none if the law makes one of any size.
        changes: of joints, that the value makes.
        sections: of links, whose multiplier the value is.
        mountings: of the actuator at each of its joints; none where it is a ball.
        gear: of an actuator of any size, whose law it follows.
        duty: in what rhythm an actuator holds; None where nobody says.
        friction: by rated torque, of the gear of an actuator of any size; None: not reckoned with.
        keeps_mass: whether links keep their masses whatever their length, and not their densities.
    """

    kind: ParameterKind
    group: str
    links: tuple[str, ...]
    lower: float
    upper: float
    materials: tuple[Material, ...] = ()
    joints: tuple[str, ...] = ()
    models: tuple[Actuator, ...] = ()
    changes: tuple[JointChange, ...] = ()
    sections: tuple[SectionChange, ...] = ()
    mountings: tuple[Mounting, ...] = ()
    gear: Gear = Gear.PLANETARY
    duty: Duty | None = None
    friction: PowerLaw | None = None
    keeps_mass: bool = False

    @property
    def choices(self) -> tuple[float, ...]:
        """The only values that there are, rising; none if every value within the bounds is one."""
        return tuple(value for _, value in self._named_choices)

    @property
    def choice_names(self) -> tuple[str, ...]:
        """What the choices are called."""
        return tuple(name for name, _ in self._named_choices)

    @property
    def _named_choices(self) -> tuple[tuple[str, float], ...]:
        made_of = ((material.name, material.density) for material in self.materials)
        return (*made_of, *((model.model, model.rated) for model in self.models))

    @property
    def is_fixed(self) -> bool:
        """Whether there is one value only, so that no genome has a coordinate for it."""
        return self.lower == self.upper

    @property
    def logarithmic(self) -> bool:
        """Whether equal steps of the genome are equal ratios of the value."""
        return self.kind in (ParameterKind.ACTUATOR, ParameterKind.MARGIN)

    def nearest(self, value: float) -> tuple[str, float]:
        """Name and value of the choice that is nearest to a value."""
        return min(self._named_choices, key=lambda choice: abs(choice[1] - value))

    def coordinate(self, value: float) -> float:
        """The genome's coordinate of a value; that of the nearest choice where there are choices."""
        if self.choices:
            nearest = min(self.choices, key=lambda choice: abs(choice - value))
            return middle_of(self.choices.index(nearest), len(self.choices))
        if self.logarithmic:
            return math.log(value / self.lower) / math.log(self.upper / self.lower)
        return (value - self.lower) / (self.upper - self.lower)

    @property
    def name(self) -> str:
        """Full name, such as `length.upper_arm`."""
        return f"{self.kind}.{self.group}"

    @property
    def record(self) -> Parameter:
        """The parameter as it is remembered."""
        return Parameter(
            name=self.name,
            lower=self.lower,
            upper=self.upper,
            unit=UNITS[self.kind],
            choices=self.choices,
            materials=self.choice_names,
            logarithmic=self.logarithmic,
        )

    @property
    def law(self) -> ActuatorLaw:
        """That an actuator of any size follows."""
        return actuator_law(self.gear)

    def actuator(self, rated: Scalar) -> Actuator:
        """The actuator of a rated torque [N m], a number or an expression.

        One that is sized holds whatever is asked of it, so that its size can be told.
        """
        if self.kind is ParameterKind.MARGIN:
            found = replace(self.law.at(rated), holds=False)
        else:
            found = actuator_among(self.models, rated) if self.models else self.law.at(rated)
        if self.friction is not None:
            found = replace(found, friction=GearFriction(self.friction(rated)))
        return found if self.duty is None else replace(found, duty=self.duty)

    def actuators(self, rated: Scalar) -> dict[str, Actuator]:
        """The actuator of a rated torque [N m] at each of the joints, by name."""
        actuator = self.actuator(rated)
        mounted = zip(self.joints, self.mountings, strict=True) if self.mountings else ()
        found = {joint: replace(actuator, mounting=mounting) for joint, mounting in mounted}
        return found or dict.fromkeys(self.joints, actuator)
