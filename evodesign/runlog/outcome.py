"""From what a pool gives back to the evaluation that is remembered.

A search must be told the same whether an evaluation has just arrived or is read from the log. So the log
decides: an assessment is taken as the log would give it back, and one that it cannot hold is a failure.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import msgspec

from evodesign.pool.base import Finished
from evodesign.records import (
    Assessed,
    Assessment,
    Detail,
    Evaluation,
    Genome,
    Parameter,
    Status,
    Turn,
    design_of,
)

__all__ = ["EvaluationOutcome", "evaluation_outcome"]


@dataclass(frozen=True, slots=True)
class EvaluationOutcome:
    """An evaluation and its postures; without heights where none was solved."""

    evaluation: Evaluation
    detail: Detail


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
    )
    return EvaluationOutcome(evaluation, Detail(evaluation=number, heights=assessed.heights))


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
