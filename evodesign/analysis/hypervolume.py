"""How much of the objective space a run dominates, in one number that only grows.

The hypervolume is the measure of the set of points that some feasible design dominates and that in turn
dominate a reference point [product of the objectives' units]. It is comparable only between evaluations
measured against the same reference, so that a run fixes its own once.

Source: Zitzler and Thiele 1998; Fonseca, Paquete and Lopez-Ibanez 2006, computed by moocore.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import moocore
import numpy as np

from evodesign.analysis.front import comparable, to_minimise
from evodesign.records import Evaluation, Objective

__all__ = ["best", "hypervolume", "reference_point"]

MARGIN = 0.1
"""Share of the range by which the reference is worse than the worst value, so that the ends count."""


def reference_point(
    objectives: Sequence[Objective], evaluations: Iterable[Evaluation]
) -> dict[str, float] | None:
    """A point somewhat worse than all feasible evaluations.

    Returns:
        Natural values by objective: the worst one, made worse by a tenth of the range; where all agree, by
        a tenth of the value's size, and by one if they are all zero. None without feasible evaluations.
    """
    candidates = comparable(objectives, evaluations)
    if not candidates:
        return None
    points = np.array([values for _, values in candidates])
    worst = points.max(axis=0).tolist()
    extent = np.ptp(points, axis=0).tolist()
    return {
        objective.name: to_minimise(objective, value + _margin(value, spread))
        for objective, value, spread in zip(objectives, worst, extent, strict=True)
    }


def hypervolume(
    objectives: Sequence[Objective], evaluations: Iterable[Evaluation], reference: Mapping[str, float]
) -> float:
    """Hypervolume of the feasible evaluations against a reference point.

    Args:
        objectives: in any order.
        evaluations: infeasible ones and those beyond the reference add nothing.
        reference: natural value of every objective.
    """
    candidates = comparable(objectives, evaluations)
    if not candidates:
        return 0.0
    corner = [to_minimise(objective, reference[objective.name]) for objective in objectives]
    return float(moocore.hypervolume(np.array([values for _, values in candidates]), ref=corner))


def best(objectives: Sequence[Objective], evaluations: Iterable[Evaluation]) -> dict[str, float]:
    """Best natural value of each objective over the feasible evaluations; empty without any."""
    candidates = comparable(objectives, evaluations)
    if not candidates:
        return {}
    lowest = np.array([values for _, values in candidates]).min(axis=0).tolist()
    return {
        objective.name: to_minimise(objective, value)
        for objective, value in zip(objectives, lowest, strict=True)
    }


def _margin(value: float, spread: float) -> float:
    if spread > 0.0:
        return MARGIN * spread
    return MARGIN * abs(value) if value != 0.0 else 1.0
