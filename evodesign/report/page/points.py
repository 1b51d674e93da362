"""The evaluations that the page holds, in columns."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from evodesign.records import Evaluation, RunHeader
from evodesign.report.page.content import Points
from evodesign.report.subset import subsample

__all__ = ["MOST_POINTS", "chosen_points", "points"]

MOST_POINTS = 10_000
"""Evaluations in the page; beyond this number they are thinned out evenly, and a note says so."""


def chosen_points(
    evaluations: Sequence[Evaluation], front: Collection[int], needed: Collection[int], most: int
) -> list[Evaluation]:
    """At most so many evaluations, in order of number: the needed, then the front, the feasible, the rest.

    Args:
        evaluations: of the run.
        front: numbers of the front.
        needed: numbers that must be there.
        most: how many may be.
    """
    groups: tuple[list[Evaluation], ...] = ([], [], [], [])
    for evaluation in evaluations:
        if evaluation.number in needed:
            groups[0].append(evaluation)
        elif evaluation.number in front:
            groups[1].append(evaluation)
        else:
            groups[2 if evaluation.feasible else 3].append(evaluation)
    chosen: list[Evaluation] = list(groups[0])
    for group in groups[1:]:
        chosen += subsample(group, max(0, most - len(chosen)))
    return sorted(chosen, key=lambda evaluation: evaluation.number)


def points(header: RunHeader, shown: Sequence[Evaluation], front: Collection[int]) -> Points:
    """Columns of evaluations.

    Args:
        header: of the run.
        shown: the evaluations, in order.
        front: numbers of the front.
    """
    worth = [evaluation.assessment for evaluation in shown]
    return Points(
        number=[evaluation.number for evaluation in shown],
        kind=[_kind(evaluation, front) for evaluation in shown],
        objectives={
            objective.name: [each.objectives.get(objective.name) for each in worth]
            for objective in header.objectives
        },
        parameters={
            parameter.name: [each.design[parameter.name] for each in worth] for parameter in header.parameters
        },
        violation_m=[each.violation for each in worth],
        lowest_m=[None if each.reach is None else each.reach.lowest_m for each in worth],
        highest_m=[None if each.reach is None else each.reach.highest_m for each in worth],
        reason=["" if evaluation.feasible else evaluation.assessment.reason for evaluation in shown],
    )


def _kind(evaluation: Evaluation, front: Collection[int]) -> str:
    if evaluation.number in front:
        return "front"
    return "feasible" if evaluation.feasible else "infeasible"
