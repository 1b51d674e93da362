"""What matters: how much of each objective's variation every parameter accounts for, by a run's log.

Designs are taken from the whole space, each parameter uniform within its bounds and independent of the
others (each choice of a discrete one equally often). The shares of the variance are Sobol' indices
(`evodesign.analysis.variance_shares`) of the models of `evodesign.analysis.response`; a share is the mean
over the models' samples, and its interval holds nine in ten of them. What a model does not explain of
designs that it has not seen may belong to any parameter, and is told beside.

Where the log has gradients, the slope of a parameter is the root mean square of the derivative over the
logged designs, per whole range of the parameter: it needs no model, and its interval is a bootstrap's.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from evodesign.analysis.response import Response, response
from evodesign.analysis.variance_shares import along, pair_shares, variance_shares
from evodesign.records import Evaluation, Parameter, RunHeader

Array = NDArray[np.float64]

LOW, HIGH = 0.05, 0.95
"""Quantiles that bound an interval."""

BOOTSTRAPS = 200
MOST_INTERACTING = 5
"""Parameters whose pairs are looked at: those that do most together with others."""

LEAST_INTERACTING = 0.02
"""Share of the variance that a parameter explains with others, below which no pair is looked at."""

NOTHING = 0.005
"""Share of the variance below which a parameter changes nothing."""

CLEAR = 0.9
"""Share of the variance that a model explains at least where a parameter is said to change nothing."""

PLACES = 21
"""Of a slice along a continuous parameter."""


@dataclass(frozen=True, slots=True)
class Estimate:
    """A number, and the interval that holds nine in ten of its samples."""

    value: float
    low: float
    high: float


@dataclass(frozen=True, slots=True)
class ParameterImportance:
    """What a parameter does to an objective.

    Args:
        name: of the parameter.
        first: share of the variance that it explains alone; None without a model.
        total: alone and together with others; None without a model.
        slope: root mean square of the derivative, in the objective's unit per range of the parameter; None
            without gradients.
    """

    name: str
    first: Estimate | None
    total: Estimate | None
    slope: Estimate | None


@dataclass(frozen=True, slots=True)
class PairImportance:
    """Share of the variance that two parameters explain together, and neither alone."""

    names: tuple[str, str]
    share: Estimate


@dataclass(frozen=True, slots=True)
class ObjectiveImportance:
    """What matters to an objective.

    Args:
        response: the models, or why there are none.
        parameters: the most important first.
        pairs: likewise; of the parameters that do most together with others.
    """

    response: Response
    parameters: tuple[ParameterImportance, ...]
    pairs: tuple[PairImportance, ...]

    @property
    def nothing(self) -> tuple[ParameterImportance, ...]:
        """The parameters that change nothing, where the model explains enough to say so."""
        if not self.response.models or (self.response.explained or 0.0) < CLEAR:
            return ()
        return tuple(each for each in self.parameters if each.total and each.total.high < NOTHING)


@dataclass(frozen=True, slots=True)
class Importance:
    """What matters in a run, by objective."""

    objectives: tuple[ObjectiveImportance, ...]

    @property
    def sentences(self) -> tuple[str, ...]:
        """On objectives without a model, on what models do not explain, on parameters that change nothing."""
        return (
            *itertools.chain.from_iterable(map(_explained, self.objectives)),
            *_nothing(self.objectives),
        )


@dataclass(frozen=True, slots=True)
class Slice:
    """An objective along a parameter, all others as in a design.

    Args:
        objective, parameter: names.
        values: of the parameter, in its unit.
        predicted: natural values of the objective, mean of the models' samples.
        low, high: between which nine in ten of them lie.
    """

    objective: str
    parameter: str
    values: tuple[float, ...]
    predicted: tuple[float, ...]
    low: tuple[float, ...]
    high: tuple[float, ...]


def importance(header: RunHeader, evaluations: Sequence[Evaluation]) -> Importance:
    """What matters by a log; the same for the same log.

    Args:
        header: of the run.
        evaluations: in order of number.
    """
    generator = np.random.default_rng(0)
    found = []
    for objective in header.objectives:
        known = response(objective, header.parameters, evaluations, generator)
        found.append(_of_objective(known, header, generator))
    return Importance(tuple(found))


def slices(found: Importance, parameters: Sequence[Parameter], design: Evaluation) -> tuple[Slice, ...]:
    """Slices through a design along every parameter, of every objective that has a model.

    Args:
        found: of the design's run.
        parameters: of the run.
        design: one of the run.
    """
    point = np.array([design.genome])
    made = []
    for each, (axis, parameter) in itertools.product(found.objectives, enumerate(parameters)):
        if not each.response.models:
            continue
        count = len(parameter.choices) or PLACES
        ends = (0.5 / count, 1.0 - 0.5 / count) if parameter.choices else (0.0, 1.0)
        nodes = np.linspace(*ends, count)
        samples = np.hstack([along(model, point, axis, nodes)[0] for model in each.response.models])
        low, high = np.quantile(samples, (LOW, HIGH), axis=1)
        made.append(
            Slice(
                each.response.objective.name,
                parameter.name,
                tuple(parameter.value_at(node) for node in nodes.tolist()),
                tuple(samples.mean(axis=1).tolist()),
                tuple(low.tolist()),
                tuple(high.tolist()),
            )
        )
    return tuple(made)


def _of_objective(known: Response, header: RunHeader, generator: np.random.Generator) -> ObjectiveImportance:
    names = [parameter.name for parameter in header.parameters]
    slopes = _slopes(known.slopes, generator)
    if not known.models:
        rows = [
            ParameterImportance(name, None, None, slope) for name, slope in zip(names, slopes, strict=True)
        ]
        rows.sort(key=lambda row: -(row.slope.value if row.slope else 0.0))
        return ObjectiveImportance(known, tuple(rows), ())
    counts = header.search.counts
    parts = [variance_shares(model, counts, generator) for model in known.models]
    first, total = (np.hstack([getattr(part, name) for part in parts]) for name in ("first", "total"))
    together = (total - first).mean(axis=1)
    most = [axis for axis in np.argsort(-together)[:MOST_INTERACTING] if together[axis] > LEAST_INTERACTING]
    pairs = list(itertools.combinations(sorted(int(axis) for axis in most), 2))
    shares = np.hstack(
        [
            pair_shares(model, counts, pairs, part.variance, generator)
            for model, part in zip(known.models, parts, strict=True)
        ]
    )
    rows = [
        ParameterImportance(name, _estimate(first[axis]), _estimate(total[axis]), slopes[axis])
        for axis, name in enumerate(names)
    ]
    joint = [
        PairImportance((names[one], names[two]), _estimate(samples))
        for (one, two), samples in zip(pairs, shares, strict=True)
    ]
    return ObjectiveImportance(
        known,
        tuple(rows[axis] for axis in np.argsort(-total.mean(axis=1), kind="stable")),
        tuple(sorted(joint, key=lambda pair: -pair.share.value)),
    )


def _estimate(samples: Array) -> Estimate:
    low, high = np.quantile(samples, (LOW, HIGH))
    return Estimate(float(samples.mean()), float(low), float(high))


def _slopes(gradients: Array, generator: np.random.Generator) -> list[Estimate | None]:
    """Root mean square derivatives of [designs x parameters], nan where unknown."""
    found: list[Estimate | None] = []
    for column in gradients.T:
        squares = column[~np.isnan(column)] ** 2
        if not squares.size:
            found.append(None)
            continue
        drawn = generator.multinomial(squares.size, np.full(squares.size, 1.0 / squares.size), BOOTSTRAPS)
        low, high = np.quantile(np.sqrt(drawn @ squares / squares.size), (LOW, HIGH))
        found.append(Estimate(float(np.sqrt(squares.mean())), float(low), float(high)))
    return found


def _explained(found: ObjectiveImportance) -> tuple[str, ...]:
    known, name = found.response, found.response.objective.name
    if not known.models:
        return (f"what matters to {name} cannot be told from this log: {known.reason}",)
    missing = 1.0 - (known.explained or 0.0)
    share = "more than 99.9%" if missing < 1e-3 else f"{1.0 - missing:.1%}"
    rest = "" if missing < 1e-3 else f"; the other {missing:.1%} may belong to any parameter"
    return (
        f"{name}: the model of {known.designs} designs explains {share} of the variance of designs that it "
        f"has not seen{rest}",
    )


def _nothing(objectives: Sequence[ObjectiveImportance]) -> list[str]:
    """Sentences on parameters that change nothing: of any objective, or of one."""
    lists = [{each.name: each.total.high for each in found.nothing if each.total} for found in objectives]
    everywhere = [name for name in lists[0] if all(name in names for names in lists)] if lists else []
    sentences = [
        f"{name} changes nothing: it accounts for {_at_most(max(names[name] for names in lists))} of the "
        "variance of any objective"
        for name in everywhere
    ]
    for found, names in zip(objectives, lists, strict=True):
        alone = [name for name in names if name not in everywhere]
        if alone:
            verb = "changes" if len(alone) == 1 else "change"
            each = "it accounts" if len(alone) == 1 else "they account"
            most = max(names[name] for name in alone)
            sentences.append(
                f"{', '.join(alone)} {verb} nothing of {found.response.objective.name}: {each} for "
                f"{_at_most(most)} of its variance{'' if len(alone) == 1 else ' each'}"
            )
    return sentences


def _at_most(share: float) -> str:
    return f"at most {share:.2%}" if share > 1e-4 else "less than 0.01%"
