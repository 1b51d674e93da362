"""What every loop works with: a run being written, and what is done with each evaluation and generation."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from evodesign.analysis.front import RunningFront, minimised
from evodesign.analysis.run_state import RunState
from evodesign.pool.base import Factory, Pool
from evodesign.records import Assessed, Evaluation, Genome, RunHeader
from evodesign.runlog.observer import Observer
from evodesign.runlog.outcome import EvaluationOutcome
from evodesign.runlog.session_log import SessionLog
from evodesign.search.base import Outcome

__all__ = ["Evaluate", "Session", "conclude", "remember", "search_outcome"]

Evaluate = Factory[Genome, Assessed]


@dataclass(frozen=True, slots=True)
class Session:
    """What the loop works with."""

    directory: Path
    header: RunHeader
    memory: SessionLog
    factory: Callable[[], Evaluate]
    pool: Pool
    observer: Observer
    stop: Callable[[], bool]
    front: RunningFront


def search_outcome(header: RunHeader, evaluation: Evaluation) -> Outcome:
    """What a search may know of an evaluation."""
    values = minimised(header.objectives, evaluation.assessment)
    return Outcome(objectives=values, violation=evaluation.assessment.violation)


def remember(session: Session, outcome: EvaluationOutcome, *, more: bool) -> None:
    """Put an evaluation on the disk, with its postures if nothing so far beats it; or soon, with `more`."""
    evaluation = outcome.evaluation
    detail = outcome.detail if session.front.enters(evaluation) else None
    session.memory.remember(evaluation, detail, more=more)
    session.observer.evaluated(evaluation, session.memory.evaluations, session.header.budget)


def conclude(
    session: Session, generation: int, run_state: RunState, born: Sequence[Evaluation], begun: float
) -> None:
    """Put a generation's state and front on the disk, unless they are known."""
    run_state.add(born)
    if session.memory.concluded(generation):
        return
    state = run_state.generation(generation, born, time.perf_counter() - begun)
    session.memory.conclude(state, run_state.front(generation))
    session.observer.generation_done(state)
