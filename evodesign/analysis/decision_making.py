"""Deciding among the designs of a front: knees, those closest to an aspiration, the k most different.

Objectives are made comparable, each as a share of its range over the designs that are compared. A minimised
value f becomes (f - least) / (greatest - least): 0 is the best of the designs, 1 the worst. The corners are
the ideal point and, for the designs of a front, the nadir point (Miettinen 1999, Section 2.4). An objective
in which all agree becomes 0. Designs agree when they differ by less than the inner solver's tolerance leaves
open: without this, noise in the sixth figure would weigh as much as any real difference.

Knees: designs at which every exchange with a design near by loses more than it gains. Let the bulge of a
design be the distance from the plane through the corners (1, 0, ...), (0, 1, ...), ... of the range, towards
the best values:

    b = (1 - sum of the shares) / sqrt(number of objectives)

For two objectives this plane is the line through the ends of the front. Of all designs, Das calls the one of
the largest b the knee. Exchanging design i for j, the ratio of what is lost to what is gained is, after
Rachmawati and Srinivasan,

    T_ij = sum max(0, share_j - share_i) / sum max(0, share_i - share_j)

and T_ij > 1 exactly when b_i > b_j. Both measures therefore name the same designs: a knee has the largest
bulge, or a trade-off above one, among the designs of its neighbourhood, which makes a front with several
knees show them all.

Aspirations: designs in the order of an achievement function,

    s(x) = max(0, max over the named objectives of w_i (f_i(x) - z_i))  +  rho * sum over all of w_i f_i(x)

f_i are minimised values, z_i the aspirations, w_i = 1 / range over the designs. The first term is the worst
shortfall from the aspirations, and nothing for a design that meets them all. The small sum decides between
designs of equal shortfall: among those that meet every aspiration the best over all objectives comes first.
Unlike a distance, s never prefers a dominated design to one that dominates it, and never punishes a design
for being better than the aspiration.

Variety: as many designs as asked for, with the least distance between any two large. Designs are compared by
their parameters, each as a share of its range (the genome), so that lengths and densities weigh the same. The
best choice of k would take for ever on a large front. So the two designs that are furthest apart come first,
and then again and again the one that is furthest from its nearest chosen one: its least distance is at least
half of what any choice reaches, and no fast method promises more.

Source: Das 1999, On characterizing the "knee" of the Pareto curve based on normal-boundary intersection;
Rachmawati and Srinivasan 2009, Multiobjective evolutionary algorithm with controllable focus on the knees of
the Pareto front; Wierzbicki 1980, The use of reference objectives in multiobjective optimization, augmented
as in Miettinen 1999, Section 5.7. There the first term goes on below zero; here it stops, so that objectives
that nobody names count as soon as the named ones are good enough. Ravi, Rosenkrantz and Tayi 1994, Heuristic
and special case algorithms for dispersion problems (Theorem 2, for distances that satisfy the triangle
inequality).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from evodesign.analysis.front import comparable, to_minimise
from evodesign.errors import InputError, nearest_name
from evodesign.records import Evaluation, Objective

NEGLIGIBLE = 1e-4
"""Range, as a share of the largest value's size, below which an objective counts as equal."""

Matrix = NDArray[np.floating[Any]]

NEIGHBOURHOOD = 0.1
"""Largest difference in any objective, as a share of its range, of designs that are near each other."""

AUGMENTATION = 1e-3
"""rho: small, so that it only decides between designs whose worst shortfall is nearly equal."""

ROWS_AT_ONCE = 1000
"""Rows of the matrix of distances that are held at the same time."""


@dataclass(frozen=True, slots=True)
class Scaled:
    """Designs with their objectives as shares of the ranges.

    Args:
        designs: those that can be compared, in order of number.
        shares: one row per design, one column per objective, from 0 (best) to 1 (worst).
        least: best minimised value of each objective.
        extent: range of each objective; zero where all agree, or nearly.
    """

    designs: tuple[Evaluation, ...]
    shares: Matrix
    least: Matrix
    extent: Matrix

    def share(self, column: int, minimised_value: float) -> float:
        """A minimised value of an objective as a share of its range; 0 where there is no range."""
        extent = float(self.extent[column])
        return (minimised_value - float(self.least[column])) / extent if extent > 0.0 else 0.0


def scaled(objectives: Sequence[Objective], designs: Sequence[Evaluation]) -> Scaled:
    """Feasible designs with all objectives, these as shares of their ranges."""
    candidates = comparable(objectives, designs)
    points = np.array([values for _, values in candidates]).reshape(len(candidates), len(objectives))
    if not candidates:
        none = np.zeros(len(objectives))
        return Scaled((), points, none, none)
    least = points.min(axis=0)
    extent = np.ptp(points, axis=0)
    extent[extent < NEGLIGIBLE * np.abs(points).max(axis=0)] = 0.0
    shares = np.where(extent > 0.0, (points - least) / np.where(extent > 0.0, extent, 1.0), 0.0)
    return Scaled(tuple(evaluation for evaluation, _ in candidates), shares, least, extent)


def knees(
    objectives: Sequence[Objective], designs: Sequence[Evaluation], neighbourhood: float = NEIGHBOURHOOD
) -> tuple[Evaluation, ...]:
    """The knee points of a front, the largest bulge first; of equal ones the earlier number.

    Args:
        objectives: of the run.
        designs: of a front.
        neighbourhood: how near designs must be to be compared; 1 leaves the one knee of the whole front.
    """
    front = scaled(objectives, designs)
    order = np.argsort(-bulges(front.shares), kind="stable")
    leading = _leading(front.shares[order], neighbourhood)
    return tuple(front.designs[row] for row in order[leading].tolist())


def bulges(shares: Matrix) -> Matrix:
    """Distance b of each design from the plane through the corners of the range.

    Args:
        shares: (designs, objectives), from 0 (best) to 1 (worst).
    Returns:
        (designs,); negative beyond the plane, on the side of the worst values.
    """
    distance: Matrix = (1.0 - shares.sum(axis=1)) / np.sqrt(shares.shape[1])
    return distance


def _leading(ranked: Matrix, neighbourhood: float) -> list[int]:
    """Rows, ranked from the first to the last, without an earlier row in their neighbourhood."""
    leading = np.arange(len(ranked))
    for row, shares in enumerate(ranked):
        near = np.abs(ranked[leading] - shares).max(axis=1) <= neighbourhood
        leading = leading[~near | (leading <= row)]
    return [int(row) for row in leading]


def closest(
    objectives: Sequence[Objective], designs: Sequence[Evaluation], aspiration: Mapping[str, float]
) -> tuple[Evaluation, ...]:
    """All designs, those closest to an aspiration first; of equal ones the earlier number.

    Args:
        objectives: of the run.
        designs: of a front.
        aspiration: natural values hoped for, of one objective or more.
    Raises:
        InputError: the aspiration is empty or names something that is no objective.
    """
    _check(objectives, aspiration, "aspiration")
    front = scaled(objectives, designs)
    hoped = {
        column: front.share(column, to_minimise(objective, aspiration[objective.name]))
        for column, objective in enumerate(objectives)
        if objective.name in aspiration
    }
    order = np.argsort(achievements(front.shares, hoped), kind="stable")
    return tuple(front.designs[row] for row in order.tolist())


def achievements(shares: Matrix, hoped: Mapping[int, float]) -> Matrix:
    """The achievement s of each design, (designs,); less is better.

    Args:
        shares: (designs, objectives), from 0 (best) to 1 (worst).
        hoped: aspiration by column, as a share; below 0 is better than every design.
    """
    shortfall = shares[:, list(hoped)] - np.array(list(hoped.values()))
    value: Matrix = np.maximum(shortfall.max(axis=1), 0.0) + AUGMENTATION * shares.sum(axis=1)
    return value


def aspiration_of(objectives: Sequence[Objective], text: str, source: str) -> dict[str, float]:
    """The aspiration that a user wrote, such as `robot_torque=8, reach_height=1.5`.

    Args:
        objectives: of the run.
        text: as it was written.
        source: where, for messages.
    Raises:
        InputError: it is no such list, or names something that is no objective.
    """
    aspiration: dict[str, float] = {}
    for part in text.split(","):
        name, _, value = (piece.strip() for piece in part.partition("="))
        try:
            aspiration[name] = msgspec.convert(value, float, strict=False)
        except msgspec.ValidationError:
            raise InputError(source, "", "NAME=NUMBER, NAME=NUMBER, ...", f"'{part}'") from None
    _check(objectives, aspiration, source)
    return aspiration


def _check(objectives: Sequence[Objective], aspiration: Mapping[str, float], source: str) -> None:
    names = [objective.name for objective in objectives]
    if not aspiration:
        raise InputError(source, "", f"values of some of {', '.join(names)}", "none")
    for name, value in aspiration.items():
        if name not in names:
            found = f"'{name}'{nearest_name(name, names)}"
            raise InputError(source, "", f"objectives among {', '.join(names)}", found)
        if not np.isfinite(value):
            raise InputError(source, name, "a finite number", f"{value}")


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
