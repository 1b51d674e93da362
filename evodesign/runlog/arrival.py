"""From what a pool gives back to the evaluation that is remembered.

A search must be told the same whether an evaluation has just arrived or is read from the log. So the log
decides: an assessment is taken as the log would give it back, and one that it cannot hold is a failure.
"""

from __future__ import annotations

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
    design_of,
)

__all__ = ["Arrival", "arrival_of"]


@dataclass(frozen=True, slots=True)
class Arrival:
    """An evaluation and its postures; without heights where none was solved."""

    evaluation: Evaluation
    detail: Detail


def arrival_of(
    number: int,
    generation: int,
    genome: Genome,
    parameters: tuple[Parameter, ...],
    finished: Finished[Assessed],
) -> Arrival:
    """What came of a genome, with its place in the run; a failure becomes a status with its reason."""
    assessed = _assessed(genome, parameters, finished)
    evaluation = Evaluation(
        number=number,
        generation=generation,
        genome=genome,
        assessment=assessed.assessment,
        seconds=finished.seconds,
        worker=finished.worker,
    )
    return Arrival(evaluation, Detail(evaluation=number, heights=assessed.heights))


def _assessed(genome: Genome, parameters: tuple[Parameter, ...], finished: Finished[Assessed]) -> Assessed:
    if finished.failure is not None:
        status = Status.WORKER_LOST if finished.worker_lost else Status.NUMERICAL_FAILURE
        return _failed(genome, parameters, status, finished.failure)
    try:
        return msgspec.json.decode(msgspec.json.encode(finished.value), type=Assessed)
    except (msgspec.MsgspecError, TypeError) as error:
        reason = f"the log cannot hold this assessment (a number that is not finite?): {error}"
        return _failed(genome, parameters, Status.NUMERICAL_FAILURE, reason)


def _failed(genome: Genome, parameters: tuple[Parameter, ...], status: Status, reason: str) -> Assessed:
    design = design_of(parameters, genome)
    return Assessed(
        assessment=Assessment(design=design, objectives={}, violation=None, status=status, reason=reason)
    )
