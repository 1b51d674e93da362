"""From what a pool gives back to the evaluation that is remembered.

A search must be told the same whether an evaluation has just arrived or is read from the log. So the log
decides: an assessment is taken as the log would give it back, and one that it cannot hold is a failure.
"""

from __future__ import annotations

import msgspec

from evodesign.pool.base import Finished
from evodesign.records import Assessment, Evaluation, Genome, Parameter, Status, design_of

__all__ = ["evaluation_of"]


def evaluation_of(
    number: int,
    generation: int,
    genome: Genome,
    parameters: tuple[Parameter, ...],
    finished: Finished[Assessment],
) -> Evaluation:
    """The evaluation of a genome with its place in the run; a failure becomes a status with its reason."""
    return Evaluation(
        number=number,
        generation=generation,
        genome=genome,
        assessment=_assessment(genome, parameters, finished),
        seconds=finished.seconds,
        worker=finished.worker,
    )


def _assessment(
    genome: Genome, parameters: tuple[Parameter, ...], finished: Finished[Assessment]
) -> Assessment:
    if finished.failure is not None:
        status = Status.WORKER_LOST if finished.worker_lost else Status.NUMERICAL_FAILURE
        return _failed(genome, parameters, status, finished.failure)
    try:
        return msgspec.json.decode(msgspec.json.encode(finished.value), type=Assessment)
    except (msgspec.MsgspecError, TypeError) as error:
        reason = f"the log cannot hold this assessment (a number that is not finite?): {error}"
        return _failed(genome, parameters, Status.NUMERICAL_FAILURE, reason)


def _failed(genome: Genome, parameters: tuple[Parameter, ...], status: Status, reason: str) -> Assessment:
    design = design_of(parameters, genome)
    return Assessment(design=design, objectives={}, violation=None, status=status, reason=reason)
