"""What every loop works with: a run being written, and what is done with each evaluation and generation."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from evodesign.analysis.front import RunningFront, minimised
from evodesign.analysis.standing import Standing
from evodesign.pool.base import Factory, Pool
from evodesign.records import Assessed, Evaluation, Genome, RunHeader
from evodesign.runlog.arrival import Arrival
from evodesign.runlog.memory import Memory
from evodesign.runlog.observer import Observer
from evodesign.search.base import Outcome

__all__ = ["Evaluate", "Session", "conclude", "outcome_of", "remember"]

Evaluate = Factory[Genome, Assessed]


@dataclass(frozen=True, slots=True)
class Session:
    """What the loop works with."""

    directory: Path
    header: RunHeader
    memory: Memory
    factory: Callable[[], Evaluate]
    pool: Pool
    observer: Observer
    stop: Callable[[], bool]
    front: RunningFront


def outcome_of(header: RunHeader, evaluation: Evaluation) -> Outcome:
    """What a search may know of an evaluation."""
    values = minimised(header.objectives, evaluation.assessment)
    return Outcome(objectives=values, violation=evaluation.assessment.violation)


def remember(session: Session, arrival: Arrival, *, more: bool) -> None:
    """Put an evaluation on the disk, with its postures if nothing so far beats it; or soon, with `more`."""
    evaluation = arrival.evaluation
    detail = arrival.detail if session.front.enters(evaluation) else None
    session.memory.remember(evaluation, detail, more=more)
    session.observer.evaluated(evaluation, session.memory.evaluations, session.header.budget)


def conclude(
    session: Session, generation: int, standing: Standing, born: Sequence[Evaluation], begun: float
) -> None:
    """Put a generation's state and front on the disk, unless they are known."""
    standing.add(born)
    if session.memory.concluded(generation):
        return
    state = standing.generation(generation, born, time.perf_counter() - begun)
    session.memory.conclude(state, standing.front(generation))
    session.observer.generation_done(state)
