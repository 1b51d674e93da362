"""How evaluations of a run failed, and why designs of it are not feasible, counted by cause.

A design that is merely infeasible has not failed. The cause of infeasibility is the log's own status with the
tasks that ended so: "infeasible at 1.2 m", and with whom, where others could do them with their load. Of a
design that ended well it is the bounds that it exceeds: "mass above 65 kg". A design counts once, whatever
the number of cases that it misses.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from evodesign.records import Assessment, Constraint, Evaluation, Hold, Status
from evodesign.violations import exceeded_bounds, reason_of_infeasibility


def failed(evaluation: Evaluation) -> bool:
    """Whether an evaluation ended without a result for its design."""
    return evaluation.assessment.status not in (Status.SOLVED, Status.INFEASIBLE, Status.BODIES_OVERLAP)


def failures(evaluations: Iterable[Evaluation]) -> Counter[Status]:
    """Failed evaluations by status."""
    return Counter(each.assessment.status for each in evaluations if failed(each))


def causes(counts: Mapping[Status, int]) -> str:
    """Counts in words, the gravest last: `time limit 2, worker lost 1`; `none` without any."""
    return ", ".join(f"{status.value} {counts[status]}" for status in Status if counts.get(status)) or "none"


@dataclass(frozen=True, slots=True)
class Cause:
    """A cause and the designs that failed by it.

    Args:
        cause: status and tasks, in words.
        count: designs.
        example: number of the first of them.
        reason: a sentence on that one.
    """

    cause: str
    count: int
    example: int
    reason: str


def causes_of_infeasibility(
    evaluations: Iterable[Evaluation], constraints: Sequence[Constraint] = ()
) -> tuple[Cause, ...]:
    """Causes of the designs that are not feasible, the most frequent first; of equal ones the earliest."""
    by_cause: dict[str, list[Evaluation]] = {}
    for evaluation in evaluations:
        if not evaluation.feasible:
            by_cause.setdefault(_cause(constraints, evaluation.assessment), []).append(evaluation)
    found = [
        Cause(
            cause,
            len(same),
            same[0].number,
            reason_of_infeasibility(constraints, same[0].assessment),
        )
        for cause, same in by_cause.items()
    ]
    return tuple(sorted(found, key=lambda cause: (-cause.count, cause.example)))


def _cause(constraints: Sequence[Constraint], assessment: Assessment) -> str:
    """The bounds that a design exceeds, or its status with the tasks that ended in it if some ended well."""
    ended = [outcome.case for outcome in assessment.cases if outcome.status is assessment.status]
    if assessment.status is Status.SOLVED or not ended:
        beyond = exceeded_bounds(constraints, assessment) if assessment.status is Status.SOLVED else ()
        return " and ".join(beyond) or str(assessment.status)
    if len(ended) == len(assessment.cases) > 1:
        still = all(isinstance(case.task, Hold) for case in ended)
        return f"{assessment.status} {'at every height' if still else 'in every case'}"
    tasks = dict.fromkeys(case.task for case in ended)
    still = all(isinstance(task, Hold) for task in tasks)
    names = " and ".join(task.name if still else str(task) for task in tasks)
    place = f"{assessment.status} at {names}{' m' if still else ''}"
    there = [outcome for outcome in assessment.cases if outcome.case.task in tasks]
    if len(there) == len(ended):
        return place
    pairs = [*dict.fromkeys(case.label for case in ended)]
    return f"{place} with {pairs[0] if len(pairs) == 1 else f'{len(pairs)} pairs of person and load'}"
