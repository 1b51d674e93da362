"""How many evaluations of a run failed, and of what: a design that is merely infeasible has not failed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping

from evodesign.records import Evaluation, Status

__all__ = ["causes", "failed", "failures"]


def failed(evaluation: Evaluation) -> bool:
    """Whether an evaluation ended without a result for its design."""
    return evaluation.assessment.status not in (Status.SOLVED, Status.INFEASIBLE)


def failures(evaluations: Iterable[Evaluation]) -> Counter[Status]:
    """Failed evaluations by status."""
    return Counter(each.assessment.status for each in evaluations if failed(each))


def causes(counts: Mapping[Status, int]) -> str:
    """Counts in words, the gravest last: `time limit 2, worker lost 1`; `none` without any."""
    return ", ".join(f"{status.value} {counts[status]}" for status in Status if counts.get(status)) or "none"
