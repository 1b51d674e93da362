"""What the global model leaves over near known designs: first-order expansions, the nearest counting most.

    r(u) = e^(-d^2 / 2 f^2) sum_n v_n (r_n + g_n . (u - u_n)),    v_n ~ |u - u_n|^-6,  sum v_n = 1

with d the distance of the nearest known design and r_n, g_n what the model misses there of value and
gradient. Distances are scaled by the lengths over which outputs change. Far from everything the global
model stands alone.

Source: Shepard, A two-dimensional interpolation function for irregularly-spaced data, 1968.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

FADING = 0.25
LEAST = 1e-9
"""Squared distance below which two designs are the same."""


def squared_distances(points: Array, others: Array) -> Array:
    """[points x others]."""
    found = (points**2).sum(axis=1)[:, None] + (others**2).sum(axis=1) - 2.0 * points @ others.T
    return np.asarray(np.maximum(found, LEAST))


class LocalResidual:
    """The expansions of known designs.

    Args:
        points: [points x dimension].
        scale: of distances, by coordinate.
        values: what is missed [points x outputs].
        gradients: of that [points x outputs x dimension], nan where unknown.
    """

    def __init__(self, points: Array, scale: Array, values: Array, gradients: Array) -> None:
        self._scale, self._points = scale, points / scale
        slopes = np.nan_to_num(gradients) * scale
        self._constants = values - np.einsum("nkd,nd->nk", slopes, self._points)
        self._slopes = slopes.reshape(len(points), -1)
        self._shape = slopes.shape[1:]

    def __call__(self, points: Array) -> Array:
        """At points [points x outputs]."""
        places = points / self._scale
        distances = squared_distances(places, self._points)
        weights = 1.0 / (distances * distances * distances)
        fading = np.exp(-distances.min(axis=1) / (2.0 * FADING**2))
        weights *= (fading / weights.sum(axis=1))[:, None]
        slopes = (weights @ self._slopes).reshape(len(points), *self._shape)
        return np.asarray(weights @ self._constants + np.einsum("qkd,qd->qk", slopes, places))
