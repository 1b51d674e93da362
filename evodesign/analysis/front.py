"""The Pareto front of a run: the evaluations that no other one dominates.

A design dominates another when it is nowhere worse and somewhere better. Only feasible designs whose
objectives all exist take part. moocore compares; maximised objectives are negated for it.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import moocore
import numpy as np

from evodesign.records import Assessment, Evaluation, Objective, Sense


def to_minimise(objective: Objective, value: float) -> float:
    """A natural value turned so that less is better; applied twice, the natural value again."""
    return -value if objective.sense is Sense.MAXIMISE else value


def minimised(objectives: Sequence[Objective], assessment: Assessment) -> tuple[float, ...] | None:
    """The assessment's objectives in the given order, maximised ones negated; None if one is absent."""
    values = assessment.objectives
    if any(objective.name not in values for objective in objectives):
        return None
    return tuple(to_minimise(objective, values[objective.name]) for objective in objectives)


def comparable(
    objectives: Sequence[Objective], evaluations: Iterable[Evaluation]
) -> list[tuple[Evaluation, tuple[float, ...]]]:
    """Feasible evaluations with all objectives, in order of number, each with its minimised values."""
    found = [
        (evaluation, values)
        for evaluation in evaluations
        if evaluation.feasible and (values := minimised(objectives, evaluation.assessment)) is not None
    ]
    return sorted(found, key=lambda pair: pair[0].number)


def front(objectives: Sequence[Objective], evaluations: Iterable[Evaluation]) -> tuple[Evaluation, ...]:
    """Feasible evaluations that none dominates, in order of number; of equal ones the earliest."""
    candidates = comparable(objectives, evaluations)
    if not candidates:
        return ()
    kept = moocore.is_nondominated(np.array([values for _, values in candidates]))
    return tuple(evaluation for (evaluation, _), keep in zip(candidates, kept, strict=True) if keep)


class RunningFront:
    """The front of the evaluations shown to it so far, of which it remembers the minimised values.

    Args:
        objectives: of the run.
    """

    def __init__(self, objectives: Sequence[Objective]) -> None:
        self._objectives = tuple(objectives)
        self._values = np.empty((0, len(self._objectives)))

    def enters(self, evaluation: Evaluation) -> bool:
        """Whether none shown before dominates this one, which is shown by asking.

        An equal one enters too: whichever of them is on the front in the end, it did.
        """
        values = minimised(self._objectives, evaluation.assessment)
        if not evaluation.feasible or values is None:
            return False
        new = np.array(values)
        if np.any(np.all(self._values <= new, axis=1) & np.any(self._values < new, axis=1)):
            return False
        dominated = np.all(new <= self._values, axis=1)
        self._values = np.vstack([self._values[~dominated], new])
        return True
