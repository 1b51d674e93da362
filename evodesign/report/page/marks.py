"""Designs of a page: which evaluations it holds, and which of them it marks.

Marked are the unscaled robot, the best of each objective, of all and of those that are nowhere worse than it,
knees, and what the user asks for.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

from evodesign.analysis.decision_making import knees
from evodesign.analysis.front import to_minimise
from evodesign.analysis.gains import Gains
from evodesign.errors import InputError
from evodesign.problem.build import DesignProblem
from evodesign.problem.designs import alike
from evodesign.records import Evaluation, Objective, RunHeader, Sense
from evodesign.report.page.content import Mark, Points
from evodesign.report.subset import subsample
from evodesign.violations import reason_of_infeasibility

MOST_KNEES = 3
MOST_NEAR = 5

MOST_POINTS = 10_000
"""Evaluations in the page; beyond this number they are thinned out evenly, and a note says so."""


def unscaled(problem: DesignProblem, evaluations: Sequence[Evaluation]) -> tuple[Mark, ...]:
    """The evaluation of the file's own robot, if the run holds one."""
    wanted = problem.space.named(problem.space.unscaled(problem.scene.designed_tree))
    for evaluation in evaluations:
        design = evaluation.assessment.design
        if alike((design[name] for name in wanted), wanted.values()):
            return (Mark(number=evaluation.number, kind="unscaled", label="unscaled robot"),)
    return ()


def chosen(objectives: Sequence[Objective], front: Sequence[Evaluation]) -> tuple[Mark, ...]:
    """The best of each objective, then the sharpest knees; none for an empty front."""
    if not front:
        return ()
    best = [_best(objective, front) for objective in objectives]
    if len(objectives) == 1:
        return tuple(best)
    sharpest = knees(objectives, front)[:MOST_KNEES]
    return (*best, *(Mark(number=e.number, kind="knee", label="knee") for e in sharpest))


def _best(objective: Objective, front: Sequence[Evaluation]) -> Mark:
    least = min(front, key=lambda e: to_minimise(objective, e.assessment.objectives[objective.name]))
    return Mark(number=least.number, kind="best", label=_extreme(objective))


def _extreme(objective: Objective) -> str:
    word = "least" if objective.sense is Sense.MINIMISE else "greatest"
    return f"{word} {objective.name.replace('_', ' ')}"


def gained(found: Gains | None) -> tuple[Mark, ...]:
    """The best of each objective among the designs that are nowhere worse than the start design."""
    best = () if found is None else found.best
    return tuple(
        Mark(number=gain.number, kind="gain", label=f"{_extreme(gain.objective)} without loss")
        for gain in best
    )


def asked(numbers: Collection[int], evaluations: Sequence[Evaluation]) -> tuple[Mark, ...]:
    """Designs that the user names.

    Raises:
        InputError: the run has no evaluation of a number.
    """
    known = {evaluation.number for evaluation in evaluations}
    for number in numbers:
        if number not in known:
            wanted = f"numbers of the run's {len(known)} evaluations"
            raise InputError("--designs", "", wanted, f"{number}, which it does not hold")
    return tuple(Mark(number=number, kind="asked", label="asked for") for number in numbers)


def nearest_to_feasible(evaluations: Sequence[Evaluation]) -> tuple[Mark, ...]:
    """Of a run without feasible designs, those that miss the least."""
    known = [(e.assessment.violation, e.number) for e in evaluations if e.assessment.violation is not None]
    return tuple(
        Mark(number=number, kind="near", label="nearest to feasible")
        for _, number in sorted(known)[:MOST_NEAR]
    )


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
        constraints={
            constraint.name: [each.constrained.get(constraint.name) for each in worth]
            for constraint in header.constrained
        },
        parameters={
            parameter.name: [each.design[parameter.name] for each in worth] for parameter in header.parameters
        },
        violation=[each.violation for each in worth],
        lowest_m=[None if each.reach is None else each.reach.lowest_m for each in worth],
        highest_m=[None if each.reach is None else each.reach.highest_m for each in worth],
        or_lower=[each.reach is not None and each.reach.or_lower for each in worth],
        reason=[
            "" if each.feasible else reason_of_infeasibility(header.constrained, each.assessment)
            for each in shown
        ],
    )


def _kind(evaluation: Evaluation, front: Collection[int]) -> str:
    if evaluation.number in front:
        return "front"
    return "feasible" if evaluation.feasible else "infeasible"
