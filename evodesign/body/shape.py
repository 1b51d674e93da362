"""The shapes a link is made of, and the inertia of a uniform solid (Table I of the paper).

Frames: the centre of the solid; the axis of a cylinder along z; the sides of a box along x, y, z.
Dimensions are numbers or symbolic expressions [m].

    sphere     m = rho 4/3 pi r^3     I = 2/5 m r^2 (1, 1, 1)
    cylinder   m = rho pi r^2 l       I = m (3 r^2 + l^2)/12 (1, 1, 0) + m r^2/2 (0, 0, 1)
    box        m = rho x y z          I = m/12 (y^2 + z^2, x^2 + z^2, x^2 + y^2)

A hollow solid is closed: its wall is as thick at the ends as at the sides, so mass and inertia are those of
the outer shape less those of one that is smaller by the wall all around. What fills it beside the wall
(cables, boards, covers) is a mass that is spread evenly over the outer shape.

Source: Sartore et al. 2022, Eq. 3 and Table I.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from evodesign.body.inertia import Inertia
from evodesign.body.placement import Matrix, Placement, Scalar, Vector

Z = 2
"""Index of the z axis, along which a cylinder stands."""


@dataclass(frozen=True, slots=True)
class Sphere:
    """A ball of a radius [m]. Its principal dimension is the radius, whatever the direction."""

    radius: Scalar

    @property
    def volume(self) -> Scalar:
        """Volume [m^3]."""
        return 4.0 / 3.0 * math.pi * self.radius**3

    def moments(self, mass: Scalar) -> Vector:
        """Principal moments of inertia about the centre [kg m^2]."""
        moment = 0.4 * mass * self.radius**2
        return (moment, moment, moment)

    def principal_axis(self, chain_in_solid: Vector) -> Vector:
        """The chain's own direction: a ball has no preferred one."""
        length = math.sqrt(sum(x * x for x in chain_in_solid))
        return (chain_in_solid[0] / length, chain_in_solid[1] / length, chain_in_solid[2] / length)

    def principal_dimension(self, axis: Vector) -> Scalar:
        """The radius [m] (paper, Section IV)."""
        return self.radius

    def inside(self, wall: Scalar) -> Sphere:
        """The ball within a wall [m]."""
        return Sphere(self.radius - wall)

    @property
    def least_width(self) -> Scalar:
        """Its smallest dimension [m]."""
        return 2.0 * self.radius

    def lengthened(self, factor: Scalar, axis: Vector) -> Sphere:
        """The ball with its radius multiplied."""
        return Sphere(self.radius * factor)


@dataclass(frozen=True, slots=True)
class Cylinder:
    """A cylinder of a radius and a length [m] along z; its principal dimension is the length."""

    radius: Scalar
    length: Scalar

    @property
    def volume(self) -> Scalar:
        """Volume [m^3]."""
        return math.pi * self.radius**2 * self.length

    def moments(self, mass: Scalar) -> Vector:
        """Principal moments of inertia about the centre [kg m^2]."""
        across = mass * (3.0 * self.radius**2 + self.length**2) / 12.0
        return (across, across, mass * self.radius**2 / 2.0)

    def principal_axis(self, chain_in_solid: Vector) -> Vector:
        """The cylinder's axis, pointing along the chain."""
        return (0.0, 0.0, math.copysign(1.0, chain_in_solid[Z]))

    def principal_dimension(self, axis: Vector) -> Scalar:
        """The length [m]."""
        return self.length

    def inside(self, wall: Scalar) -> Cylinder:
        """The cylinder within a wall [m]."""
        return Cylinder(self.radius - wall, self.length - 2.0 * wall)

    @property
    def least_width(self) -> Scalar:
        """Its smallest dimension [m]."""
        return min(2.0 * self.radius, self.length)

    def lengthened(self, factor: Scalar, axis: Vector) -> Cylinder:
        """The cylinder with its length multiplied and its radius kept."""
        return Cylinder(self.radius, self.length * factor)


@dataclass(frozen=True, slots=True)
class Box:
    """A box with sides x, y, z [m]; its principal dimension is the side along the chain."""

    x: Scalar
    y: Scalar
    z: Scalar

    @property
    def volume(self) -> Scalar:
        """Volume [m^3]."""
        return self.x * self.y * self.z

    def moments(self, mass: Scalar) -> Vector:
        """Principal moments of inertia about the centre [kg m^2]."""
        xx, yy, zz = self.x**2, self.y**2, self.z**2
        return (mass * (yy + zz) / 12.0, mass * (xx + zz) / 12.0, mass * (xx + yy) / 12.0)

    def principal_axis(self, chain_in_solid: Vector) -> Vector:
        """The side nearest to the chain's direction, pointing along the chain."""
        nearest = max(range(3), key=lambda i: abs(chain_in_solid[i]))
        sign = math.copysign(1.0, chain_in_solid[nearest])
        return tuple(sign if i == nearest else 0.0 for i in range(3))  # type: ignore[return-value]

    def principal_dimension(self, axis: Vector) -> Scalar:
        """The side [m] along the axis."""
        return self.sides[_along(axis)]

    def inside(self, wall: Scalar) -> Box:
        """The box within a wall [m]."""
        return Box(*(side - 2.0 * wall for side in self.sides))

    @property
    def least_width(self) -> Scalar:
        """Its smallest side [m]."""
        return min(self.sides)

    def lengthened(self, factor: Scalar, axis: Vector) -> Box:
        """The box with the side along the axis multiplied and the others kept."""
        along = _along(axis)
        return Box(*(side * factor if i == along else side for i, side in enumerate(self.sides)))

    @property
    def sides(self) -> Vector:
        """The three sides [m]."""
        return (self.x, self.y, self.z)


Shape = Sphere | Cylinder | Box


@dataclass(frozen=True, slots=True)
class Solid:
    """A shape of constant density, full or hollow, placed in a link.

    Args:
        shape: its form.
        link_from_solid: its place in the link.
        density: [kg/m^3], a number or an expression; of a hollow solid that of the wall.
        wall: thickness [m], a number or an expression; None for a full solid.
        filling: mass [kg] that a hollow solid holds beside its wall.
    """

    shape: Shape
    link_from_solid: Placement
    density: Scalar
    wall: Scalar | None = None
    filling: Scalar = 0.0

    @property
    def mass(self) -> Scalar:
        """Mass [kg]."""
        if self.wall is None:
            return self.density * self.shape.volume
        return self.density * (self.shape.volume - self.shape.inside(self.wall).volume) + self.filling

    @property
    def inertia(self) -> Inertia:
        """Inertia in the link's frame."""
        a, b, c = self._moments
        about_center: Matrix = ((a, 0.0, 0.0), (0.0, b, 0.0), (0.0, 0.0, c))
        return Inertia(self.mass, (0.0, 0.0, 0.0), about_center).moved(self.link_from_solid)

    @property
    def _moments(self) -> Vector:
        """Principal moments about the centre [kg m^2]."""
        if self.wall is None:
            return self.shape.moments(self.mass)
        hollow = self.shape.inside(self.wall)
        outer = self.shape.moments(self.density * self.shape.volume + self.filling)
        inner = hollow.moments(self.density * hollow.volume)
        return (outer[0] - inner[0], outer[1] - inner[1], outer[2] - inner[2])


def _along(axis: Vector) -> int:
    return max(range(3), key=lambda i: abs(axis[i]))
