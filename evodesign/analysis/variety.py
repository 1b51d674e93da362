"""The k most different designs: as many as asked for, with the least distance between any two large.

Designs are compared by their parameters, each as a share of its range (the genome), so that lengths and
densities weigh the same. The best choice of k would take for ever on a large front. So the two designs that
are furthest apart come first, and then again and again the one that is furthest from its nearest chosen one:
its least distance is at least half of what any choice reaches, and no fast method promises more.

Source: Ravi, Rosenkrantz and Tayi 1994, Heuristic and special case algorithms for dispersion problems
(Theorem 2, for distances that satisfy the triangle inequality).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from evodesign.analysis.decision_making import Matrix
from evodesign.records import Evaluation

__all__ = ["most_different", "spread_out"]

ROWS_AT_ONCE = 1000
"""Rows of the matrix of distances that are held at the same time."""


def most_different(designs: Sequence[Evaluation], count: int) -> tuple[Evaluation, ...]:
    """The designs that differ most in their parameters, in the order in which they are chosen.

    Args:
        designs: to choose from; equal genomes count once, so that fewer than asked for may come back.
        count: how many, at least one; one alone is the earliest design.
    """
    genomes = np.array([design.genome for design in designs])
    return tuple(designs[row] for row in spread_out(genomes, count)) if len(designs) else ()


def spread_out(points: Matrix, count: int) -> list[int]:
    """Rows of points far from each other: the two furthest apart, then always the most remote one.

    Args:
        points: (points, dimensions), at least one row.
        count: at most so many rows; copies of a chosen point are not chosen.
    """
    if count < 2 or len(points) < 2:
        return list(range(len(points)))[: max(count, 0)]
    first, second = _furthest_pair(points)
    chosen = [first]
    nearest = _distances(points[[first]], points)[0]
    following = second
    while len(chosen) < count and nearest[following] > 0.0:
        chosen.append(following)
        nearest = np.minimum(nearest, _distances(points[[following]], points)[0])
        following = int(np.argmax(nearest))
    return chosen


def _furthest_pair(points: Matrix) -> tuple[int, int]:
    """The first of the pairs of rows that are furthest apart."""
    best, pair = -1.0, (0, 0)
    for start in range(0, len(points), ROWS_AT_ONCE):
        block = _distances(points[start : start + ROWS_AT_ONCE], points)
        row, column = divmod(int(np.argmax(block)), len(points))
        if block[row, column] > best:
            best, pair = float(block[row, column]), (start + row, column)
    return pair


def _distances(some: Matrix, points: Matrix) -> Matrix:
    """Euclidean distances, (some, points); exactly zero between equal points."""
    squares = np.zeros((len(some), len(points)))
    for coordinate, coordinates in zip(some.T, points.T, strict=True):
        squares += (coordinate[:, None] - coordinates) ** 2
    distances: Matrix = np.sqrt(squares)
    return distances
