"""Actuators: a catalogue of what can be ordered, and laws that tell what lies between its sizes.

An actuator is motor, gear, housing and drive in one piece. Its figures are those at its output.

    holding loss        P = (tau / K)^2,   K = k_t / sqrt(3 R)
    reflected inertia   J = N^2 J_rotor
    law                 peak     = mean ratio x rated
                        mass     = a peak^b
                        K, J, speed = a rated^b
                        windup   = mean ratio x rated   [N m/rad]

with k_t the torque at the output per ampere (rms) of phase current, R the resistance of one of three phases
in star connection, N the gear's ratio. The gear's losses are in k_t; that its friction helps a motor to hold
is left out, so the loss is rather too high.

The laws are least squares in the logarithms over the planetary actuators of ratio 12 and above whose maker
gives all figures; windup is that of gears by themselves, as nobody gives it for whole actuators. What a
maker does not give of a model is the law's at its torque.

Beyond 300 lines: rows, laws and what is chosen among them have the same figures.

Source: `data/actuators.toml`, each row with its own; the form of the laws: Budinger et al. 2012 (scaling laws
of actuators), Wensing et al. 2017 (reflected inertia).
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import cache
from importlib import resources
from itertools import pairwise
from typing import Annotated, Any

import msgspec
import numpy as np
from msgspec import Meta

from evodesign.body.placement import Placement, Scalar, Vector, cross, dot, scale, transpose
from evodesign.body.shape import Cylinder, Solid, Sphere
from evodesign.records import Record

LEAST_RATIO = 12.0
"""Ratio of the gear from which on an actuator belongs to the law's family: two planetary stages."""

DENSITY = 3000.0
"""Mass over volume of an actuator [kg/m^3]: RS04, 1.42 kg in a cylinder of 110 mm by 50 mm."""

SLENDERNESS = 50.0 / 110.0
"""Length over diameter of a housing whose maker does not give them: that of RS04."""

ARC_MINUTE = math.pi / (180.0 * 60.0)

Figure = Annotated[float, Meta(gt=0.0)]


class Mount(StrEnum):
    """How an actuator sits about its joint's axis: in the joint, or on one side of it."""

    INLINE = "inline"
    OFFSET = "offset"


@dataclass(frozen=True, slots=True)
class Mounting:
    """Where the cylinder of an actuator lies about its joint's axis, in the link before the joint.

    Args:
        share: of its length, by which its middle lies along the axis: 0 in the joint, -0.5 or 0.5 for a
            cylinder that ends there.
        across: a vector across the axis, or nearly, in the joint's frame.
    """

    share: float
    across: Vector


@dataclass(frozen=True, slots=True)
class Actuator:
    """What an actuator can do and weighs, at its output; numbers or expressions.

    Args:
        rated: torque that it can hold for ever [N m].
        peak: torque for seconds [N m].
        mass: [kg].
        motor_constant: K, torque per square root of copper loss [N m/W^0.5].
        inertia: of the rotor, reflected through the gear [kg m^2].
        stiffness: of the gear against windup [N m/rad].
        speed: without load [rad/s].
        model: its name in the catalogue; empty for one of the law.
        holds: whether a posture in which more than the rated torque is asked for is none.
        price: [EUR]; None where it is not known.
        housing: diameter and length of the cylinder around it [m]; None where they follow from the mass.
        mounting: where that cylinder lies; None for a ball of its mass in the joint, which is no body.
    """

    rated: Scalar
    peak: Scalar
    mass: Scalar
    motor_constant: Scalar
    inertia: Scalar
    stiffness: Scalar
    speed: Scalar
    model: str = ""
    holds: bool = True
    price: float | None = None
    housing: tuple[Scalar, Scalar] | None = None
    mounting: Mounting | None = None

    @property
    def size(self) -> tuple[Scalar, Scalar]:
        """Diameter and length of its housing [m]: those given, or those of its mass."""
        if self.housing is not None:
            return self.housing
        diameter = (self.mass * (4.0 / (math.pi * DENSITY * SLENDERNESS))) ** (1.0 / 3.0)
        return diameter, SLENDERNESS * diameter

    def loss(self, torque: Scalar) -> Scalar:
        """Copper loss [W] that holding a torque [N m] takes."""
        return (torque / self.motor_constant) ** 2

    def windup(self, torque: Scalar) -> Scalar:
        """Angle [rad] by which the gear gives way under a torque [N m]."""
        return torque / self.stiffness


class CatalogueRow(Record, frozen=True, kw_only=True):
    """An actuator of the catalogue, with the keys of `data/actuators.toml`; None: the source does not say."""

    model: str
    mass_kg: Figure
    peak_torque_n_m: Figure
    source: str
    rated_torque_n_m: Figure | None = None
    ratio: Figure | None = None
    torque_constant_n_m_per_a: Figure | None = None
    phase_resistance_ohm: Figure | None = None
    rotor_inertia_kg_cm2: Figure | None = None
    no_load_speed_rpm: Figure | None = None
    price_eur: Figure | None = None
    diameter_m: Figure | None = None
    length_m: Figure | None = None

    @property
    def housing(self) -> tuple[float, float] | None:
        """Diameter and length [m]."""
        given = self.diameter_m, self.length_m
        return None if given[0] is None or given[1] is None else (given[0], given[1])

    @property
    def motor_constant(self) -> float | None:
        """K = k_t / sqrt(3 R) [N m/W^0.5]."""
        if self.torque_constant_n_m_per_a is None or self.phase_resistance_ohm is None:
            return None
        return self.torque_constant_n_m_per_a / math.sqrt(3.0 * self.phase_resistance_ohm)

    @property
    def reflected_inertia(self) -> float | None:
        """N^2 J_rotor [kg m^2]."""
        if self.ratio is None or self.rotor_inertia_kg_cm2 is None:
            return None
        return self.ratio**2 * self.rotor_inertia_kg_cm2 * 1e-4

    @property
    def speed(self) -> float | None:
        """Without load [rad/s]."""
        return None if self.no_load_speed_rpm is None else self.no_load_speed_rpm * math.tau / 60.0


class Gearhead(Record, frozen=True):
    """A gear by itself: the torque that it can carry for ever, and its stiffness."""

    model: str
    rated_torque_n_m: Figure
    stiffness_n_m_per_arcmin: Figure
    source: str

    @property
    def relative_stiffness(self) -> float:
        """Stiffness per rated torque [1/rad]."""
        return self.stiffness_n_m_per_arcmin / ARC_MINUTE / self.rated_torque_n_m


class Catalogue(Record, frozen=True):
    """The whole data file."""

    sources: dict[str, str]
    actuators: tuple[CatalogueRow, ...]
    gearheads: tuple[Gearhead, ...]


@cache
def _file() -> Catalogue:
    text = resources.files("evodesign.hardware").joinpath("data", "actuators.toml").read_text("utf-8")
    return msgspec.convert(tomllib.loads(text), Catalogue)


def catalogue() -> Mapping[str, CatalogueRow]:
    """The actuators that every problem knows, by model."""
    return {row.model: row for row in _file().actuators}


def catalogue_sources() -> Mapping[str, str]:
    """What the rows' sources stand for."""
    return _file().sources


@dataclass(frozen=True, slots=True)
class PowerLaw:
    """The law y = factor x^exponent.

    Args:
        factor, exponent: of the law.
        scatter: the factor by which one standard deviation of the figures lies above the law, or below it.
    """

    factor: float
    exponent: float
    scatter: float

    def __call__(self, x: Scalar) -> Scalar:
        """The y [of the law's unit] of a number or expression."""
        return self.factor * x**self.exponent


def fitted_power_law(x: Sequence[float], y: Sequence[float], exponent: float | None = None) -> PowerLaw:
    """The power law of least squares in the logarithms.

    Args:
        x: positive figures, at least three.
        y: as many.
        exponent: of the law where it is given; then the factor is the geometric mean of y / x^exponent.
    """
    a, b = np.log(np.asarray(x, float)), np.log(np.asarray(y, float))
    unknowns = 1 if exponent is not None else 2
    slope = exponent if exponent is not None else float(np.polyfit(a, b, 1)[0])
    offset = float(np.mean(b - slope * a))
    left = b - slope * a - offset
    deviation = math.sqrt(float(left @ left) / (len(a) - unknowns))
    return PowerLaw(math.exp(offset), slope, math.exp(deviation))


@dataclass(frozen=True, slots=True)
class ActuatorLaw:
    """What an actuator of any size is like.

    Args:
        peak: torque [N m] by rated torque [N m].
        mass: [kg] by peak torque [N m].
        motor_constant: [N m/W^0.5] by rated torque [N m].
        inertia: reflected [kg m^2], by rated torque [N m].
        speed: [rad/s] by rated torque [N m].
        stiffness: [N m/rad] by rated torque [N m].
    """

    peak: PowerLaw
    mass: PowerLaw
    motor_constant: PowerLaw
    inertia: PowerLaw
    speed: PowerLaw
    stiffness: PowerLaw

    def at(self, rated: Scalar) -> Actuator:
        """The actuator of a rated torque [N m], a number or an expression."""
        peak = self.peak(rated)
        return Actuator(
            rated=rated,
            peak=peak,
            mass=self.mass(peak),
            motor_constant=self.motor_constant(rated),
            inertia=self.inertia(rated),
            stiffness=self.stiffness(rated),
            speed=self.speed(rated),
        )


@cache
def actuator_law() -> ActuatorLaw:
    """The law of the catalogue's planetary actuators of ratio 12 and above whose maker gives all figures."""
    rows = [row for row in _file().actuators if _is_complete(row) and (row.ratio or 0.0) >= LEAST_RATIO]
    rated = [float(row.rated_torque_n_m or 0.0) for row in rows]
    gears = _file().gearheads
    return ActuatorLaw(
        peak=fitted_power_law(rated, [row.peak_torque_n_m for row in rows], exponent=1.0),
        mass=fitted_power_law([row.peak_torque_n_m for row in rows], [row.mass_kg for row in rows]),
        motor_constant=fitted_power_law(rated, [row.motor_constant or 0.0 for row in rows]),
        inertia=fitted_power_law(rated, [row.reflected_inertia or 0.0 for row in rows]),
        speed=fitted_power_law(rated, [row.speed or 0.0 for row in rows]),
        stiffness=fitted_power_law([1.0] * len(gears), [gear.relative_stiffness for gear in gears], 1.0),
    )


def _is_complete(row: CatalogueRow) -> bool:
    known = (row.rated_torque_n_m, row.motor_constant, row.reflected_inertia, row.speed)
    return None not in known


def actuator_of_row(row: CatalogueRow, law: ActuatorLaw | None = None) -> Actuator:
    """The actuator of a row of the catalogue; what its source does not give is the law's.

    Args:
        row: of the catalogue, or a user's own.
        law: that of the catalogue if left out.
    """
    law = actuator_law() if law is None else law
    rated = row.rated_torque_n_m
    if rated is None:
        rated = row.peak_torque_n_m / law.peak.factor
    given = {
        "peak": row.peak_torque_n_m,
        "mass": row.mass_kg,
        "motor_constant": row.motor_constant,
        "inertia": row.reflected_inertia,
        "speed": row.speed,
        "housing": row.housing,
    }
    known: dict[str, Any] = {name: value for name, value in given.items() if value is not None}
    return replace(law.at(rated), model=row.model, price=row.price_eur, **known)


def actuator_among(models: Sequence[Actuator], rated: Scalar) -> Actuator:
    """The model of a rated torque.

    Args:
        models: of rising rated torques.
        rated: that of a model [N m], or an expression that takes no other values.
    """
    if isinstance(rated, int | float):
        return min(models, key=lambda model: abs(model.rated - rated))
    above = [rated > (one.rated + other.rated) / 2.0 for one, other in pairwise(models)]

    def figure_of(values: Sequence[Scalar]) -> Scalar:
        steps = (other - one for one, other in pairwise(values))
        return values[0] + sum(is_above * step for is_above, step in zip(above, steps, strict=True))

    names = ("peak", "mass", "motor_constant", "inertia", "stiffness", "speed")
    housing = figure_of([model.size[0] for model in models]), figure_of([model.size[1] for model in models])
    figures = {name: figure_of([getattr(model, name) for model in models]) for name in names}
    return replace(models[0], rated=rated, model="", price=None, housing=housing, **figures)


def mounted_solid(actuator: Actuator, link_from_joint: Placement, axis: Vector) -> Solid:
    """The solid of an actuator's mass in the link that holds it, with exact derivatives.

    It is the cylinder of its housing about the joint's axis, or, of one that is not mounted, a ball with its
    centre in the joint.

    Args:
        actuator: numbers or expressions.
        link_from_joint: the joint's place in the link.
        axis: the joint's, a unit vector in its frame.
    """
    mounting = actuator.mounting
    if mounting is None:
        radius = (actuator.mass * (3.0 / (4.0 * math.pi * DENSITY))) ** (1.0 / 3.0)
        return Solid(Sphere(radius), Placement(translation=link_from_joint.translation), DENSITY)
    diameter, length = actuator.size
    shape = Cylinder(diameter / 2.0, length)
    first = cross(axis, mounting.across)
    first = scale(dot(first, first) ** -0.5, first)
    turn = transpose((first, cross(axis, first), axis))
    place = Placement(rotation=turn, translation=scale(mounting.share * length, axis))
    return Solid(shape, link_from_joint @ place, actuator.mass / shape.volume)
