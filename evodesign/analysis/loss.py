"""What a damaged run has lost, as far as the rest of it tells."""

from __future__ import annotations

from collections.abc import Iterable

from evodesign.runlog.run import Run

__all__ = ["losses"]


def losses(run: Run) -> list[str]:
    """A sentence for each kind of record that is missing; none if nothing is known to be."""
    known = {evaluation.number for evaluation in run.evaluations}
    numbered = [
        *known,
        *(state.evaluations - 1 for state in run.generations),
        *(number for front in run.fronts for number in front.evaluations),
    ]
    concluded = max((evaluation.generation for evaluation in run.evaluations), default=0)
    members = {number for front in run.fronts for number in front.evaluations}
    detailed = {detail.evaluation for detail in run.details}
    missing = {
        "evaluations": set(range(1 + max(numbered, default=-1))) - known,
        "states of generations": set(range(concluded)) - {state.number for state in run.generations},
        "fronts of generations": set(range(concluded)) - {front.generation for front in run.fronts},
        "postures of designs": members - detailed if detailed else set(),
    }
    return [f"missing {what}: {_listed(numbers)}" for what, numbers in missing.items() if numbers]


def _listed(numbers: Iterable[int]) -> str:
    """Numbers in order, consecutive ones as a range: `3, 7 to 9`."""
    ranges: list[tuple[int, int]] = []
    for number in sorted(numbers):
        if ranges and number == ranges[-1][1] + 1:
            ranges[-1] = (ranges[-1][0], number)
        else:
            ranges.append((number, number))
    return ", ".join(str(low) if low == high else f"{low} to {high}" for low, high in ranges)
