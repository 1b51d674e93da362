"""Designs spread evenly over all that a design space allows.

Source: Halton 1960; digits permuted at random: Owen, A randomized Halton algorithm in R, 2017, algorithm 1.
scipy.stats has the same points, and takes longer to load than commands take to build a problem.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

DIGITS = 54
"""Binary digits that are told apart near 1."""


def spread_designs(
    dimension: int,
    values: Callable[[tuple[float, ...]], tuple[float, ...]],
    keep: Callable[[tuple[float, ...]], bool],
    most: int,
) -> Iterator[tuple[float, ...]]:
    """Designs spread evenly over the unit cube: those that are to be kept among the first `most`.

    Args:
        dimension: of the cube.
        values: the design at a point of the cube.
        keep: which designs to give.
        most: how many to look at.
    """
    points = spread_points(dimension, most).tolist()
    return (design for design in (values(tuple(point)) for point in points) if keep(design))


def spread_points(dimension: int, count: int) -> NDArray[np.float64]:
    """The first points of a scrambled Halton sequence in the unit cube, always the same ones.

    Args:
        dimension: of the cube.
        count: of points.

    Returns:
        Points, shape (count, dimension).
    """
    (rng,), points = np.random.default_rng(0).spawn(1), np.zeros((count, dimension))
    for column, base in zip(points.T, _primes(), strict=False):
        rest, unit = np.arange(count), 1.0
        for _ in range(math.ceil(DIGITS / math.log2(base)) - 1):
            unit /= base
            column += unit * rng.permutation(base)[rest % base]
            rest //= base
    return points


def _primes() -> Iterator[int]:
    """All of them, in their order."""
    found: list[int] = []
    number = 2
    while True:
        if all(number % prime for prime in found):
            found.append(number)
            yield number
        number += 1
