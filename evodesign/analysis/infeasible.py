"""Why designs of a run are not feasible, counted by cause.

A cause is the log's own status with the heights that ended so: "infeasible at 1.2 m", and with whom, where
others could hold their load there. A design counts once, whatever the number of cases that it misses.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from evodesign.analysis.cases import pair_name
from evodesign.records import Assessment, Evaluation, Status

__all__ = ["Cause", "causes_of_infeasibility"]


@dataclass(frozen=True, slots=True)
class Cause:
    """A cause and the designs that failed by it.

    Args:
        cause: status and heights, in words.
        count: designs.
        example: number of the first of them.
        reason: the log's sentence on that one.
    """

    cause: str
    count: int
    example: int
    reason: str


def causes_of_infeasibility(evaluations: Iterable[Evaluation]) -> tuple[Cause, ...]:
    """Causes of the designs that are not feasible, the most frequent first; of equal ones the earliest."""
    by_cause: dict[str, list[Evaluation]] = {}
    for evaluation in evaluations:
        if not evaluation.feasible:
            by_cause.setdefault(_cause(evaluation.assessment), []).append(evaluation)
    found = [
        Cause(cause, len(same), same[0].number, same[0].assessment.reason) for cause, same in by_cause.items()
    ]
    return tuple(sorted(found, key=lambda cause: (-cause.count, cause.example)))


def _cause(assessment: Assessment) -> str:
    """A design's status, with the heights that ended in it if some heights ended well."""
    ended = [case for case in assessment.heights if case.status is assessment.status]
    if assessment.status is Status.SOLVED or not ended:
        return str(assessment.status)
    if len(ended) == len(assessment.heights) > 1:
        return f"{assessment.status} at every height"
    heights = dict.fromkeys(case.height_m for case in ended)
    place = f"{assessment.status} at {' and '.join(f'{height:g}' for height in heights)} m"
    there = [case for case in assessment.heights if case.height_m in heights]
    if len(there) == len(ended):
        return place
    pairs = [*dict.fromkeys(pair_name(case) for case in ended)]
    return f"{place} with {pairs[0] if len(pairs) == 1 else f'{len(pairs)} pairs of person and load'}"
