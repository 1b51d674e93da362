"""A model of each objective over the unit cube, learnt from the log, that says how well it explains designs.

It is the surrogate search's global model of one objective (`evodesign.searches.surrogate`), from values and,
where the log has them, gradients. Five models are made, each without a fifth of the designs: what they say
of the designs that they have not seen gives the share of the variance that they explain,

    R^2 = 1 - sum of (value - prediction)^2 / sum of (value - mean)^2

and together they show how much depends on which designs were evaluated. Lengths over which the objective
changes are those, of a few, with which the first model explains most. Uncertainty is that of samples of all
five models (Thompson samples: functions that may be the true one, for all that is known).

A model that explains less than half of the variance is none: then there is a reason instead.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from evodesign.records import Evaluation, Gradients, Objective, Parameter
from evodesign.searches.surrogate.approximation import Approximation, Function, Known
from evodesign.searches.surrogate.global_model import MOST_FEATURES
from evodesign.searches.surrogate.threads import one_thread

Array = NDArray[np.float64]

FOLDS = 5
SAMPLES = 8
"""Of each of the five models."""

SCALES = (2.0, 1.0, 0.5, 0.25, 0.125)
"""Of the lengths with which the surrogate search would begin."""

LEAST_EXPLAINED = 0.5
"""Share of the variance of unseen designs that a model explains at least."""

FEWEST, FEWEST_PER_PARAMETER = 60, 2
"""Designs without which there is no model: so many, and so many for each parameter."""

MOST = 10_000
"""Designs that a model is made of, at most; of more, the log is thinned evenly."""

LARGEST = 1e60
"""Size beyond which a value or a derivative counts as none: its square would be no number."""

CONSTANT = 1e-9
"""Of the size of a value: a smaller standard deviation is none."""


@dataclass(frozen=True, slots=True)
class Response:
    """What is known of an objective over the cube.

    Args:
        objective: in whose natural values functions speak.
        designs: of which the models are made.
        slopes: derivatives by the coordinates [designs x parameters], nan where unknown.
        explained: R^2 of unseen designs; None without models.
        models: from points to [points x samples], one for each fifth of the designs.
        reason: why there are none; empty if there are.
    """

    objective: Objective
    designs: int
    slopes: Array
    explained: float | None
    models: tuple[Function, ...]
    reason: str = ""

    @property
    def with_gradients(self) -> int:
        """How many of the designs have gradients."""
        return int((~np.isnan(self.slopes)).any(axis=1).sum())


def response(
    objective: Objective,
    parameters: Sequence[Parameter],
    evaluations: Sequence[Evaluation],
    generator: np.random.Generator,
) -> Response:
    """The models of an objective.

    Args:
        objective: one of the run's.
        parameters: of the run.
        evaluations: in order of number; those count that have the objective, feasible or not.
        generator: draws features, fifths and samples.
    """
    known = _known(objective, parameters, evaluations)
    slopes = known.gradients[:, 0]
    wanted = max(FEWEST, FEWEST_PER_PARAMETER * len(parameters))
    values = known.targets[:, 0]
    if len(values) < wanted:
        reason = f"{len(values)} evaluated designs have it, and at least {wanted} are wanted"
        return Response(objective, len(values), slopes, None, (), reason)
    if values.std() <= CONSTANT * max(1.0, float(np.abs(values).max())):
        return Response(objective, len(values), slopes, None, (), "it is the same for all designs")
    with one_thread():
        explained, models = _models(known, np.array([bool(each.choices) for each in parameters]), generator)
    if explained < LEAST_EXPLAINED:
        reason = (
            f"the model explains {max(explained, 0.0):.0%} of the variance of designs that it has not seen, "
            f"and at least {LEAST_EXPLAINED:.0%} are wanted; more evaluations may help, and so may gradients "
            "([search] gradients = true)"
        )
        return Response(objective, len(values), slopes, explained, (), reason)
    return Response(objective, len(values), slopes, explained, models)


def _models(
    known: Known, discrete: NDArray[np.bool_], generator: np.random.Generator
) -> tuple[float, tuple[Function, ...]]:
    """R^2 of unseen designs, and the models."""
    count = len(known.points)
    folds = np.array_split(generator.permutation(count), FOLDS)
    rest = [np.setdiff1d(np.arange(count), fold) for fold in folds]

    def error(model: Approximation, fold: NDArray[np.intp]) -> float:
        return float(((known.targets[fold] - model.smooth()(known.points[fold])) ** 2).sum())

    first = [
        Approximation(known.part(rest[0]), discrete, generator, scale, MOST_FEATURES) for scale in SCALES
    ]
    best = min(range(len(SCALES)), key=lambda place: error(first[place], folds[0]))
    others = [
        Approximation(known.part(part), discrete, generator, SCALES[best], MOST_FEATURES) for part in rest[1:]
    ]
    made = [first[best], *others]
    missed = sum(error(model, fold) for model, fold in zip(made, folds, strict=True))
    whole = ((known.targets - known.targets.mean()) ** 2).sum()
    return 1.0 - missed / float(whole), tuple(model.several(generator, SAMPLES) for model in made)


def _known(objective: Objective, parameters: Sequence[Parameter], evaluations: Sequence[Evaluation]) -> Known:
    """Designs with the objective, its natural values and its gradients by coordinate."""
    told = [
        each
        for each in evaluations
        if abs(each.assessment.objectives.get(objective.name, math.inf)) < LARGEST
    ]
    if len(told) > MOST:
        told = [told[place] for place in np.linspace(0, len(told) - 1, MOST).round().astype(int)]
    gradients = np.full((len(told), 1, len(parameters)), np.nan)
    for place, each in enumerate(told):
        if isinstance(each.assessment.gradients, Gradients):
            row = each.assessment.gradients.values.get(objective.name, {})
            gradients[place, 0] = [row.get(parameter.name, math.nan) for parameter in parameters]
    gradients[np.abs(gradients) > LARGEST] = np.nan
    values = [[each.assessment.objectives[objective.name]] for each in told]
    return Known(
        np.array([each.genome for each in told]).reshape(-1, len(parameters)),
        np.array(values).reshape(-1, 1),
        gradients,
    )
