"""Feasibility first: how outcomes are ordered, whatever the search.

    feasible, by cost  <  violated, by known violation  <  unknown (failed, or an objective is missing)

The order of Deb 2000, with one class more: a failure left its violation unknown, so nothing may rank it
among the known ones, and no number is made up for it.

Source: Deb, An efficient constraint handling method for genetic algorithms, 2000, Section 3.
"""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from evodesign.records import Genome
from evodesign.searches.base import Outcome

Objectives = tuple[float, ...]


def infeasibility(outcome: Outcome) -> float:
    """Zero when feasible, the violation when it is known, infinity when it is not.

    An outcome that claims to be feasible but has no finite objectives is a failure: unknown.
    """
    if usable(outcome) is not None:
        return 0.0
    if outcome.violation is None or not outcome.violation > 0.0:
        return math.inf
    return outcome.violation


def usable(outcome: Outcome) -> Objectives | None:
    """The objectives of a feasible outcome, all finite; None for every other outcome."""
    objectives = outcome.objectives
    if not outcome.feasible or objectives is None or not all(map(math.isfinite, objectives)):
        return None
    return objectives


def ranks(outcomes: Sequence[Outcome], cost: Callable[[Objectives], float]) -> list[int]:
    """How many of the outcomes are better than each; equals share a rank.

    Args:
        outcomes: of one generation.
        cost: value, to be minimised, of a feasible outcome's objectives.
    Returns:
        One rank per outcome, zero for the best.
    """
    keys = [_key(outcome, cost) for outcome in outcomes]
    ordered = sorted(keys)
    return [bisect_left(ordered, key) for key in keys]


def check_outcomes(asked: Sequence[Genome], outcomes: Sequence[Outcome], objectives: int) -> None:
    """Refuse outcomes that cannot belong to the genomes last asked for.

    Raises:
        ValueError: nothing was asked, or a wrong number of outcomes or of objectives.
    """
    if len(outcomes) != len(asked) or not asked:
        raise ValueError(f"wanted one outcome for each of {len(asked)} genomes asked, found {len(outcomes)}")
    for index, outcome in enumerate(outcomes):
        if outcome.objectives is not None and len(outcome.objectives) != objectives:
            found = len(outcome.objectives)
            raise ValueError(f"wanted {objectives} objectives, found {found} in outcome {index}")


def with_outcomes(population: Any, outcomes: Sequence[Outcome], objectives: int) -> None:
    """Give members of a pymoo population their outcomes.

    Infeasibility is the one constraint; objectives are NaN where there are none.
    """
    absent = (math.nan,) * objectives
    population.set("F", np.array([usable(outcome) or absent for outcome in outcomes]))
    population.set("G", np.array([[infeasibility(outcome)] for outcome in outcomes]))


def _key(outcome: Outcome, cost: Callable[[Objectives], float]) -> tuple[float, float]:
    objectives = usable(outcome)
    return (infeasibility(outcome), 0.0 if objectives is None else cost(objectives))
