"""Unit quaternions of rotation matrices, for files that want them.

    R = (w^2 - v.v) 1 + 2 w [v]x + 2 v v^T        with v = (x, y, z)

The largest of w, x, y, z comes from the diagonal, the others from sums and differences divided by it, so that
no rotation loses digits. Of the two quaternions of a rotation, it is the one whose first part other than zero
is positive.

Source: Shepperd 1978, Quaternion from rotation matrix.
"""

from __future__ import annotations

import math

from evodesign.body.placement import Matrix

__all__ = ["quaternion_wxyz"]


def quaternion_wxyz(rotation: Matrix) -> tuple[float, float, float, float]:
    """The unit quaternion (w, x, y, z) of a rotation matrix of numbers."""
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
