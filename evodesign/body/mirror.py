"""Mirror images in the plane y = 0, with M = diag(1, -1, 1).

    point M p        rotation or inertia M A M

M on both sides keeps right-handed frames right-handed. A rotation about an axis a by q becomes one about the
pseudovector -M a by q.
"""

from __future__ import annotations

from evodesign.body.inertia import Inertia
from evodesign.body.placement import Matrix, Placement, Vector

__all__ = ["mirrored_inertia", "mirrored_matrix", "mirrored_placement", "mirrored_point"]


def mirrored_point(point: Vector) -> Vector:
    """The point on the other side; subtracted from zero, so that no negative zero reaches a file."""
    return (point[0], 0.0 - point[1], point[2])


def mirrored_matrix(matrix: Matrix) -> Matrix:
    """The rotation or inertia on the other side, M A M."""
    x, y, z = matrix
    return (mirrored_point(x), (0.0 - y[0], y[1], 0.0 - y[2]), mirrored_point(z))


def mirrored_placement(placement: Placement) -> Placement:
    """The placement on the other side, of a frame that is itself mirrored."""
    return Placement(mirrored_matrix(placement.rotation), mirrored_point(placement.translation))


def mirrored_inertia(inertia: Inertia) -> Inertia:
    """The body on the other side."""
    return Inertia(inertia.mass, mirrored_point(inertia.center), mirrored_matrix(inertia.about_center))
