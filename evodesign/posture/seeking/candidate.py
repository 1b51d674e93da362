"""A start's result after the check, and the best of several."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass

import numpy as np

from evodesign.nlp.solver import RawSolution
from evodesign.posture.check import TOLERANCE, sizes
from evodesign.posture.limit_groups import LimitGroup
from evodesign.posture.results import Attempt, CaseSolution, Instant
from evodesign.posture.seeking.budget import BUDGET
from evodesign.posture.terms.base import Residual
from evodesign.records import Case, Status, worst_status


@dataclass(frozen=True, slots=True)
class Candidate:
    """A start's result after the check.

    Args:
        attempt: how it ended; solved only if the check agrees.
        instants: its postures; none unless the solver succeeded.
        residuals: what the check found.
        raw: the solve.
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
        lost: what the cheapest end cost that led nowhere for the bodies in its way; infinite where none did.
    """

    attempts: tuple[Attempt, ...]
    best: Candidate | None
    overlaps: bool = False
    lost: float = np.inf

    @property
    def is_doubtful(self) -> bool:
        """Whether the best may be far from the best there is."""
        relative, absolute = BUDGET.near
        return self.best is None or self.best.raw.cost > (1.0 + relative) * self.lost + absolute

    def beside(self, other: Trial) -> Trial:
        """Both as one."""
        found = [trial.best for trial in (self, other) if trial.best is not None]
        best = min(found, key=lambda candidate: candidate.raw.cost, default=None)
        return Trial((*self.attempts, *other.attempts), best, self.overlaps and best is None)


def checked(formulation: str, start: str, raw: RawSolution, residuals: Sequence[Residual]) -> Attempt:
    """How a solve ended in the light of its residuals (none for a solve that failed or was not looked at)."""
    status, reason = raw.status, raw.reason
    if residuals:
        worst = max(residuals, key=lambda residual: residual.size)
        if not worst.size <= TOLERANCE:
            status = Status.NUMERICAL_FAILURE
            reason = f"the check found {worst.name} {worst.size:.1e} above {TOLERANCE:g} ({worst.words})"
    return Attempt(formulation, start, status, reason, raw.iterations, raw.seconds, raw.cost, raw.method)


@dataclass(frozen=True, slots=True)
class Finishing:
    """How solves become candidates.

    Args:
        settle: goes on from a solution that violates rows which were switched off; what it gives costs more.
            Where no other end is left it is `patient`: what takes long is not given up.
        better: what a solution leads to that may cost less by more than so much.
        finish: makes a candidate of a named solve that succeeded.
        clear: what a solution leads to whose true bodies are in each other.
        go_on: what a solve that was given up early leads to in as many iterations again; None where none was.
    """

    settle: Callable[..., RawSolution]
    better: Callable[[RawSolution, float], RawSolution]
    finish: Callable[[str, RawSolution], Candidate]
    clear: Callable[[RawSolution], RawSolution]
    go_on: Callable[[RawSolution], RawSolution] | None = None


def cheapest(formulation: str, ends: Sequence[tuple[str, RawSolution]], finishing: Finishing) -> Trial:
    """Settle, finish and check solves from the cheapest on, until one holds; others may yet cost less.

    Others are looked at for ways to get better than it, and settled where it costs far more than the cheapest
    end promised; those that were given up at less cost go on.

    Args:
        formulation: its name.
        ends: the name of each start, and where it led.
        finishing: how solves become candidates.
    """
    starts, raws = [start for start, _ in ends], [raw for _, raw in ends]
    attempts = [checked(formulation, start, raw, ()) for start, raw in ends]
    left = {place for place, raw in enumerate(raws) if raw.status is Status.SOLVED}
    bound = min((raws[place].cost for place in left), default=np.inf)
    promised = [raw.cost for raw in raws]
    settled, cleared, nowhere = set[int](), set[int](), set[int]()
    overlaps, best = False, None
    while left and best is None:
        place = min(left, key=lambda place: (raws[place].cost, place))
        if place not in settled:
            settled.add(place)
            raws[place] = finishing.settle(raws[place], patient=len(left) == 1)
            attempts[place] = checked(formulation, starts[place], raws[place], ())
            is_left = raws[place].status is Status.SOLVED
        else:
            candidate = finishing.finish(starts[place], raws[place])
            attempts[place] = candidate.attempt
            best = candidate if candidate.solved else None
            apart = finishing.clear(raws[place]) if candidate.overlaps and place not in cleared else None
            is_left = apart is not None and apart.status is Status.SOLVED
            if apart is not None and is_left:
                cleared.add(place)
                raws[place] = apart
            overlaps = overlaps or (candidate.overlaps and not is_left)
        if not is_left:
            left.remove(place)
        if not is_left and best is None:
            nowhere.add(place)
    lost = min((promised[place] for place in nowhere), default=np.inf)
    if best is None:
        return Trial(tuple(attempts), None, overlaps, lost)
    go_on = finishing.go_on
    given_up = {place for place, raw in enumerate(raws) if go_on and raw.status is Status.ITERATION_LIMIT}
    for place in _each_once([raw.cost for raw in raws], (left - settled) | given_up):
        raw, found = raws[place], raws[place]
        least, most = np.multiply(BUDGET.promising, best.raw.cost)
        if go_on is not None and place in given_up and least < raw.cost < most:
            found = finishing.settle(go_on(raw), patient=False)
        elif best.raw.cost > BUDGET.far * bound:
            found = finishing.settle(raw, patient=False)
        elif BUDGET.same * best.raw.cost < raw.cost - best.raw.cost <= BUDGET.may_gain * best.raw.cost:
            found = finishing.better(raw, raw.cost - best.raw.cost)
        if found.status is Status.SOLVED and found.cost < best.raw.cost:
            candidate = _finished(starts[place], found, finishing, best.raw.cost)
            attempts[place] = candidate.attempt
            best = candidate if candidate.solved else best
    return Trial(tuple(attempts), best, lost=lost)


def _finished(start: str, raw: RawSolution, finishing: Finishing, most: float) -> Candidate:
    """A solve finished; bodies that the check finds in each other are parted if that costs less than most."""
    candidate = finishing.finish(start, raw)
    apart = finishing.clear(raw) if candidate.overlaps else raw
    if apart is raw or apart.status is not Status.SOLVED or apart.cost >= most:
        return candidate
    return finishing.finish(start, apart)


def _each_once(costs: Sequence[float], places: Collection[int]) -> list[int]:
    """Those of some solves that are different optima, the cheapest first."""
    found: list[int] = []
    for place in sorted(places, key=lambda each: costs[each]):
        if not found or costs[place] > costs[found[-1]] * (1.0 + BUDGET.same):
            found.append(place)
    return found


def case_solution(case: Case, trials: Sequence[Trial]) -> CaseSolution:
    """The cheapest checked posture in a case, or why there is none."""
    attempts = tuple(attempt for trial in trials for attempt in trial.attempts)
    found = [trial.best for trial in trials if trial.best is not None]
    if not found:
        status = worst_status([attempt.status for attempt in attempts])
        reasons = Counter(attempt.reason for attempt in attempts)
        counted = (f"{reason} ({times} times)" if times > 1 else reason for reason, times in reasons.items())
        reason = f"no posture found at {case.task}: {'; '.join(counted)}"
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
