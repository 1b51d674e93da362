"""Position and orientation of one frame in another, as rotation matrix, angles or quaternion; mirror images.

A placement named `link_from_solid` takes coordinates in the solid's frame to coordinates in the link's.
Translations may be numbers or symbolic expressions (a resized link moves its children); rotations are
always numbers. Everything is plain arithmetic on tuples, so that no numerical library is needed here.

Mirror images are those in the plane y = 0, with M = diag(1, -1, 1):

    point M p        rotation or inertia M A M

M on both sides keeps right-handed frames right-handed. A rotation about an axis a by q becomes one about the
pseudovector -M a by q.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

Scalar = Any
"""A float or a CasADi expression."""

Vector = tuple[Scalar, Scalar, Scalar]
Matrix = tuple[Vector, Vector, Vector]

IDENTITY: Matrix = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
ZERO: Vector = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Placement:
    """A rigid placement: x_outer = rotation x_inner + translation.

    Args:
        rotation: 3 x 3 rotation matrix by rows, numbers.
        translation: origin of the inner frame in the outer one [m], numbers or expressions.
    """

    rotation: Matrix = IDENTITY
    translation: Vector = ZERO

    def apply(self, point: Vector) -> Vector:
        """The point's coordinates in the outer frame."""
        turned = rotate(self.rotation, point)
        return add(turned, self.translation)

    def __matmul__(self, inner: Placement) -> Placement:
        """Chain: `a_from_b @ b_from_c` is `a_from_c`."""
        return Placement(multiply(self.rotation, inner.rotation), self.apply(inner.translation))

    @property
    def inverse(self) -> Placement:
        """The place of the outer frame in the inner one."""
        back = transpose(self.rotation)
        return Placement(back, scale(-1.0, rotate(back, self.translation)))

    def mirrored(self) -> Placement:
        """The placement on the other side, of a frame that is itself mirrored."""
        return Placement(mirrored_matrix(self.rotation), mirrored_point(self.translation))

    @classmethod
    def from_xyz_rpy(cls, xyz: Sequence[float], rpy: Sequence[float]) -> Placement:
        """Placement from a URDF origin: xyz [m], rpy [rad]."""
        return cls(matrix_from_rpy(rpy), (xyz[0], xyz[1], xyz[2]))

    @classmethod
    def from_xyz_wxyz(cls, xyz: Sequence[float], wxyz: Sequence[float]) -> Placement:
        """Placement by position [m] and a quaternion of any length but zero."""
        return cls(matrix_from_wxyz(wxyz), (xyz[0], xyz[1], xyz[2]))


def vector(numbers: Iterable[float]) -> Vector:
    """Three numbers as a tuple."""
    x, y, z = map(float, numbers)
    return (x, y, z)


def add(a: Vector, b: Vector) -> Vector:
    """Sum of two vectors."""
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def scale(factor: Scalar, a: Vector) -> Vector:
    """Product of a scalar and a vector."""
    return (factor * a[0], factor * a[1], factor * a[2])


def dot(a: Vector, b: Vector) -> Scalar:
    """Scalar product of two vectors."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector, b: Vector) -> Vector:
    """The cross product."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def perpendicular(along: Vector) -> tuple[Vector, Vector]:
    """Two unit vectors across one of numbers, and across each other; right-handed with it as the third."""
    least = min(range(3), key=lambda place: abs(along[place]))
    first = cross(along, ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))[least])
    first = scale(1.0 / math.sqrt(dot(first, first)), first)
    return first, cross(along, first)


def rotate(matrix: Matrix, a: Vector) -> Vector:
    """Product of a 3 x 3 matrix and a vector."""
    return (dot(matrix[0], a), dot(matrix[1], a), dot(matrix[2], a))


def transpose(matrix: Matrix) -> Matrix:
    """Transposed 3 x 3 matrix."""
    (a, b, c), (d, e, f), (g, h, i) = matrix
    return (a, d, g), (b, e, h), (c, f, i)


def multiply(a: Matrix, b: Matrix) -> Matrix:
    """Product of two 3 x 3 matrices."""
    (x, y, z), (p, q, r) = a, transpose(b)
    return (
        (dot(x, p), dot(x, q), dot(x, r)),
        (dot(y, p), dot(y, q), dot(y, r)),
        (dot(z, p), dot(z, q), dot(z, r)),
    )


def matrix_from_rpy(rpy: Sequence[float]) -> Matrix:
    """Rotation Rz(yaw) Ry(pitch) Rx(roll) of URDF's roll, pitch and yaw [rad]."""
    (sr, sp, sy), (cr, cp, cy) = [tuple(f(angle) for angle in rpy) for f in (math.sin, math.cos)]
    rows = (
        (cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr),
        (sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr),
        (-sp, cp * sr, cp * cr),
    )
    return tuple(tuple(entry + 0.0 for entry in row) for row in rows)  # type: ignore[return-value]  # no -0.0


def matrix_from_wxyz(wxyz: Sequence[float]) -> Matrix:
    """Rotation of a quaternion (w, x, y, z), which need not be of unit length."""
    w, x, y, z = wxyz
    s = 2.0 / (w * w + x * x + y * y + z * z)
    return (
        (1.0 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)),
        (s * (x * y + w * z), 1.0 - s * (x * x + z * z), s * (y * z - w * x)),
        (s * (x * z - w * y), s * (y * z + w * x), 1.0 - s * (x * x + y * y)),
    )


def rpy_from_matrix(matrix: Matrix) -> tuple[float, float, float]:
    """Roll, pitch and yaw [rad] of a rotation m = Rz(yaw) Ry(pitch) Rx(roll), pitch from -90 to 90 degrees.

        yaw = atan2(m_10, m_00)        pitch = atan2(-m_20, sqrt(m_00^2 + m_10^2))
        (0, cos roll, -sin roll) = second row of Rz(-yaw) m = Ry(pitch) Rx(roll)

    At pitch +-90 degrees m tells only roll -+ yaw, and rounding picks the yaw. The second row, unlike the
    third, does not vanish there, so that roll makes up for whatever yaw was picked.
    """
    yaw = math.atan2(matrix[1][0], matrix[0][0])
    pitch = math.atan2(-matrix[2][0], math.hypot(matrix[0][0], matrix[1][0]))
    s, c = math.sin(yaw), math.cos(yaw)
    roll = math.atan2(s * matrix[0][2] - c * matrix[1][2], c * matrix[1][1] - s * matrix[0][1])
    return roll, pitch, yaw


def quaternion_wxyz(rotation: Matrix) -> tuple[float, float, float, float]:
    """The unit quaternion (w, x, y, z) of a rotation matrix of numbers.

        R = (w^2 - v.v) 1 + 2 w [v]x + 2 v v^T        with v = (x, y, z)

    The largest of w, x, y, z comes from the diagonal, the others from sums and differences divided by it, so
    that no rotation loses digits. Of the two quaternions of a rotation, it is the one whose first part other
    than zero is positive.

    Source: Shepperd 1978, Quaternion from rotation matrix.
    """
    (a, b, c), (d, e, f), (g, h, i) = rotation
    squares = (1.0 + a + e + i, 1.0 + a - e - i, 1.0 - a + e - i, 1.0 - a - e + i)
    products = (
        (squares[0], h - f, c - g, d - b),
        (h - f, squares[1], b + d, c + g),
        (c - g, b + d, squares[2], f + h),
        (d - b, c + g, f + h, squares[3]),
    )
    row = products[max(range(4), key=squares.__getitem__)]
    size = math.copysign(math.hypot(*row), next(part for part in row if part != 0.0))
    w, x, y, z = (part / size + 0.0 for part in row)
    return w, x, y, z


def mirrored_point(point: Vector) -> Vector:
    """The point on the other side; subtracted from zero, so that no negative zero reaches a file."""
    return (point[0], 0.0 - point[1], point[2])


def mirrored_matrix(matrix: Matrix) -> Matrix:
    """The rotation or inertia on the other side, M A M."""
    x, y, z = matrix
    return (mirrored_point(x), (0.0 - y[0], y[1], 0.0 - y[2]), mirrored_point(z))
