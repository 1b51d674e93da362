"""Sobol' indices against closed forms, SALib and SciPy, of functions whose shares are known."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from SALib.analyze import sobol
from SALib.sample import sobol as sobol_sample

from evodesign.analysis.variance_shares import pair_shares, variance_shares
from evodesign.searches.discrete import snapped

Array = NDArray[np.float64]
A, B = 7.0, 0.1


def ishigami(points: Array) -> Array:
    """sin x + a sin^2 y + b z^4 sin x with angles from -pi to pi."""
    x, y, z = np.pi * (2.0 * points - 1.0).T
    return np.asarray(np.sin(x) + A * np.sin(y) ** 2 + B * z**4 * np.sin(x))[:, None]


def ishigami_shares() -> tuple[Array, Array, float]:
    """First order and total of each coordinate, and the pair of x and z: Ishigami and Homma 1990."""
    x = 0.5 * (1.0 + B * np.pi**4 / 5.0) ** 2
    y = A**2 / 8.0
    xz = B**2 * np.pi**8 * (1.0 / 18.0 - 1.0 / 50.0)
    whole = x + y + xz
    return np.array([x, y, 0.0]) / whole, np.array([x + xz, y, xz]) / whole, xz / whole


def test_ishigamis_shares_are_those_of_the_closed_form() -> None:
    first, total, pair = ishigami_shares()
    found = variance_shares(ishigami, (0, 0, 0), np.random.default_rng(1))
    assert found.first[:, 0] == pytest.approx(first, abs=0.01)
    assert found.total[:, 0] == pytest.approx(total, abs=0.01)
    assert found.variance[0] == pytest.approx(
        0.5 + A**2 / 8 + B * np.pi**4 / 5 + B**2 * np.pi**8 / 18, rel=0.02
    )
    pairs = [(0, 1), (0, 2), (1, 2)]
    shares = pair_shares(ishigami, (0, 0, 0), pairs, found.variance, np.random.default_rng(1))
    assert shares[:, 0] == pytest.approx([0.0, pair, 0.0], abs=0.02)


def test_sobols_product_has_its_shares() -> None:
    """A product of |4 u - 2| and a, over 1 + a: partial variance 1 / (3 (1 + a)^2) (Sobol' 1993)."""
    weights = np.array([0.0, 1.0, 4.5, 99.0])
    partial = 1.0 / (3.0 * (1.0 + weights) ** 2)
    whole = np.prod(1.0 + partial) - 1.0
    total = [partial[i] * np.prod(1.0 + np.delete(partial, i)) / whole for i in range(4)]

    def product(points: Array) -> Array:
        return np.asarray(np.prod((np.abs(4.0 * points - 2.0) + weights) / (1.0 + weights), axis=1))[:, None]

    found = variance_shares(product, (0,) * 4, np.random.default_rng(2))
    assert found.first[:, 0] == pytest.approx(partial / whole, abs=0.02)  # the edge at 1/2 costs digits
    assert found.total[:, 0] == pytest.approx(total, abs=0.02)
    pairs = [(0, 1), (0, 3)]
    shares = pair_shares(product, (0,) * 4, pairs, found.variance, np.random.default_rng(2))[:, 0]
    assert shares == pytest.approx([partial[0] * partial[1] / whole, 0.0], abs=0.01)


def test_shares_with_choices_are_those_of_salib() -> None:
    """Two continuous coordinates, one of three choices; SALib gets points that were moved to the choices."""
    counts = (0, 3, 0)

    def mixed(points: Array) -> Array:
        return np.asarray(np.exp(points[:, 0]) * (1.0 + points[:, 1] ** 2) + points[:, 2])[:, None]

    problem = {"num_vars": 3, "names": ["a", "b", "c"], "bounds": [[0.0, 1.0]] * 3}
    points = snapped(sobol_sample.sample(problem, 4096, seed=3), counts)
    wanted = sobol.analyze(problem, mixed(points)[:, 0], seed=3)
    found = variance_shares(mixed, counts, np.random.default_rng(3))
    assert found.first[:, 0] == pytest.approx(wanted["S1"], abs=0.015)
    assert found.total[:, 0] == pytest.approx(wanted["ST"], abs=0.015)
    pair = pair_shares(mixed, counts, [(0, 1)], found.variance, np.random.default_rng(3))
    assert pair[0, 0] == pytest.approx(wanted["S2"][0, 1], abs=0.01)


def test_several_functions_are_looked_at_together() -> None:
    def two(points: Array) -> Array:
        return np.hstack([ishigami(points), points[:, 1:2]])

    found = variance_shares(two, (0, 0, 0), np.random.default_rng(4))
    alone = variance_shares(ishigami, (0, 0, 0), np.random.default_rng(4))
    assert found.total[:, :1] == pytest.approx(alone.total)
    assert found.first[:, 1] == pytest.approx([0.0, 1.0, 0.0], abs=1e-6)


def test_a_constant_has_no_shares() -> None:
    found = variance_shares(lambda points: np.ones((len(points), 1)), (0, 0), np.random.default_rng(5))
    assert found.first.max() == found.total.max() == found.variance.max() == 0.0
