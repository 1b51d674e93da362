"""Links as thin-walled beams: sections, stress, buckling and deflection.

    tube            A = pi (R^2 - r^2)        I = pi (R^4 - r^4)/4          J = 2 I
    rectangle       A = b h - b' h'           I = (b h^3 - b' h'^3)/12      J = 4 Am^2 t / s   (Bredt)
    stress          sigma = |N|/A + |M1| c1/I1 + |M2| c2/I2,  tau = T R/J  or  T/(2 Am t)
    von Mises       sqrt(sigma^2 + 3 tau^2)
    column          N <= pi^2 E I/(K L)^2
    round wall      sigma <= 0.605 k E t/R, with the knock-down k of a real tube
    flat wall       sigma <= 4 pi^2 E / (12 (1 - nu^2)) (t/b)^2, hinged at its edges, b its wider side
    virtual work    delta = L/(6 E I) (2 M0 m0 + M0 mL + ML m0 + 2 ML mL) + L T t/(G J) + tau u/k

b' and h' are inner sides, Am is the area inside the wall's midline and s its length; M and T are moments of a
load, m, t and u those of a unit force where the deflection is asked for, tau and u torques of a joint of
stiffness k. Virtual work is exact for moments that are linear along the beam, as under loads at its ends.

Source: textbook mechanics (Timoshenko and Gere, Mechanics of Materials and, of plates, Theory of Elastic
Stability); knock-down: NASA SP-8007.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Final

from evodesign.body.placement import Scalar
from evodesign.hardware.fatigue import ALUMINIUM_6061_T6, FatigueLine

WALL_BUCKLING = 0.605
"""Critical stress of a perfect tube's wall in units of E t/R."""

FLAT = 4.0
"""Coefficient of buckling of a long plate that is hinged along its edges."""

KNOCK_DOWN = 0.3
"""What is left of it in a real tube: the low end of 0.3 to 0.5."""


@dataclass(frozen=True, slots=True)
class MaterialStrength:
    """How stiff and strong a material is.

    Args:
        young: modulus of elasticity E [Pa].
        strength: stress at which it yields, or breaks [Pa].
        poisson: ratio.
        source: where the figures stand.
        least_wall: least wall that can be made of it [m]; zero where no source gives one.
        wall_source: where that stands.
        fatigue: what it bears how often; None where no source says.
    """

    young: float
    strength: float
    poisson: float
    source: str
    least_wall: float = 0.0
    wall_source: str = ""
    fatigue: FatigueLine | None = None

    @property
    def shear(self) -> float:
        """G = E / (2 + 2 nu) [Pa]."""
        return self.young / (2.0 + 2.0 * self.poisson)


_TABLE = "Callister and Rethwisch, Materials Science and Engineering, Tables B.2 to B.4"

_WALLS = "machined, recommended: sinbo-machining.com/wiki/dfm/wall-thickness.php"
"""Its table has 1.0 mm for 6061 and 7075 (0.5 mm at the risk of scrap), 1.5 mm for steel and titanium and
0.8 mm for engineering plastics; extruded 6061 begins at 0.76 mm (profileprecisionextrusions.com)."""

STRENGTHS: Final[Mapping[str, MaterialStrength]] = {
    "nylon_66": MaterialStrength(1.6e9, 45e6, 0.39, f"{_TABLE}: dry, the low ends", 0.0008, _WALLS),
    "carbon_fibre_epoxy": MaterialStrength(55e9, 400e6, 0.3, "quasi-isotropic tube, low end of makers' data"),
    "aluminium_6061": MaterialStrength(69e9, 276e6, 0.33, f"{_TABLE}: T6", 0.001, _WALLS, ALUMINIUM_6061_T6),
    "aluminium_7075": MaterialStrength(71e9, 503e6, 0.33, f"{_TABLE}: T6", 0.001, _WALLS),
    "titanium_6al_4v": MaterialStrength(114e9, 830e6, 0.34, f"{_TABLE}: annealed", 0.0015, _WALLS),
    "steel_4340": MaterialStrength(207e9, 472e6, 0.30, f"{_TABLE}: annealed", 0.0015, _WALLS),
}
"""Stiffness and strength of the catalogue's materials that a wall can be made of, by name."""


@dataclass(frozen=True, slots=True)
class RoundTube:
    """A tube of an outer radius and a wall [m]."""

    radius: Scalar
    wall: Scalar

    @property
    def area(self) -> Scalar:
        """Of material in the section [m^2]."""
        return math.pi * (self.radius**2 - (self.radius - self.wall) ** 2)

    @property
    def second_moments(self) -> tuple[Scalar, Scalar]:
        """About two axes across [m^4]."""
        moment = math.pi * (self.radius**4 - (self.radius - self.wall) ** 4) / 4.0
        return (moment, moment)

    @property
    def reaches(self) -> tuple[Scalar, Scalar]:
        """Distance of the outermost point from each of these axes [m]."""
        return (self.radius, self.radius)

    @property
    def torsion_constant(self) -> Scalar:
        """J [m^4]."""
        return 2.0 * self.second_moments[0]

    def torsion_stress(self, twist: Scalar) -> Scalar:
        """Shear stress [Pa] of a twisting moment [N m]."""
        return abs(twist) * self.radius / self.torsion_constant


@dataclass(frozen=True, slots=True)
class RectangularTube:
    """A rectangular tube of outer sides and a wall [m].

    Args:
        width, height: along the section's first and second axis.
        wall: on all four sides.
    """

    width: Scalar
    height: Scalar
    wall: Scalar

    @property
    def _inner(self) -> tuple[Scalar, Scalar]:
        return self.width - 2.0 * self.wall, self.height - 2.0 * self.wall

    @property
    def area(self) -> Scalar:
        """Of material in the section [m^2]."""
        inner_width, inner_height = self._inner
        return self.width * self.height - inner_width * inner_height

    @property
    def second_moments(self) -> tuple[Scalar, Scalar]:
        """About the first and the second axis [m^4]."""
        inner_width, inner_height = self._inner
        about_first = (self.width * self.height**3 - inner_width * inner_height**3) / 12.0
        about_second = (self.height * self.width**3 - inner_height * inner_width**3) / 12.0
        return (about_first, about_second)

    @property
    def reaches(self) -> tuple[Scalar, Scalar]:
        """Distance of the outermost point from each of these axes [m]."""
        return (self.height / 2.0, self.width / 2.0)

    @property
    def _midline(self) -> tuple[Scalar, Scalar]:
        return self.width - self.wall, self.height - self.wall

    @property
    def torsion_constant(self) -> Scalar:
        """J of a thin wall [m^4]."""
        width, height = self._midline
        return 2.0 * self.wall * (width * height) ** 2 / (width + height)

    def torsion_stress(self, twist: Scalar) -> Scalar:
        """Shear stress [Pa] of a twisting moment [N m], the same all around."""
        width, height = self._midline
        return abs(twist) / (2.0 * width * height * self.wall)


Section = RoundTube | RectangularTube


@dataclass(frozen=True, slots=True)
class SectionLoad:
    """What a section transmits.

    Args:
        normal: force along the beam [N].
        bending: moments about the section's first and second axis [N m].
        twist: moment about the beam [N m].
    """

    normal: float
    bending: tuple[float, float]
    twist: float


def von_mises(section: Section, load: SectionLoad) -> float:
    """The largest von Mises stress in a section [Pa]; in a rectangle that of its worst corner.

    Both bending moments count together at a corner of a rectangle; in a tube the resultant moment does.
    """
    first, second = section.second_moments
    if isinstance(section, RoundTube):
        bent = math.hypot(*load.bending) * section.radius / first
    else:
        ends = zip(load.bending, section.reaches, (first, second), strict=True)
        bent = sum(abs(moment) * reach / inertia for moment, reach, inertia in ends)
    direct = abs(load.normal) / section.area + bent
    return float(math.sqrt(direct**2 + 3.0 * section.torsion_stress(load.twist) ** 2))


def buckling_force(section: Section, length: float, young: float, effective: float = 2.0) -> float:
    """Euler's force [N] of a column.

    Args:
        section: of the column.
        length: [m].
        young: modulus of elasticity [Pa].
        effective: effective length over length: 2 clamped and free, 1 hinged, 0.5 clamped at both ends.
    """
    return float(math.pi**2 * young * min(section.second_moments) / (effective * length) ** 2)


def wall_buckling_stress(section: Section, material: MaterialStrength) -> float:
    """Compression [Pa] under which a wall gives way: a real tube's, or the wider flat side of a rectangle.

    A flat side is long, hinged along its edges and pressed evenly; one that is bent bears more.
    """
    if isinstance(section, RoundTube):
        return float(KNOCK_DOWN * WALL_BUCKLING * material.young * section.wall / section.radius)
    side = max(section.width, section.height)
    plate = math.pi**2 * material.young / (12.0 * (1.0 - material.poisson**2))
    return float(FLAT * plate * (section.wall / side) ** 2)


class Failure(StrEnum):
    """How a beam gives way."""

    YIELD = "yield"
    COLUMN = "column buckling"
    WALL = "wall buckling"


def safety_factors(
    section: Section, load: SectionLoad, length: float, material: MaterialStrength
) -> dict[Failure, float]:
    """By how much a load may grow before a beam gives way in each way; none of one that transmits nothing.

    Args:
        section: of the beam, all along it.
        load: where it is largest; a negative normal force is compression.
        length: of the beam [m].
        material: of the wall.
    """
    stress, factors = von_mises(section, load), dict[Failure, float]()
    if stress > 0.0:
        factors[Failure.YIELD] = material.strength / stress
        factors[Failure.WALL] = wall_buckling_stress(section, material) / stress
    if load.normal < 0.0:
        factors[Failure.COLUMN] = buckling_force(section, length, material.young) / -load.normal
    return factors


def bending_work(
    length: float, stiffness: float, load: tuple[float, float], unit: tuple[float, float]
) -> float:
    """The integral of M m / (E I) along a beam, for moments that are linear along it.

    Args:
        length: of the beam [m].
        stiffness: E I [N m^2].
        load: moments M at both ends [N m].
        unit: moments m of a unit force at both ends [m].
    Returns:
        The deflection's share [m].
    """
    (big, big_end), (small, small_end) = load, unit
    ends = 2.0 * big * small + big * small_end + big_end * small + 2.0 * big_end * small_end
    return length / (6.0 * stiffness) * ends


def torsion_work(length: float, stiffness: float, load: float, unit: float) -> float:
    """The integral of T t / (G J) along a beam [m]: G J [N m^2], constant moments T [N m] and t [m]."""
    return length * load * unit / stiffness
