"""What a run had found after so many evaluations: best-so-far curves.

The curves are drawn at some numbers of evaluations, the last one included: a front is not counted anew for
every evaluation.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from evodesign.analysis.front import front
from evodesign.analysis.hypervolume import best, hypervolume
from evodesign.records import Evaluation, Objective

__all__ = ["PLACES", "Curve", "curve"]

PLACES = 40
"""Numbers of evaluations at which a curve is drawn, at most."""


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
