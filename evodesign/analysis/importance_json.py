"""What matters in a run as a JSON object."""

from __future__ import annotations

from typing import Any

import msgspec

from evodesign.analysis.importance import Importance, ObjectiveImportance, importance, slices
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
    made = slices(found, run.header.parameters, through)
    return {**told, "design": design, "slices": msgspec.to_builtins(made)}


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
        "parameters": msgspec.to_builtins(found.parameters),
        "pairs": msgspec.to_builtins(found.pairs),
    }
