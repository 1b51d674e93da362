"""Actuators, and laws that tell what lies between the sizes of those that can be ordered.

An actuator is motor, gear, housing and drive in one piece. Its figures are those at its output.

    holding loss        P = (tau / K)^2,   K = k_t / sqrt(3 R)
    reflected inertia   J = N^2 J_rotor
    law                 peak     = mean ratio x rated
                        mass     = a peak^b
                        K, J, speed = a rated^b
                        windup   = mean ratio x rated   [N m/rad]
                        diameter, length = a mass^b

with k_t the torque at the output per ampere (rms) of phase current, R the resistance of one of three phases
in star connection, N the gear's ratio. Without a `friction` the gear has none: the loss of holding is rather
too high, and that of lifting rather too low.

The laws are least squares in the logarithms, one for each kind of gear. That of planetary gears is fitted to
seven actuators of ratio 12 and above whose maker gives all figures. Windup is that of gears by themselves, as
nobody gives it for whole actuators. What a maker does not give of a model is the law's at its torque.

Beyond 300 lines: laws and what is chosen among rows have the same figures.

Source: the catalogue (`hardware.catalogue`), each row with its own; the form of the laws: Budinger et al.
2012 (scaling laws of actuators), Wensing et al. 2017 (reflected inertia).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import astuple, dataclass, replace
from functools import cache
from itertools import pairwise
from operator import attrgetter
from typing import Any

import numpy as np

from evodesign.body.placement import Placement, Scalar, Vector
from evodesign.body.shape import Solid, Sphere
from evodesign.errors import InputError
from evodesign.hardware.catalogue import CatalogueRow, Gear, catalogue, gearheads
from evodesign.hardware.friction import GearFriction, MotorTorque
from evodesign.hardware.heat import Duty
from evodesign.hardware.mounting import Mounting

LEAST_ROWS = 4
"""Rows of the catalogue that have a figure, from which on there is a law of it."""

DENSITY = 3000.0
"""Mass over volume of an actuator [kg/m^3]: RS04, 1.42 kg in a cylinder of 110 mm by 50 mm."""

SLENDERNESS = 50.0 / 110.0
"""Length over diameter of a housing whose maker does not give them: that of RS04."""


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
        duty: in what rhythm it holds; None where nobody says.
        friction: of its gear; None: not reckoned with.
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
    duty: Duty | None = None
    friction: GearFriction | None = None

    @property
    def size(self) -> tuple[Scalar, Scalar]:
        """Diameter and length of its housing [m]: those given, or those of its mass."""
        if self.housing is not None:
            return self.housing
        diameter = (self.mass * (4.0 / (math.pi * DENSITY * SLENDERNESS))) ** (1.0 / 3.0)
        return diameter, SLENDERNESS * diameter

    @property
    def held(self) -> Scalar:
        """Torque that its winding bears in its duty, at most the rated one [N m]."""
        return self.rated if self.duty is None else self.rated * self.duty.derating

    def motor(self, torque: float, speed: float | None = None) -> MotorTorque:
        """The torque of its motor in a joint that gives a torque [N m] and turns at a speed [rad/s].

        Args:
            torque: at the joint.
            speed: of the joint; None: it holds still.
        """
        if self.friction is None:
            return MotorTorque(torque, 1.0)
        return self.friction.holding(torque) if speed is None else self.friction.turning(torque, speed)

    def loss(self, torque: float) -> float:
        """Copper loss [W] that holding a torque [N m] takes."""
        return float((self.motor(torque).value / self.motor_constant) ** 2)

    def windup(self, torque: Scalar) -> Scalar:
        """Angle [rad] by which the gear gives way under a torque [N m]."""
        return torque / self.stiffness


@dataclass(frozen=True, slots=True)
class PowerLaw:
    """The law y = factor x^exponent.

    Args:
        factor, exponent: of the law.
        scatter: the factor by which one standard deviation of the figures lies above the law, or below it.
        count: of figures that it was fitted to.
    """

    factor: float
    exponent: float
    scatter: float
    count: int

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
    return PowerLaw(math.exp(offset), slope, math.exp(deviation), len(a))


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
        diameter, length: of the housing [m], by mass [kg].
    """

    peak: PowerLaw
    mass: PowerLaw
    motor_constant: PowerLaw
    inertia: PowerLaw
    speed: PowerLaw
    stiffness: PowerLaw
    diameter: PowerLaw
    length: PowerLaw

    def at(self, rated: Scalar) -> Actuator:
        """The actuator of a rated torque [N m], a number or an expression."""
        peak = self.peak(rated)
        mass = self.mass(peak)
        return Actuator(
            rated=rated,
            peak=peak,
            mass=mass,
            motor_constant=self.motor_constant(rated),
            inertia=self.inertia(rated),
            stiffness=self.stiffness(rated),
            speed=self.speed(rated),
            housing=self.housing(mass),
        )

    def housing(self, mass: Scalar) -> tuple[Scalar, Scalar]:
        """Diameter and length [m] of an actuator of a mass [kg], a number or an expression."""
        return self.diameter(mass), self.length(mass)


@cache
def actuator_law(gear: Gear | str = Gear.PLANETARY) -> ActuatorLaw:
    """The law of the catalogue's actuators with a kind of gear.

    Each figure is fitted to the rows of the kind that have it, mass and housing to those with their drive in
    them. Of strain wave drives, two makers give motor constants and three reflected inertias, one of them
    both, and most speeds are the highest that the gear may turn. The planetary law, which problems use unless
    they say otherwise, is fitted to the rows marked `in_default_law`, but for diameter and length: rows can
    be added without moving the rest of it.

    Raises:
        InputError: no kind of gear, or one of which fewer than four rows have one of the figures.
    """
    laws = _laws(gear)
    if any(law is None for law in laws.values()):
        wanted = f"a gear of which {LEAST_ROWS} rows have each figure: {', '.join(gears_with_a_law())}"
        raise InputError("catalogue", "gear", wanted, f"'{gear}'")
    return ActuatorLaw(**{name: law for name, law in laws.items() if law is not None})


@cache
def friction_law(gear: Gear | str = Gear.PLANETARY) -> PowerLaw | None:
    """Torque [N m] that turns an actuator without current, by rated torque [N m]; None of too few rows.

    It is fitted to all rows of the kind that have both.
    """
    rows = [row for row in catalogue().values() if row.gear == gear]
    return _fit(rows, _RATED, attrgetter("friction_torque_n_m"))


def friction_of_row(row: CatalogueRow) -> GearFriction | None:
    """The friction of a row: its own figure, else that of the law at its rated torque; None without a law."""
    gear = Gear.STRAIN_WAVE if row.gear is Gear.STRAIN_WAVE else Gear.PLANETARY
    backdrive, law = row.friction_torque_n_m, friction_law(gear)
    if backdrive is None and law is not None:
        backdrive = float(law(actuator_of_row(row).rated))
    if backdrive is None:
        return None
    return GearFriction(backdrive, row.load_friction, row.viscous_friction_n_m_s_per_rad)


@cache
def gears_with_a_law() -> tuple[str, ...]:
    """The kinds of gear of which the catalogue has rows enough."""
    return tuple(kind.value for kind in Gear if None not in _laws(kind).values())


def _laws(gear: Gear | str) -> dict[str, PowerLaw | None]:
    """The fields of the law of a gear; None of which too few rows have the figures."""
    rows = [row for row in catalogue().values() if row.gear == gear]
    named = [row for row in rows if row.in_default_law] or rows
    whole = [row for row in rows if not row.separate_drive]
    housed = [row for row in whole if row.housing]
    stiffness = [each.relative_stiffness for each in gearheads(gear)]
    enough = len(stiffness) >= LEAST_ROWS
    return {
        "peak": _fit(named, _RATED, _PEAK, exponent=1.0),
        "mass": _fit([row for row in named if row in whole], _PEAK, _MASS),
        "motor_constant": _fit(named, _RATED, attrgetter("motor_constant")),
        "inertia": _fit(named, _RATED, attrgetter("reflected_inertia")),
        "speed": _fit(named, _RATED, attrgetter("speed")),
        "stiffness": fitted_power_law([1.0] * len(stiffness), stiffness, 1.0) if enough else None,
        "diameter": _fit(housed, _MASS, attrgetter("diameter_m")),
        "length": _fit(housed, _MASS, attrgetter("length_m")),
    }


_RATED, _PEAK, _MASS = attrgetter("rated_torque_n_m"), attrgetter("peak_torque_n_m"), attrgetter("mass_kg")


def _fit(
    rows: Sequence[CatalogueRow],
    x: Callable[[CatalogueRow], float | None],
    y: Callable[[CatalogueRow], float | None],
    exponent: float | None = None,
) -> PowerLaw | None:
    """The law of the rows that have both figures; None of fewer than four."""
    pairs = [(x(row), y(row)) for row in rows]
    known = [(a, b) for a, b in pairs if a is not None and b is not None]
    if len(known) < LEAST_ROWS:
        return None
    return fitted_power_law([a for a, _ in known], [b for _, b in known], exponent)


def actuator_of_row(row: CatalogueRow, law: ActuatorLaw | None = None) -> Actuator:
    """The actuator of a row of the catalogue; what its source does not give is the law's.

    Args:
        row: of the catalogue, or a user's own.
        law: that of the row's gear in the catalogue if left out, or of planetary gears.
    """
    if law is None:
        law = actuator_law(Gear.STRAIN_WAVE if row.gear is Gear.STRAIN_WAVE else Gear.PLANETARY)
    rated = row.rated_torque_n_m
    if rated is None:
        rated = row.peak_torque_n_m / law.peak.factor
    given = {
        "peak": row.peak_torque_n_m,
        "mass": row.mass_kg,
        "motor_constant": row.motor_constant,
        "inertia": row.reflected_inertia,
        "speed": row.speed,
        "housing": row.housing or law.housing(row.mass_kg),
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
    each = [astuple(model.friction) for model in models if model.friction is not None]
    friction = GearFriction(*map(figure_of, zip(*each, strict=True))) if each else None
    return replace(
        models[0], rated=rated, model="", price=None, housing=housing, friction=friction, **figures
    )


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
    return mounting.housing(actuator.mass, actuator.size, link_from_joint, axis)
