"""Where designs are feasible: how far beyond their bounds they are expected to lie, and whether they fail.

Margins of constraints, positive where one is violated, are modelled as objectives are, each by itself. Where
a search is told violations only, zero for every feasible design, these stand at minus the median violation
instead, so that the model has a boundary to find. Failures have no violation: they are modelled by
themselves, as +1 where a design failed and -1 where none did. A failure is expected where that model exceeds
a threshold, which is the lower the more of the latest designs failed: bold while little is lost, careful when
much is.

    infeasibility = sum of the expected violations + what the failures' model exceeds its threshold by
    threshold     = -2.4 (share of failures among the latest 48 designs), at least -0.9
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from evodesign.searches.surrogate.approximation import Function

Array = NDArray[np.float64]

STEEPNESS, CAREFUL = 2.4, -0.9

LATEST = 48
"""Designs whose failures set the threshold."""


class Feasibility:
    """The expected infeasibility of points.

    Args:
        margins: give one margin each of points [points x 1]; none where no design ever violated any.
        failure: gives +1 where points fail, -1 where they do not [points x 1]; None where none ever failed.
        share: of failures among the latest designs.
    """

    def __init__(self, margins: Sequence[Function], failure: Function | None, share: float) -> None:
        self._margins, self._failure = margins, failure
        self._threshold = max(-STEEPNESS * share, CAREFUL)

    @property
    def informed(self) -> bool:
        """Whether something is known of violations, and not of failures alone."""
        return bool(self._margins)

    def __call__(self, points: Array) -> Array:
        """One number per point, zero where it is expected to be feasible."""
        found = np.zeros(len(points))
        for margin in self._margins:
            found += np.maximum(margin(points), 0.0).sum(axis=1)
        if self._failure is not None:
            found += np.maximum(self._failure(points)[:, 0] - self._threshold, 0.0)
        return found


def margins_of_violations(violations: Array) -> Array:
    """One margin per design [designs x 1] where only violations are told."""
    violated = violations > 0.0
    inside = -float(np.median(violations[violated])) if violated.any() else 0.0
    return np.where(violated, violations, inside)[:, None]
