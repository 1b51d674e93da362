"""Discrete coordinates: n equal parts of [0, 1], one for each choice, of which a genome holds the middle.

Whatever a search proposes is moved to the middles of the parts that it lies in. NSGA-II varies choices as
choices (`nsga2`). CMA-ES samples and learns as if they were continuous, but not too narrowly: its
standard deviation is at least min(0.2, mu_eff / dimension) of a part, so that it goes on to leave the part
that its mean is in, however far the other coordinates have converged.

Source: Marty, Hansen, Auger, Semet and Heron, LB+IC-CMA-ES: Two simple modifications of CMA-ES to handle
mixed-integer problems, 2024 (the lower bound, LB).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

LARGEST_BOUND = 0.2
"""Of a part, that the standard deviation of a sample is not kept above."""

Array = NDArray[np.float64]


def snapped(points: Array, counts: Sequence[int]) -> Array:
    """Points [points x dimension] of the unit cube, with discrete coordinates moved to the middles of parts.

    Args:
        points: of the unit cube.
        counts: of choices by coordinate, 0 for a continuous one, whose numbers stay.
    """
    parts = np.array(counts)
    discrete = parts > 0
    moved = np.array(points, dtype=float)
    choices = np.minimum(np.floor(moved[:, discrete] * parts[discrete]), parts[discrete] - 1)
    moved[:, discrete] = (choices + 0.5) / parts[discrete]
    return moved


def least_deviations(counts: Sequence[int], effective: float) -> list[float]:
    """Least standard deviation of CMA-ES's samples by coordinate; 0 where it is continuous.

    Args:
        counts: of choices by coordinate.
        effective: mu_eff, the number of samples of equal weight that would do as well as the selected ones.
    """
    bound = min(LARGEST_BOUND, effective / len(counts))
    return [bound / count if count else 0.0 for count in counts]
