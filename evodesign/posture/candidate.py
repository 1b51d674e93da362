"""A start's result after the check, and the best of several."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from evodesign.nlp.solver import RawSolution
from evodesign.posture.check import TOLERANCE, sizes
from evodesign.posture.limit_groups import LimitGroup
from evodesign.posture.results import Attempt, CaseSolution, Instant
from evodesign.posture.terms.base import Residual
from evodesign.records import Case, Status, worst_status

__all__ = ["Candidate", "Trial", "case_solution", "cheapest", "checked"]


@dataclass(frozen=True, slots=True)
class Candidate:
    """A start's result after the check.

    Args:
        attempt: how it ended; solved only if the check agrees.
        instants: its postures; none unless the solver succeeded.
        residuals: what the check found.
        raw: the solve; the robot's, where the person's is another one.
    """

    attempt: Attempt
    instants: tuple[Instant, ...]
    residuals: tuple[Residual, ...]
    raw: RawSolution

    @property
    def solved(self) -> bool:
        """Whether the solver and the check agree on it."""
        return self.attempt.status is Status.SOLVED

    @property
    def overlaps(self) -> bool:
        """Whether the check refuses it for its bodies."""
        worst = max(self.residuals, key=lambda residual: residual.size, default=None)
        return not self.solved and worst is not None and worst.group is LimitGroup.COLLISIONS


@dataclass(frozen=True, slots=True)
class Trial:
    """What the starts of one program led to.

    Args:
        attempts: all of them.
        best: the cheapest that the check agrees with.
        overlaps: whether the check refused one for bodies that no row of the program keeps apart.
    """

    attempts: tuple[Attempt, ...]
    best: Candidate | None
    overlaps: bool = False


def checked(formulation: str, start: str, raw: RawSolution, residuals: Sequence[Residual]) -> Attempt:
    """How a solve ended in the light of its residuals (none for a solve that failed or was not looked at)."""
    status, reason = raw.status, raw.reason
    if residuals:
        worst = max(residuals, key=lambda residual: residual.size)
        if not worst.size <= TOLERANCE:
            status = Status.NUMERICAL_FAILURE
            reason = f"the check found {worst.name} {worst.size:.1e} above {TOLERANCE:g} ({worst.words})"
    return Attempt(formulation, start, status, reason, raw.iterations, raw.seconds, raw.cost, raw.method)


def cheapest(
    formulation: str,
    ends: Sequence[tuple[str, RawSolution]],
    settle: Callable[[RawSolution], RawSolution],
    finish: Callable[[str, RawSolution], Candidate],
) -> Trial:
    """Settle, finish and check solves from the cheapest on, until one holds.

    Args:
        formulation: its name.
        ends: the name of each start, and where it led.
        settle: goes on from a solution that violates rows which were switched off; what it gives costs more.
        finish: makes a candidate of a solve that succeeded.
    """
    starts, raws = [start for start, _ in ends], [raw for _, raw in ends]
    attempts = [checked(formulation, start, raw, ()) for start, raw in ends]
    left = {place for place, raw in enumerate(raws) if raw.status is Status.SOLVED}
    settled: set[int] = set()
    overlaps = False
    while left:
        place = min(left, key=lambda place: (raws[place].cost, place))
        if place not in settled:
            settled.add(place)
            raws[place] = settle(raws[place])
            attempts[place] = checked(formulation, starts[place], raws[place], ())
        else:
            candidate = finish(starts[place], raws[place])
            attempts[place] = candidate.attempt
            if candidate.solved:
                return Trial(tuple(attempts), candidate)
            overlaps = overlaps or candidate.overlaps
            left.remove(place)
        if raws[place].status is not Status.SOLVED:
            left.discard(place)
    return Trial(tuple(attempts), None, overlaps)


def case_solution(case: Case, trials: Sequence[Trial]) -> CaseSolution:
    """The cheapest checked posture in a case, or why there is none."""
    attempts = tuple(attempt for trial in trials for attempt in trial.attempts)
    found = [trial.best for trial in trials if trial.best is not None]
    if not found:
        status = worst_status([attempt.status for attempt in attempts])
        reason = f"no posture found at {case.task}: " + "; ".join(a.reason for a in attempts)
        return CaseSolution(case, status, reason, attempts=attempts)
    best = min(found, key=lambda candidate: candidate.attempt.cost)
    return CaseSolution(
        case=case,
        status=Status.SOLVED,
        reason="solved",
        instants=best.instants,
        residuals=sizes(best.residuals),
        attempts=attempts,
        attempt=best.attempt,
        raw=best.raw,
    )
