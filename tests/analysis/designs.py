"""Designs as plain points, for the tests of fronts and choices."""

from __future__ import annotations

from collections.abc import Sequence

from evodesign.records import Assessment, Evaluation, Objective, Sense, Status

TORQUE = Objective(name="torque", sense=Sense.MINIMISE, unit="N m")
REACH = Objective(name="reach", sense=Sense.MAXIMISE, unit="m")
MASS = Objective(name="mass", sense=Sense.MINIMISE, unit="kg")


def design(
    number: int,
    objectives: dict[str, float],
    violation: float | None = 0.0,
    genome: tuple[float, ...] = (0.5,),
    parameters: dict[str, float] | None = None,
) -> Evaluation:
    assessment = Assessment(
        design=parameters or {}, objectives=objectives, violation=violation, status=Status.SOLVED, reason=""
    )
    return Evaluation(
        number=number, generation=0, genome=genome, assessment=assessment, seconds=0.0, worker="here"
    )


def designs_at(objectives: Sequence[Objective], points: Sequence[Sequence[float]]) -> list[Evaluation]:
    """Feasible designs with natural objective values, numbered from zero."""
    names = [objective.name for objective in objectives]
    return [design(number, dict(zip(names, point, strict=True))) for number, point in enumerate(points)]


def numbers(evaluations: Sequence[Evaluation]) -> list[int]:
    return [evaluation.number for evaluation in evaluations]
