"""Knee points: designs of a front at which every exchange with a design near by loses more than it gains.

With objectives as shares of their ranges (`scaling`), let the bulge of a design be the distance from the
plane through the corners (1, 0, ...), (0, 1, ...), ... of the range, towards the best values:

    b = (1 - sum of the shares) / sqrt(number of objectives)

For two objectives this plane is the line through the ends of the front. Of all designs, Das calls the one of
the largest b the knee. Exchanging design i for j, the ratio of what is lost to what is gained is, after
Rachmawati and Srinivasan,

    T_ij = sum max(0, share_j - share_i) / sum max(0, share_i - share_j)

and T_ij > 1 exactly when b_i > b_j. Both measures therefore name the same designs: a knee has the largest
bulge, or a trade-off above one, among the designs of its neighbourhood.

Source: Das 1999, On characterizing the "knee" of the Pareto curve based on normal-boundary intersection;
Rachmawati and Srinivasan 2009, Multiobjective evolutionary algorithm with controllable focus on the knees of
the Pareto front. The neighbourhood makes a front with several knees show them all.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from evodesign.analysis.scaling import Matrix, scaled
from evodesign.records import Evaluation, Objective

__all__ = ["NEIGHBOURHOOD", "bulges", "knees"]

NEIGHBOURHOOD = 0.1
"""Largest difference in any objective, as a share of its range, of designs that are near each other."""


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
