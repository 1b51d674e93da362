"""Mass, centre of mass and rotational inertia of rigid bodies: moved, rotated, mirrored, added.

    moved:    c' = R c + p,  I' = R I R^T            (I is taken about the centre of mass)
    added:    m = sum m_i,  m c = sum m_i c_i,
              I = sum I_i + m_i (|d_i|^2 1 - d_i d_i^T),  d_i = c_i - c

Source: Sartore et al. 2022, Eq. 2 and 3; Featherstone 2014, ch. 2.13.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from evodesign.body.placement import (
    IDENTITY,
    Matrix,
    Placement,
    Scalar,
    Vector,
    add,
    dot,
    mirrored_matrix,
    mirrored_point,
    multiply,
    scale,
    transpose,
)

NOTHING: Matrix = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


@dataclass(frozen=True, slots=True)
class Inertia:
    """Inertia of a rigid body in some frame; numbers or symbolic expressions.

    Args:
        mass: [kg].
        center: centre of mass in the frame [m].
        about_center: 3 x 3 inertia about the centre of mass, in the frame's axes [kg m^2].
    """

    mass: Scalar = 0.0
    center: Vector = (0.0, 0.0, 0.0)
    about_center: Matrix = NOTHING

    def moved(self, outer_from_inner: Placement) -> Inertia:
        """The same body described in the outer frame."""
        rotation = outer_from_inner.rotation
        numbers = all(isinstance(entry, float | int) for row in rotation for entry in row)
        if numbers and rotation == IDENTITY:
            return Inertia(self.mass, outer_from_inner.apply(self.center), self.about_center)
        turned = multiply(multiply(rotation, self.about_center), transpose(rotation))
        return Inertia(self.mass, outer_from_inner.apply(self.center), turned)

    def mirrored(self) -> Inertia:
        """The mirror image of the body in the plane y = 0 (`placement`)."""
        return Inertia(self.mass, mirrored_point(self.center), mirrored_matrix(self.about_center))


def offset_inertia(mass: Scalar, d: Vector) -> Matrix:
    """Inertia m (|d|^2 1 - d d^T) of a point mass at distance d [kg m^2]."""
    square = dot(d, d)
    rows = (tuple(mass * ((square if i == j else 0.0) - d[i] * d[j]) for j in range(3)) for i in range(3))
    return tuple(rows)  # type: ignore[return-value]


def total(parts: Iterable[Inertia]) -> Inertia:
    """Inertia of several bodies welded together, all given in one frame.

    The centre of an empty or massless collection is the frame's origin.
    """
    bodies = list(parts)
    if len(bodies) == 1:
        return bodies[0]
    mass: Scalar = 0.0
    moment: Vector = (0.0, 0.0, 0.0)
    for body in bodies:
        mass = mass + body.mass
        moment = add(moment, scale(body.mass, body.center))
    if isinstance(mass, int | float) and mass == 0.0:
        return Inertia()
    center = scale(1.0 / mass, moment)
    summed = NOTHING
    for body in bodies:
        d = add(body.center, scale(-1.0, center))
        summed = plus(plus(summed, body.about_center), offset_inertia(body.mass, d))
    return Inertia(mass, center, summed)


def plus(a: Matrix, b: Matrix) -> Matrix:
    """Sum of two 3 x 3 matrices."""
    return tuple(add(x, y) for x, y in zip(a, b, strict=True))  # type: ignore[return-value]
