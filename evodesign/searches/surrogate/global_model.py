"""A global model of several outputs: Bayesian linear regression on random cosine features.

    f(u) = w0 c + w1 . c (u - 1/2) + sum_i a cos(W_i . u + b_i) w_i        w ~ N(0, 1)

With frequencies W drawn as a Matern 5/2 kernel's spectrum, the cosines are a finite stand-in for a Gaussian
process with that kernel; constant and linear terms have a wide prior. Values and gradients are rows of one
regression, gradients with less weight, for between local optima they jump. Of gradients only sums over
designs are needed,

    sum_j (d phi_a / d u_j) (d phi_b / d u_j) = s_a s_b (W W^T)_ab,     s_a = -a sin(W_a . u + b_a)

so a gradient costs hardly more than a value, whatever the dimension. Outputs are standardised when solved;
all share one matrix, so a design whose gradients are not all known gives its values alone. The height of
the cosines and the noise are 1 and 0.01, which measured best on postures' gradients; without gradients they
are those of a few under which the values are most likely (the evidence).

Source: Rahimi and Recht, Random features for large-scale kernel machines, 2007; Rasmussen and Williams,
Gaussian Processes for Machine Learning, 2006, sections 2.1, 5.4.1 (evidence) and 9.4
(derivative observations).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve, solve_triangular

Array = NDArray[np.float64]

MOST_FEATURES, FEWEST_FEATURES, FEATURES_PER_PAIR = 600, 100, 2
"""At most and at least, and for each pair of coordinates."""
SMOOTHNESS = 2.5
"""Of the Matern kernel."""

WIDE = 3.0
"""Prior standard deviation of the constant and linear terms."""

NOISES = (1e-2, 1e-3, 1e-4)
"""Variances of a standardised value beside the model."""

HEIGHTS = (1.0, 4.0, 16.0)
"""Standard deviations of the sum of cosines, standardised."""

WEIGHT_OF_GRADIENTS = 0.1


class GlobalModel:
    """Sums over designs, to which designs are added and never taken away.

    Args:
        lengths: over which outputs change, by coordinate.
        smooth: which coordinates gradients are known for.
        outputs: their number.
        generator: draws the features.
        count: of cosines; None for one that suits the dimension.
    """

    def __init__(
        self,
        lengths: Array,
        smooth: NDArray[np.bool_],
        outputs: int,
        generator: np.random.Generator,
        count: int | None = None,
    ) -> None:
        dimension = len(lengths)
        count = count or min(MOST_FEATURES, FEWEST_FEATURES + FEATURES_PER_PAIR * dimension**2)
        spread = np.sqrt(2.0 * SMOOTHNESS / generator.chisquare(2.0 * SMOOTHNESS, (count, 1)))
        self._frequencies = generator.standard_normal((count, dimension)) * spread / lengths
        self._phases = generator.uniform(0.0, 2.0 * np.pi, count)
        self._height = np.sqrt(2.0 / count)
        self._smooth = smooth.astype(float)
        along = self._frequencies * self._smooth
        self._products = along @ along.T
        size = 1 + dimension + count
        self._matrix = np.zeros((size, size))
        self._values, self._slopes = np.zeros((size, outputs)), np.zeros((size, outputs))
        self._sum, self._count = np.zeros(size), np.zeros(2)
        self._squares = np.zeros((2, outputs))
        self._choice = (HEIGHTS[0], NOISES[0])

    def features(self, points: Array) -> Array:
        """Of points [points x dimension], shape (points, features)."""
        angles = points @ self._frequencies.T + self._phases
        constant = np.full((len(points), 1), WIDE)
        return np.hstack([constant, WIDE * (points - 0.5), self._height * np.cos(angles)])

    def rough_sum(self, points: Array, weights: Array) -> Array:
        """`features(points) @ weights`, with cosines in single precision."""
        linear = 1 + points.shape[1]
        angles = (points @ self._frequencies.T + self._phases).astype(np.float32)
        wavy = np.cos(angles) @ (self._height * weights[linear:]).astype(np.float32)
        return np.asarray(WIDE * (weights[0] + (points - 0.5) @ weights[1:linear]) + wavy)

    def sines(self, points: Array) -> Array:
        """The cosines' derivatives by their angles."""
        return np.asarray(-self._height * np.sin(points @ self._frequencies.T + self._phases))

    def add(self, points: Array, targets: Array, gradients: Array) -> None:
        """Add designs.

        Args:
            points: [points x dimension].
            targets: [points x outputs].
            gradients: [points x outputs x dimension], nan where unknown.
        """
        rows = self.features(points)
        self._matrix += rows.T @ rows
        self._values += rows.T @ targets
        self._sum += rows.sum(axis=0)
        self._count[0] += len(points)
        self._squares += targets.sum(axis=0), (targets**2).sum(axis=0)
        known = ~np.isnan(gradients[:, :, self._smooth > 0.0]).any(axis=(1, 2))
        if known.any():
            self._add_gradients(points[known], np.nan_to_num(gradients[known]) * self._smooth)

    def _add_gradients(self, points: Array, gradients: Array) -> None:
        count, dimension = points.shape
        linear, wavy = slice(1, 1 + dimension), slice(1 + dimension, None)
        sines = self.sines(points)
        weight = WEIGHT_OF_GRADIENTS
        self._count[1] += count * self._smooth.sum()
        self._matrix[linear, linear] += weight * count * WIDE**2 * np.diag(self._smooth)
        cross = weight * WIDE * (self._frequencies * self._smooth).T * sines.sum(axis=0)
        self._matrix[linear, wavy] += cross
        self._matrix[wavy, linear] += cross.T
        self._matrix[wavy, wavy] += weight * (sines.T @ sines) * self._products
        self._slopes[linear] += weight * WIDE * gradients.sum(axis=0).T
        for output in range(gradients.shape[1]):
            along = gradients[:, output] @ self._frequencies.T
            self._slopes[wavy, output] += weight * (sines * along).sum(axis=0)

    def solved(self, mean: Array, deviation: Array) -> FittedModel:
        """The model for outputs of a mean and a standard deviation, one each per output."""
        heights, _, triangle, weights = self._solution(mean, deviation, *self._choice)
        return FittedModel(self, heights, weights, triangle, mean, deviation)

    def tune(self, mean: Array, deviation: Array) -> None:
        """Choose height and noise by the evidence, where there are no gradients."""
        if self._count[1]:
            return
        choices = [(height, noise) for height in HEIGHTS for noise in NOISES]
        self._choice = max(choices, key=lambda choice: self._evidence(mean, deviation, *choice))

    def _solution(
        self, mean: Array, deviation: Array, height: float, noise: float
    ) -> tuple[Array, Array, Array, Array]:
        heights = np.ones(len(self._sum))
        heights[-len(self._phases) :] = height
        right = (self._values - np.outer(self._sum, mean) + self._slopes) / deviation * heights[:, None]
        precision = self._matrix * (heights[:, None] * heights / noise)
        precision[np.diag_indices_from(precision)] += 1.0
        triangle, _ = cho_factor(precision, lower=True, overwrite_a=True, check_finite=False)
        weights = cho_solve((triangle, True), right / noise, check_finite=False)
        return heights, right, triangle, weights

    def _evidence(self, mean: Array, deviation: Array, height: float, noise: float) -> float:
        """Logarithm of the data's likelihood, up to what does not depend on height and noise."""
        _, right, triangle, weights = self._solution(mean, deviation, height, noise)
        values, squares = self._squares
        rest = (squares - 2.0 * mean * values + self._count[0] * mean**2) / deviation**2
        outputs = right.shape[1]
        spread = 2.0 * np.log(np.diag(triangle)).sum() + self._count[0] * np.log(noise)
        return float(-0.5 * ((rest.sum() - (right * weights).sum()) / noise + outputs * spread))

    def slopes(self, points: Array, weights: Array) -> Array:
        """Derivatives of outputs with given weights [points x outputs x dimension]."""
        dimension, outputs = points.shape[1], weights.shape[1]
        wavy = weights[1 + dimension :, :, None] * self._frequencies[:, None, :]
        found = (self.sines(points) @ wavy.reshape(len(wavy), -1)).reshape(len(points), outputs, dimension)
        return np.asarray(found + WIDE * weights[1 : 1 + dimension].T)


@dataclass(frozen=True, slots=True)
class FittedModel:
    """Weights, and how well they are known.

    Args:
        features: the model.
        heights: by which features are multiplied.
        weights: their mean [features x outputs], of standardised outputs.
        triangle: Cholesky factor of their precision, lower.
        mean, deviation: of the outputs.
    """

    features: GlobalModel
    heights: Array
    weights: Array
    triangle: Array
    mean: Array
    deviation: Array

    def drawn(self, generator: np.random.Generator) -> Array:
        """Weights drawn from what is known of them: a Thompson sample."""
        normal = generator.standard_normal(self.weights.shape)
        away = solve_triangular(self.triangle, normal, lower=True, trans=1, check_finite=False)
        return np.asarray(self.weights + away)

    def at(self, points: Array, weights: Array) -> Array:
        """Outputs at points [points x outputs]."""
        high = self.heights[:, None] * weights
        return np.asarray(self.features.features(points) @ high * self.deviation + self.mean)

    def roughly_at(self, points: Array, weights: Array) -> Array:
        """As `at`, with cosines in single precision: many times as fast, where a few digits will do."""
        high = self.heights[:, None] * weights
        found = self.features.rough_sum(points, high)
        return np.asarray(found * self.deviation + self.mean)

    def slopes(self, points: Array) -> Array:
        """Derivatives of the mean's outputs [points x outputs x dimension]."""
        high = self.heights[:, None] * self.weights
        return self.features.slopes(points, high) * self.deviation[:, None]
