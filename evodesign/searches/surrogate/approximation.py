"""Several outputs of designs as functions of the genome: global models and what they miss nearby.

An output is modelled by its logarithm where a few designs multiply it, as a robot's torque: where the first
designs span more than a factor of three, further above their median than below it, and no value comes near
zero. Gradients beyond three times their 98 % quantile are cut off: they stem from places next to a jump.
Coordinates along which outputs change much get short lengths,

    length = 2.5 (s / max s + 0.05)^-0.6        s: root mean square of the standardised gradient

the largest over the outputs. Where gradients are unknown, those of a first model with equal lengths serve.

An objective that is a mean over cases is modelled case by case, and only then averaged: in single cases
another posture may become the best, or a limit be reached, where a mean of all is hard to follow. No output
is expected much beyond what is known of it: by more than a twentieth of its range, in a sample a tenth.
Where a case has had one value only, such as that of a person who pushes as hard as may be, another is not
ruled out: its scale is a tenth of its mean at least.

Features are drawn anew when 64 designs have come since, so that the search does not lean on one draw, from
at most a thousand designs: so the time of a proposal is bounded, however many there are.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from evodesign.searches.surrogate.global_model import FittedModel, GlobalModel
from evodesign.searches.surrogate.local_residual import LocalResidual

Array = NDArray[np.float64]
Function = Callable[[Array], Array]
"""From points [points x dimension] to outputs [points x outputs]."""

KEPT = 1000
"""Designs that a model is made of, at most, when it is made anew."""

REDRAWN = 64
"""Designs after which it is."""

SPAN, TAIL, NEAR_ZERO = 3.0, 1.5, 0.05
FEWEST_FIRST, FIRST_PER_DIMENSION = 8, 1.5
"""How many designs are the first ones: at least so many, and so many for each coordinate."""

QUANTILE, OUTLIER = 0.98, 3.0
LENGTH, SHARE, POWER = 2.5, 0.05, -0.6
EXPECTED_BEYOND, DRAWN_BEYOND = 0.05, 0.1
LEAST_SCALE, SCALES_OF_A_RANGE = 0.1, 4.0
ALMOST = 1e-12


@dataclass(frozen=True, slots=True)
class Known:
    """Designs of which all outputs are known.

    Args:
        points: [points x dimension].
        targets: [points x outputs].
        gradients: [points x outputs x dimension], nan where unknown.
    """

    points: Array
    targets: Array
    gradients: Array

    def part(self, which: NDArray[np.intp]) -> Known:
        """Some of them."""
        return Known(self.points[which], self.targets[which], self.gradients[which])


class Approximation:
    """A model of the outputs of known designs.

    Args:
        known: the designs, two at least.
        discrete: which coordinates have no gradients.
        generator: draws its features.
        scale: by which the lengths are multiplied.
        features: of each model; None for as many as suit the dimension.
        means: what is made of the outputs [outputs x objectives]; None for the outputs themselves.
    """

    def __init__(
        self,
        known: Known,
        discrete: NDArray[np.bool_],
        generator: np.random.Generator,
        scale: float = 1.0,
        features: int | None = None,
        means: Array | None = None,
    ) -> None:
        self._means = np.eye(known.targets.shape[1]) if means is None else means
        first = known.targets[: max(FEWEST_FIRST, int(FIRST_PER_DIMENSION * known.points.shape[1]))]
        low, middle, high = (np.quantile(first, share, axis=0) for share in (0.0, 0.5, 1.0))
        tailed = (high > SPAN * low) & (high - middle > TAIL * (middle - low))
        self._logarithmic = tailed & (middle > 0.0) & (known.targets.min(axis=0) > NEAR_ZERO * middle)
        self._high = np.log(np.where(self._logarithmic, known.targets.max(axis=0), 1.0))
        self._cut = np.full(known.targets.shape[1], np.inf)
        targets, gradients = self._transformed(known)
        sizes = np.abs(gradients[:, :, ~discrete])
        for output in range(targets.shape[1]):
            found = sizes[:, output][~np.isnan(sizes[:, output])]
            if found.size:
                self._cut[output] = OUTLIER * np.quantile(found, QUANTILE)
        gradients = self._clipped(gradients)
        self._groups = _groups(gradients[:, :, ~discrete])
        self.lengths = scale * self._lengths(known.points, targets, gradients, discrete, generator)
        self._known = Known(known.points, targets, gradients)
        self._models = [
            GlobalModel(self.lengths, ~discrete, len(group), generator, features) for group in self._groups
        ]
        self._take(self._known)
        mean, deviation = self._moments()
        for group, model in zip(self._groups, self._models, strict=True):
            model.tune(mean[group], deviation[group])

    def add(self, new: Known) -> None:
        """Add designs to the model."""
        targets, gradients = self._transformed(new)
        told = Known(new.points, targets, self._clipped(gradients))
        parts = zip(
            (self._known.points, self._known.targets, self._known.gradients),
            (told.points, told.targets, told.gradients),
            strict=True,
        )
        self._known = Known(*(np.concatenate(pair) for pair in parts))
        self._take(told)

    def expected(self) -> Function:
        """The mean, with what it misses near known designs."""
        fitted = self._fitted()
        points, missed, slopes = self._known.points, self._known.targets.copy(), self._known.gradients.copy()
        for group, model in zip(self._groups, fitted, strict=True):
            missed[:, group] -= model.at(points, model.weights)
            slopes[:, group] -= model.slopes(points)
        residual = LocalResidual(points, self.lengths / self.lengths.min(), missed, slopes)
        weights = [model.weights for model in fitted]
        bounded = self._bounded(EXPECTED_BEYOND)
        return lambda places: bounded(self._together(fitted, weights, places) + residual(places))

    def drawn(self, generator: np.random.Generator) -> Function:
        """A Thompson sample: a function that may be the true one, for all that is known."""
        fitted = self._fitted()
        weights = [model.drawn(generator) for model in fitted]
        bounded = self._bounded(DRAWN_BEYOND)
        return lambda places: bounded(self._together(fitted, weights, places))

    def smooth(self) -> Function:
        """The mean of the global model alone."""
        fitted = self._fitted()
        weights = [model.weights for model in fitted]
        return lambda places: self._natural(self._together(fitted, weights, places))

    def several(self, generator: np.random.Generator, count: int) -> Function:
        """So many Thompson samples of one output at once, roughly: from points to [points x samples]."""
        (model,) = self._fitted()
        weights = np.hstack([model.drawn(generator) for _ in range(count)])

        def at(places: Array) -> Array:
            found = model.roughly_at(places, weights)
            return self._natural(found.reshape(-1, 1)).reshape(found.shape)

        return at

    def _bounded(self, beyond: float) -> Function:
        """Makes objectives of outputs, which it keeps within the range that is known, and a share beyond."""
        low, high = self._known.targets.min(axis=0), self._known.targets.max(axis=0)
        margin = beyond * np.maximum(high - low, SCALES_OF_A_RANGE * self._least_scales())
        return lambda outputs: self._natural(np.clip(outputs, low - margin, high + margin)) @ self._means

    def _fitted(self) -> list[FittedModel]:
        mean, deviation = self._moments()
        return [
            model.solved(mean[group], deviation[group])
            for group, model in zip(self._groups, self._models, strict=True)
        ]

    def _moments(self) -> tuple[Array, Array]:
        """Mean of every output, and the scale it is measured by: its standard deviation, or the least one."""
        targets = self._known.targets
        return targets.mean(axis=0), np.maximum(targets.std(axis=0) + ALMOST, self._least_scales())

    def _least_scales(self) -> Array:
        """Zero but for the parts of means."""
        parts = (self._means.max(axis=1) < 1.0) & ~self._logarithmic
        return np.where(parts, LEAST_SCALE * np.abs(self._known.targets.mean(axis=0)), 0.0)

    def _together(self, fitted: list[FittedModel], weights: list[Array], places: Array) -> Array:
        found = np.empty((len(places), len(self._logarithmic)))
        for group, model, own in zip(self._groups, fitted, weights, strict=True):
            found[:, group] = model.at(places, own)
        return found

    def _take(self, told: Known) -> None:
        for group, model in zip(self._groups, self._models, strict=True):
            model.add(told.points, told.targets[:, group], told.gradients[:, group])

    def _transformed(self, known: Known) -> tuple[Array, Array]:
        """Targets and gradients, of the logarithms where those are modelled."""
        targets, gradients = known.targets.copy(), known.gradients.copy()
        for output in np.flatnonzero(self._logarithmic):
            positive = np.maximum(targets[:, output], ALMOST)
            gradients[:, output] /= positive[:, None]
            targets[:, output] = np.log(positive)
        return targets, gradients

    def _clipped(self, gradients: Array) -> Array:
        cut = self._cut[:, None]
        return np.asarray(np.clip(gradients, -cut, cut))

    def _natural(self, outputs: Array) -> Array:
        found = outputs.copy()
        for output in np.flatnonzero(self._logarithmic):
            found[:, output] = np.exp(np.minimum(found[:, output], self._high[output] + 1.0))
        return found

    def _lengths(
        self,
        points: Array,
        targets: Array,
        gradients: Array,
        discrete: NDArray[np.bool_],
        generator: np.random.Generator,
    ) -> Array:
        deviation = targets.std(axis=0) + ALMOST
        slopes = gradients
        if np.isnan(gradients).any():
            first = GlobalModel(np.full(points.shape[1], LENGTH), ~discrete, targets.shape[1], generator)
            first.add(points, targets, gradients)
            modelled = first.solved(targets.mean(axis=0), deviation).slopes(points)
            slopes = np.where(np.isnan(gradients), modelled, gradients)
        sizes = np.sqrt(((slopes / deviation[:, None]) ** 2).mean(axis=0)).max(axis=0)
        largest = sizes.max()
        shares = sizes / largest if largest > 0.0 else np.ones_like(sizes)
        return np.asarray(LENGTH * (shares + SHARE) ** POWER)


def _groups(gradients: Array) -> list[list[int]]:
    """Outputs that share a matrix: those with gradients of most designs, and the others."""
    known = (~np.isnan(gradients).any(axis=2)).mean(axis=0)
    most = known >= 0.5 * known.max()
    found = [np.flatnonzero(which).tolist() for which in (most, ~most)]
    return [group for group in found if group]
