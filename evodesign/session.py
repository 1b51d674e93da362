"""What every loop works with: a run being written, and what is done with each evaluation and generation.

A search must be told the same whether an evaluation has just arrived or is read from the log. So the log
decides: an assessment that a pool gives back is taken as the log would give it back, and one that it cannot
hold is a failure.

A session's first evaluations are held back while every one of them fails for the same reason. When that is a
whole generation, no design is the cause, but a mistake in an objective or a machine that starts no worker:
the session ends, and the log holds nothing of them.
"""

from __future__ import annotations

import math
import re
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from pathlib import Path

import msgspec

from evodesign.analysis.conditions import described
from evodesign.analysis.front import RunningFront, minimised
from evodesign.analysis.run_state import RunState
from evodesign.errors import AllFailed
from evodesign.evaluation.progress import PrecomputeProgress
from evodesign.pool.base import Factory, Finished, Pool
from evodesign.records import (
    Assessed,
    Assessment,
    CaseGradient,
    Detail,
    Evaluation,
    Genome,
    Gradients,
    Parameter,
    RunHeader,
    Sense,
    Status,
    Turn,
    design_of,
)
from evodesign.runlog.session_log import Observer, SessionLog
from evodesign.searches.base import Gradient, ObjectivePart, Outcome
from evodesign.violations import HEIGHT, bound_margin, height_margin

Evaluate = Factory[Genome, Assessed]

NUMBER = re.compile(r"-?\d[\d.]*(e[-+]?\d+)?")
"""What may differ between two reasons that are the same."""


@dataclass(frozen=True, slots=True)
class Display:
    """What shows a session to somebody.

    Args:
        note: a sentence about something that begins, is strange, or ended early.
        precompute: what a problem needs before its first evaluation.
        search: the search itself.
    """

    note: Callable[[str], None]
    precompute: Callable[[], AbstractContextManager[PrecomputeProgress]]
    search: Callable[[], AbstractContextManager[Observer]]


@dataclass(frozen=True, slots=True)
class EvaluationOutcome:
    """An evaluation and its postures; without cases where none was solved."""

    evaluation: Evaluation
    detail: Detail

    @property
    def failure(self) -> str:
        """Why nothing was computed of the design; empty where something was."""
        assessment = self.evaluation.assessment
        computed = assessment.violation is not None or assessment.reach or assessment.cases
        return "" if computed else assessment.reason


class FirstOutcomes:
    """A session's first evaluations, held back while all of them fail for the same reason."""

    def __init__(self) -> None:
        self._held: list[EvaluationOutcome] = []
        self._computed = False

    def hold(self, outcome: EvaluationOutcome) -> bool:
        """Hold an evaluation back, unless something was computed of it or an earlier one; gives whether."""
        reasons = {NUMBER.sub("", each.failure) for each in (*self._held[:1], outcome)}
        self._computed = self._computed or len(reasons) > 1 or "" in reasons
        if not self._computed:
            self._held.append(outcome)
        return not self._computed

    def release(self) -> list[EvaluationOutcome]:
        """What was held back, which is held no longer."""
        held, self._held = self._held, []
        return held


def evaluation_outcome(
    number: int,
    generation: int,
    genome: Genome,
    parameters: tuple[Parameter, ...],
    finished: Finished[Assessed],
    turn: Turn | None = None,
) -> EvaluationOutcome:
    """What came of a genome, with its place in the run; a failure becomes a status with its reason."""
    assessed = _assessed(genome, parameters, finished)
    evaluation = Evaluation(
        number=number,
        generation=generation,
        genome=genome,
        assessment=assessed.assessment,
        seconds=finished.seconds,
        worker=finished.worker,
        turn=turn,
        gradient_seconds=assessed.gradient_seconds,
    )
    return EvaluationOutcome(evaluation, Detail(evaluation=number, cases=assessed.cases))


def _assessed(genome: Genome, parameters: tuple[Parameter, ...], finished: Finished[Assessed]) -> Assessed:
    if finished.failure is not None:
        return _failed(genome, parameters, _status(finished), finished.failure)
    if strange := _not_finite(msgspec.to_builtins(finished.value), ""):
        reason = f"not a finite number: {strange}"
        return _failed(genome, parameters, Status.NUMERICAL_FAILURE, reason)
    try:
        return msgspec.json.decode(msgspec.json.encode(finished.value), type=Assessed)
    except (msgspec.MsgspecError, TypeError) as error:
        reason = f"the log cannot hold this assessment: {error}"
        return _failed(genome, parameters, Status.NUMERICAL_FAILURE, reason)


def _status(finished: Finished[Assessed]) -> Status:
    if finished.worker_lost:
        return Status.WORKER_LOST
    return Status.TIME_LIMIT if finished.out_of_time else Status.NUMERICAL_FAILURE


def _not_finite(value: object, name: str) -> str:
    """The name and value of a number in a value that is not finite; empty when there is none."""
    match value:
        case float() if not math.isfinite(value):
            return f"{name} is {value}"
        case dict():
            inner = ((f"{name}.{key}".lstrip("."), each) for key, each in value.items())
        case list() | tuple():
            inner = ((f"{name}[{index}]", each) for index, each in enumerate(value))
        case _:
            return ""
    return next(filter(None, (_not_finite(each, key) for key, each in inner)), "")


def _failed(genome: Genome, parameters: tuple[Parameter, ...], status: Status, reason: str) -> Assessed:
    design = design_of(parameters, genome)
    return Assessed(
        assessment=Assessment(design=design, objectives={}, violation=None, status=status, reason=reason)
    )


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
    first: FirstOutcomes = field(default_factory=FirstOutcomes)


def search_outcome(header: RunHeader, evaluation: Evaluation) -> Outcome:
    """What a search may know of an evaluation."""
    assessment = evaluation.assessment
    values = minimised(header.objectives, assessment)
    names = [parameter.name for parameter in header.parameters]
    continuous = [parameter.name for parameter in header.parameters if not parameter.choices]
    gradients = Gradients({}, {}) if assessment.gradients is msgspec.UNSET else assessment.gradients

    def by_coordinate(row: Mapping[str, float] | None, factor: float) -> Gradient | None:
        """Derivatives by parameter, times a factor; None if there are none."""
        return None if row is None else tuple(factor * row[n] if n in row else None for n in names)

    def gradient(quantity: str, factor: float) -> Gradient | None:
        return by_coordinate(gradients.values.get(quantity), factor)

    def part(case: CaseGradient, factor: float) -> ObjectivePart:
        row = None if case.slopes is None else dict(zip(continuous, case.slopes, strict=True))
        return ObjectivePart(factor * case.value, by_coordinate(row, factor))

    signs = [(each.name, -1.0 if each.sense is Sense.MAXIMISE else 1.0) for each in header.objectives]
    margins = [(HEIGHT, height_margin(assessment.reach, assessment.cases), 1.0)]
    for constraint in header.constrained:
        value = assessment.constrained.get(constraint.name)
        found = (None, 1.0) if value is None else bound_margin(constraint, value)
        margins.append((constraint.name, *found))
    return Outcome(
        objectives=values,
        violation=assessment.violation,
        gradients=tuple(gradient(*sign) for sign in signs),
        margins=tuple(margin for _, margin, _ in margins),
        margin_gradients=tuple(gradient(name, factor) for name, _, factor in margins),
        descriptors=described(header, evaluation),
        parts=tuple(
            tuple(part(each, sign) for each in gradients.cases.get(name, ())) for name, sign in signs
        ),
    )


def remember(session: Session, outcome: EvaluationOutcome, *, more: bool) -> None:
    """Put an evaluation on the disk, or soon, with `more`; unless all have failed so far."""
    if not session.first.hold(outcome):
        for each in (*session.first.release(), outcome):
            _put(session, each, more=more)


def settle(session: Session, whole: int) -> None:
    """At the end of a generation, put what was held back on the disk, unless it is all of the generation.

    Args:
        session: whose evaluations they are.
        whole: number of evaluations of a generation.
    Raises:
        AllFailed: all of it, for one reason; a later session evaluates it again.
    """
    held = session.first.release()
    if len(held) >= max(whole, 2):
        raise AllFailed(
            f"the first {len(held)} evaluations of this session all failed for one reason, so they are not "
            f"kept: {held[0].failure}; mend that, then go on with: evodesign resume {session.directory}"
        )
    for each in held:
        _put(session, each, more=False)


def _put(session: Session, outcome: EvaluationOutcome, *, more: bool) -> None:
    """Log an evaluation, with its postures if none so far dominates it."""
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
