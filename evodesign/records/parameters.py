"""What a design is made of, and what is asked of it."""

from __future__ import annotations

import math
from collections.abc import Mapping

from evodesign.records.cases import Sense
from evodesign.tasks import Record

Genome = tuple[float, ...]
"""A point of the unit cube, one coordinate per design parameter."""


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
        else:
            value = self.lower * (1.0 - coordinate) + self.upper * coordinate
        return min(max(value, self.lower), self.upper)  # rounding takes it past neither

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


def materials_of(parameters: tuple[Parameter, ...], design: Mapping[str, float]) -> dict[str, str]:
    """The material's name of each parameter that has one in a design."""
    found = {parameter.name: parameter.material_of(design[parameter.name]) for parameter in parameters}
    return {name: material for name, material in found.items() if material is not None}
