"""What matters in a run as a JSON object."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from evodesign.analysis.importance import (
    Estimate,
    Importance,
    ObjectiveImportance,
    Slice,
    importance,
    slices,
)
from evodesign.runlog.run import RunLog

METHOD = (
    "Sobol' indices over the whole space, parameters uniform and independent, of models learnt from the log; "
    "means of 40 samples of five models, each made without a fifth of the designs, with 5 % and 95 % "
    "quantiles; slopes are root mean squares of the logged gradients per range of the parameter, with a "
    "bootstrap's quantiles"
)


def matters_json(run: RunLog, design: int | None) -> dict[str, Any]:
    """What matters in a run, with slices through a design if one is named; its shape is a promise.

    Raises:
        InputError: the run has no such design.
    """
    through = None if design is None else run.evaluation(design)
    found = importance(run.header, run.evaluations)
    told = {"run": str(run.directory), **importance_json(found)}
    if through is None:
        return told
    return {**told, "design": design, "slices": slices_json(slices(found, run.header.parameters, through))}


def importance_json(found: Importance) -> dict[str, Any]:
    """What matters as a JSON object. Shares are of the variance, from 0 to 1."""
    return {
        "method": METHOD,
        "objectives": [_objective(each) for each in found.objectives],
        "sentences": list(found.sentences),
    }


def _objective(found: ObjectiveImportance) -> dict[str, Any]:
    known = found.response
    return {
        "name": known.objective.name,
        "unit": known.objective.unit,
        "designs": known.designs,
        "with_gradients": known.with_gradients,
        "explained": known.explained,
        "reason": known.reason,
        "parameters": [
            {
                "name": each.name,
                "first": _estimate(each.first),
                "total": _estimate(each.total),
                "slope": _estimate(each.slope),
            }
            for each in found.parameters
        ],
        "pairs": [{"names": list(each.names), "share": _estimate(each.share)} for each in found.pairs],
    }


def _estimate(found: Estimate | None) -> dict[str, float] | None:
    return None if found is None else {"value": found.value, "low": found.low, "high": found.high}


def slices_json(made: Sequence[Slice]) -> list[dict[str, Any]]:
    """Slices through a design: values of a parameter, and what is predicted there."""
    return [
        {
            "objective": each.objective,
            "parameter": each.parameter,
            "values": list(each.values),
            "predicted": list(each.predicted),
            "low": list(each.low),
            "high": list(each.high),
        }
        for each in made
    ]
