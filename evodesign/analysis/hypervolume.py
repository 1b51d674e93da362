"""How much of the objective space a run dominates, in one number that only grows, and how it grew.

The hypervolume is the measure of the set of points that some feasible design dominates and that in turn
dominate a reference point [product of the objectives' units]. It is comparable only between evaluations
measured against the same reference, so that a run fixes its own once.

Best-so-far curves are drawn at some numbers of evaluations, the last one included: a front is not counted
anew for every evaluation.

Source: Zitzler and Thiele 1998; Fonseca, Paquete and Lopez-Ibanez 2006, computed by moocore.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import moocore
import numpy as np

from evodesign.analysis.front import comparable, front, to_minimise
from evodesign.records import Evaluation, Objective

MARGIN = 0.1
"""Share of the range by which the reference is worse than the worst value, so that the ends count."""

PLACES = 40
"""Numbers of evaluations at which a curve is drawn, at most."""


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


@dataclass(frozen=True, slots=True)
class Curve:
    """A run's history.

    Args:
        evaluations: how many were done, rising.
        hypervolume: of these, against the shared reference.
        best: best natural value of each objective among these; None before the first feasible design.
    """

    evaluations: tuple[int, ...]
    hypervolume: tuple[float, ...]
    best: dict[str, tuple[float | None, ...]]


def curve(
    objectives: Sequence[Objective], evaluations: Sequence[Evaluation], reference: Mapping[str, float]
) -> Curve:
    """The history of a run.

    Args:
        objectives: of the run.
        evaluations: in order of number.
        reference: natural value of every objective.
    """
    count = len(evaluations)
    places = sorted({round(place) for place in np.linspace(1, count, min(count, PLACES))} if count else set())
    volumes: list[float] = []
    bests: list[dict[str, float]] = []
    best_so_far: tuple[Evaluation, ...] = ()
    for start, end in zip([0, *places], places, strict=False):
        best_so_far = front(objectives, [*best_so_far, *evaluations[start:end]])
        volumes.append(hypervolume(objectives, best_so_far, reference))
        bests.append(best(objectives, best_so_far))
    return Curve(
        evaluations=tuple(places),
        hypervolume=tuple(volumes),
        best={each.name: tuple(values.get(each.name) for values in bests) for each in objectives},
    )
