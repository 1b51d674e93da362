"""Uncrowded hypervolume improvement: what one more point adds to a set, or how far it is from adding.

    gain(z) = HV(S + z) - HV(S)          for z in the open region R that the points S leave
            = -distance(z, closure of R) otherwise

R holds the points that are better than the reference in every objective and that no point of S weakly
dominates. Dominated points get a slope towards R, away from S, where the improvement alone is flat.

R is the union of the boxes below its local upper bounds u, so that the distance needs no search:

    distance(z, closure of R) = min_u |max(z - u, 0)|

All objectives are minimised and should be of one scale, which the distance (not the order of improvements)
depends on.

Source: Toure, Hansen, Auger and Brockhoff, Uncrowded hypervolume improvement: COMO-CMA-ES and the Sofomore
framework, 2019, Section 3; Klamroth, Lacour and Vanderpooten, On the representation of the search region in
multi-objective optimization, 2015, Section 3 for the local upper bounds.
"""

from __future__ import annotations

import moocore
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class HypervolumeImprovement:
    """The uncrowded hypervolume improvement over a set of points.

    Args:
        points: S [points x objectives], of any number, dominated ones and such beyond the reference included.
        reference: the corner of the hypervolume, one value per objective.
    """

    def __init__(self, points: Array, reference: Array) -> None:
        self._points = points
        self._reference = reference
        self._bounds = local_upper_bounds(points, reference)
        self._conquered = _hypervolume(points, reference)

    def __call__(self, point: Array) -> float:
        """Hypervolume that the point adds; minus the distance to where it would add if it adds none."""
        distance = float(np.linalg.norm(np.maximum(point - self._bounds, 0.0), axis=1).min())
        if distance > 0.0:
            return -distance
        return _hypervolume(np.vstack([self._points, point]), self._reference) - self._conquered


def local_upper_bounds(points: Array, reference: Array) -> Array:
    """The corners [corners x objectives] whose open boxes below them are the region that points leave.

    Every point cuts the boxes that hold it into one box per objective, whose corner takes that coordinate
    of the point; a box within another is dropped.
    """
    bounds = reference[np.newaxis]
    for point in points:
        cut = (point < bounds).all(axis=1)
        pieces = np.repeat(bounds[cut][:, np.newaxis], len(point), axis=1)
        each = np.arange(len(point))
        pieces[:, each, each] = point
        bounds = _outermost(np.vstack([bounds[~cut], pieces.reshape(-1, len(point))]))
    return bounds


def _outermost(corners: Array) -> Array:
    """Corners of the boxes that are not part of another box, each once."""
    once = np.unique(corners, axis=0)
    within = (once[:, np.newaxis] <= once[np.newaxis]).all(axis=2)
    outermost: Array = once[within.sum(axis=1) == 1]
    return outermost


def _hypervolume(points: Array, reference: Array) -> float:
    return float(moocore.hypervolume(points, ref=reference)) if len(points) else 0.0
