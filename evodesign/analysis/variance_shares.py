"""Whose variance it is: Sobol' indices of a function over the unit cube, and slices of it.

All coordinates are uniform and independent; a discrete one takes each of its choices equally often. With f_u
the part of f that a coordinate, or a pair, adds in the ANOVA decomposition, and V the variance of f,

    first order    V_i / V              what i explains alone
    total          E(var(f | all but i)) / V      what i explains alone and together with others
    pair           V_ij / V             what i and j explain together, and neither alone

Along the coordinates in question the integrals are Gauss-Legendre sums (or sums over choices), over the
others means over n points of a scrambled Sobol sequence. The mean over n points of what the others add has
a variance of its own, which is taken off:

    V_i = (n W_i - T_i) / (n - 1)        W_i: variance of the mean along i,  T_i: mean of the variance along i

and likewise for pairs, where W and T are of the interaction that double centring leaves.

Source: Sobol', Global sensitivity indices for nonlinear mathematical models, 2001; Saltelli et al., Variance
based sensitivity analysis of model output, 2010; Searle, Casella and McCulloch, Variance Components, 1992,
section 3.2 (the correction).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import qmc

from evodesign.records import middle_of
from evodesign.searches.discrete import snapped

Array = NDArray[np.float64]
Function = Callable[[Array], Array]
"""From points [points x dimension] to values [points x samples], of several functions at once."""

NODES, PAIR_NODES = 14, 8
"""Along a continuous coordinate, alone and in a pair."""

MOST_POINTS, FEWEST_POINTS, PAIR_POINTS = 512, 128, 32
"""Of the others, powers of two; and for pairs."""

ALTOGETHER = 2048
"""Points for all coordinates, roughly."""

BLOCK = 4096
"""Points at which functions are evaluated at a time."""


@dataclass(frozen=True, slots=True)
class VarianceShares:
    """Shares of the variance.

    Args:
        first: [coordinates x samples], at least 0.
        total: [coordinates x samples].
        variance: [samples].
    """

    first: Array
    total: Array
    variance: Array


def variance_shares(
    function: Function, counts: Sequence[int], generator: np.random.Generator
) -> VarianceShares:
    """First-order and total indices of every coordinate.

    Args:
        function: from points to values of samples.
        counts: of choices by coordinate, 0 for a continuous one.
        generator: scrambles the points.
    """
    points = min(MOST_POINTS, max(FEWEST_POINTS, 1 << (ALTOGETHER // len(counts)).bit_length()))
    others = _others(counts, points, generator)
    alone, total, variances = [], [], []
    for axis, count in enumerate(counts):
        nodes, weights = _nodes(count, NODES)
        values = along(function, others, axis, nodes)
        inside = _variance(values, weights, axis=1).mean(axis=0)
        outside = _variance(values.mean(axis=0), weights, axis=0)
        moments = np.einsum("nqs,q->s", values**2, weights) / points
        variances.append(moments - (np.einsum("nqs,q->s", values, weights) / points) ** 2)
        alone.append(_corrected(outside, inside, points))
        total.append(inside)
    variance = np.mean(variances, axis=0)
    scale = np.where(variance > 0.0, variance, np.inf)
    return VarianceShares(np.array(alone) / scale, np.array(total) / scale, variance)


def pair_shares(
    function: Function,
    counts: Sequence[int],
    pairs: Sequence[tuple[int, int]],
    variance: Array,
    generator: np.random.Generator,
) -> Array:
    """Shares of interactions [pairs x samples].

    Args:
        function: from points to values of samples.
        counts: of choices by coordinate, 0 for a continuous one.
        pairs: of coordinates.
        variance: of the samples.
        generator: scrambles the points.
    """
    others = _others(counts, PAIR_POINTS, generator)
    found = np.zeros((len(pairs), len(variance)))
    for place, (first, second) in enumerate(pairs):
        one, one_weights = _nodes(counts[first], PAIR_NODES)
        two, two_weights = _nodes(counts[second], PAIR_NODES)
        moved = np.repeat(others[:, None], len(one), axis=1)
        moved[:, :, first] = one
        values = along(function, moved.reshape(-1, len(counts)), second, two)
        values = values.reshape(PAIR_POINTS, len(one), len(two), -1)
        left = values - np.einsum("nqrs,q->nrs", values, one_weights)[:, None]
        left -= np.einsum("nqrs,r->nqs", left, two_weights)[:, :, None]
        inside = np.einsum("nqrs,q,r->s", left**2, one_weights, two_weights) / PAIR_POINTS
        outside = np.einsum("qrs,q,r->s", left.mean(axis=0) ** 2, one_weights, two_weights)
        found[place] = _corrected(outside, inside, PAIR_POINTS)
    return found / np.where(variance > 0.0, variance, 1.0)


def along(function: Function, points: Array, axis: int, nodes: Array) -> Array:
    """Values where a coordinate of points takes other values [points x nodes x samples]."""
    moved = np.repeat(points[:, None], len(nodes), axis=1)
    moved[:, :, axis] = nodes
    flat = moved.reshape(-1, points.shape[1])
    blocks = [function(flat[start : start + BLOCK]) for start in range(0, len(flat), BLOCK)]
    return np.concatenate(blocks).reshape(len(points), len(nodes), -1)


def _others(counts: Sequence[int], points: int, generator: np.random.Generator) -> Array:
    return snapped(qmc.Sobol(len(counts), rng=generator).random(points), counts)


def _nodes(count: int, nodes: int) -> tuple[Array, Array]:
    """Places along a coordinate, and weights that add up to one."""
    if count:
        return np.array([middle_of(choice, count) for choice in range(count)]), np.full(count, 1.0 / count)
    places, weights = np.polynomial.legendre.leggauss(nodes)
    return 0.5 * (places + 1.0), 0.5 * weights


def _variance(values: Array, weights: Array, axis: int) -> Array:
    """Weighted, along an axis."""
    rows = np.moveaxis(values, axis, -1)
    return np.asarray((rows**2) @ weights - (rows @ weights) ** 2)


def _corrected(outside: Array, inside: Array, points: int) -> Array:
    return np.maximum((points * outside - inside) / (points - 1), 0.0)
