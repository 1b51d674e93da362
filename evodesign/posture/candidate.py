"""A start's result after the check, and the best of several."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from evodesign.nlp.program import RawSolution
from evodesign.posture.check import TOLERANCE
from evodesign.posture.results import AgentPosture, Attempt, CaseSolution, Instant
from evodesign.records import Case, Status, worst_status

__all__ = ["Candidate", "Trial", "case_solution", "cheapest", "checked"]


@dataclass(frozen=True, slots=True)
class Candidate:
    """A start's result after the check.

    Args:
        attempt: how it ended; solved only if the check agrees.
        postures: by agent name.
        residuals: what the check found.
        disturbed: what is borne under each disturbance, by its name and the agent's.
    """

    attempt: Attempt
    postures: Mapping[str, AgentPosture]
    residuals: Mapping[str, float]
    disturbed: Mapping[str, Mapping[str, AgentPosture]] = field(default_factory=dict)

    @property
    def solved(self) -> bool:
        """Whether the solver and the check agree on it."""
        return self.attempt.status is Status.SOLVED


@dataclass(frozen=True, slots=True)
class Trial:
    """What the starts of one program led to: every attempt, and the cheapest that the check agrees with."""

    attempts: tuple[Attempt, ...]
    best: Candidate | None


def checked(start: str, raw: RawSolution, residuals: Mapping[str, float]) -> Attempt:
    """How a solve ended in the light of its residuals (none for a solve that failed or was not looked at)."""
    status, reason = raw.status, raw.reason
    if residuals:
        worst = max(residuals, key=lambda name: residuals[name])
        if not residuals[worst] <= TOLERANCE:
            status = Status.NUMERICAL_FAILURE
            reason = f"the check found {worst} {residuals[worst]:.1e} above {TOLERANCE:g}"
    return Attempt(start, status, reason, raw.iterations, raw.seconds, raw.cost)


def cheapest(
    ends: Sequence[tuple[str, RawSolution]], finish: Callable[[str, RawSolution], Candidate]
) -> Trial:
    """Finish and check solves from the cheapest on, until one holds.

    Args:
        ends: the name of each start, and where it led.
        finish: makes a candidate of a solve that succeeded.
    """
    attempts = [checked(start, raw, {}) for start, raw in ends]
    solved = [place for place, (_, raw) in enumerate(ends) if raw.status is Status.SOLVED]
    for place in sorted(solved, key=lambda place: ends[place][1].cost):
        candidate = finish(*ends[place])
        attempts[place] = candidate.attempt
        if candidate.solved:
            return Trial(tuple(attempts), candidate)
    return Trial(tuple(attempts), None)


def case_solution(case: Case, trials: Sequence[Trial]) -> CaseSolution:
    """The cheapest checked posture in a case of a load held still, or why there is none."""
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
        instants=(Instant(0.0, best.postures, best.disturbed),),
        residuals=best.residuals,
        attempts=attempts,
        start=best.attempt.start,
    )
