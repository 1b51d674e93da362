"""From values of single cases to one value of a design.

A case is a person with a load at a height, undisturbed or under one of the problem's disturbances. A
quantity has a value in every case; an objective is its mean over the cases, its largest value, or a quantile,
so that a front may be asked to hold for everyone and not only on average. The way stands before the
quantity's name: `human_torque` is the mean, and there are `worst_human_torque` and `q90_human_torque`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from evodesign.mechanics.scene import Scene
from evodesign.posture.results import AgentPosture
from evodesign.problem.result import DesignResult

__all__ = [
    "WORST",
    "CaseQuantity",
    "CaseValue",
    "ObjectiveKind",
    "aggregate",
    "undisturbed",
    "values_over_cases",
]

WORST = "worst_"
"""What stands before the name of a quantity whose largest value counts."""

CaseValue = Callable[[Scene, Mapping[str, AgentPosture]], float]
"""From a scene and the postures in it, by agent name, to a value."""


@dataclass(frozen=True, slots=True)
class CaseQuantity:
    """A value of every case: its unit and formula."""

    unit: str
    value: CaseValue


@dataclass(frozen=True, slots=True)
class ObjectiveKind:
    """An objective's unit and formula."""

    unit: str
    value: Callable[[DesignResult], float | None]


def values_over_cases(value: CaseValue, result: DesignResult) -> list[float] | None:
    """A quantity in every case, in the order of the results; None unless all are solved.

    A height's undisturbed case is followed by its disturbed ones.
    """
    if not all(height.solved for height in result.heights):
        return None
    return [
        value(result.scenes[height.scene], postures)
        for height in result.heights
        for postures in (height.postures, *height.disturbed.values())
    ]


def undisturbed(result: DesignResult) -> DesignResult:
    """A design's results without the load cases of disturbances."""
    return replace(result, heights=tuple(replace(height, disturbed={}) for height in result.heights))


def aggregate(quantity: CaseQuantity, way: str) -> ObjectiveKind:
    """The objective that a quantity is over all cases.

    Args:
        quantity: of single cases.
        way: nothing for the mean, `worst_` for the largest, `q90_` for the 90 % quantile (interpolated
            linearly between the values on both sides of it).
    """

    def value(result: DesignResult) -> float | None:
        values = values_over_cases(quantity.value, result)
        if values is None:
            return None
        if way == WORST:
            return max(values)
        return float(np.quantile(values, float(way[1:-1]) / 100.0) if way else np.mean(values))

    return ObjectiveKind(quantity.unit, value)
