"""A start's result after the check, and the best of several."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from evodesign.posture.check import TOLERANCE
from evodesign.posture.program import RawSolution
from evodesign.posture.solution import AgentPosture, Attempt, HeightSolution
from evodesign.records import Status, worst_status

__all__ = ["Candidate", "best_of", "checked"]


@dataclass(frozen=True, slots=True)
class Candidate:
    """A start's result after the check.

    Args:
        attempt: how it ended; solved only if the check agrees.
        postures: by agent name.
        residuals: what the check found.
    """

    attempt: Attempt
    postures: Mapping[str, AgentPosture]
    residuals: Mapping[str, float]

    @property
    def solved(self) -> bool:
        """Whether the solver and the check agree on it."""
        return self.attempt.status is Status.SOLVED


def checked(raw: RawSolution, residuals: Mapping[str, float]) -> Attempt:
    """How a solve ended in the light of its residuals (none for a solve that failed)."""
    status, reason = raw.status, raw.reason
    if residuals:
        worst = max(residuals, key=lambda name: residuals[name])
        if not residuals[worst] <= TOLERANCE:
            status = Status.NUMERICAL_FAILURE
            reason = f"the check found {worst} {residuals[worst]:.1e} above {TOLERANCE:g}"
    return Attempt(status, reason, raw.iterations, raw.seconds, raw.cost)


def best_of(height: float, candidates: Sequence[Candidate]) -> HeightSolution:
    """The cheapest solved candidate at a height [m], or why there is none."""
    attempts = tuple(candidate.attempt for candidate in candidates)
    solved = [candidate for candidate in candidates if candidate.solved]
    if not solved:
        status = worst_status([attempt.status for attempt in attempts])
        reason = f"no posture found at {height:g} m: " + "; ".join(a.reason for a in attempts)
        return HeightSolution(height, status, reason, {}, {}, attempts)
    best = min(solved, key=lambda candidate: candidate.attempt.cost)
    return HeightSolution(height, Status.SOLVED, "solved", best.postures, best.residuals, attempts)
