"""Marked designs: the unscaled robot, the best of each objective, knees, and what the user asks for."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence

from evodesign.analysis.decision_making import knees
from evodesign.analysis.front import to_minimise
from evodesign.errors import InputError
from evodesign.problem.build import Problem
from evodesign.records import Evaluation, Objective, Sense
from evodesign.report.page.content import Mark

__all__ = ["asked", "chosen", "nearest_to_feasible", "unscaled"]

MOST_KNEES = 3
MOST_NEAR = 5


def unscaled(problem: Problem, evaluations: Sequence[Evaluation]) -> tuple[Mark, ...]:
    """The evaluation of the file's own robot, if the run holds one."""
    wanted = problem.space.named(problem.space.unscaled(problem.scene.robot.tree))
    for evaluation in evaluations:
        if _equal(evaluation.assessment.design, wanted):
            return (Mark(number=evaluation.number, kind="unscaled", label="unscaled robot"),)
    return ()


def _equal(design: Mapping[str, float], wanted: Mapping[str, float]) -> bool:
    return all(math.isclose(design[name], value, rel_tol=1e-9) for name, value in wanted.items())


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
    word = "least" if objective.sense is Sense.MINIMISE else "greatest"
    return Mark(number=least.number, kind="best", label=f"{word} {objective.name.replace('_', ' ')}")


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
