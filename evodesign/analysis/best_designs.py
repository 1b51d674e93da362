"""The best designs of several runs together: the best in each objective, and knees of the common front."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import msgspec

from evodesign.analysis.comparison import Compared, Comparison
from evodesign.analysis.decision_making import knees
from evodesign.analysis.front import front, to_minimise
from evodesign.records import Evaluation, Objective

__all__ = ["MOST_KNEES", "BestDesign", "best_designs"]

MOST_KNEES = 5
"""Knees of the common front that are named."""


@dataclass(frozen=True, slots=True)
class BestDesign:
    """A design to look at first.

    Args:
        reason: what it is best at, in words.
        run: that found it.
        evaluation: its number is that of its run.
    """

    reason: str
    run: Compared
    evaluation: Evaluation


def best_designs(comparison: Comparison) -> tuple[BestDesign, ...]:
    """The best designs of a comparison's runs, after the evaluations that are counted."""
    found = [(run, evaluation) for run in comparison.runs for evaluation in run.front]
    if not found:
        return ()
    numbered = [
        msgspec.structs.replace(evaluation, number=place) for place, (_, evaluation) in enumerate(found)
    ]
    objectives = comparison.objectives
    places = [(f"best {each.name}", _best_in(each, numbered)) for each in objectives]
    common = front(objectives, numbered)
    places += [("knee", knee.number) for knee in knees(objectives, common)[:MOST_KNEES]]
    return tuple(BestDesign(reason, *found[place]) for reason, place in places)


def _best_in(objective: Objective, numbered: Sequence[Evaluation]) -> int:
    """Place of the design that is best in an objective."""
    values = {each.number: each.assessment.objectives[objective.name] for each in numbered}
    return min(values, key=lambda place: to_minimise(objective, values[place]))
