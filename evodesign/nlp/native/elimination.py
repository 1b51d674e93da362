"""In which order the unknowns of a step are eliminated, and what its factors look like.

The system of a step is quasi-definite (`linear_system.c`), so that any order has a factorisation L D L'
without pivoting, but not each is accurate. Each equality's row is eliminated right after a variable that it
determines: pairs are found by linear assignment, large constant entries in sparse columns first; pairs and
single unknowns are then ordered for little fill (approximate minimum degree). That costs about a tenth more
fill than without pairs, and then the iterates are those of a factorisation that pivots.

Source: pairs: Duff and Pralet, SIAM J. Matrix Anal. Appl. 27 (2005), 313-340; factors: Davis, Direct Methods
for Sparse Linear Systems (2006), ch. 4.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

__all__ = ["Elimination", "elimination"]

Integers = NDArray[np.int32]
Pattern = NDArray[np.bool_]

NOT_AN_ENTRY = 1e3
"""Cost of a pair without an entry of the Jacobian."""

UNKNOWN_SIZE = 0.5
"""Size that an entry counts as which is not constant."""

MOST_SIZE = 2.0
"""Size beyond which a constant entry is no better."""

SPARSE = 0.01
"""What each further entry in a variable's column costs."""


@dataclass(frozen=True, slots=True)
class Elimination:
    """Order, pattern of the reordered system and of its factor; matrices are stored by columns.

    Args:
        order: which unknown comes where: variables, then rows.
        system_starts, system_rows: upper triangle of the reordered system.
        hessian_places, jacobian_places, diagonal_places: of the entries in that triangle.
        factor_starts, factor_rows: L below its diagonal, by columns.
        pattern_starts, pattern: the same by rows.
    """

    order: Integers
    system_starts: Integers
    system_rows: Integers
    hessian_places: Integers
    jacobian_places: Integers
    diagonal_places: Integers
    factor_starts: Integers
    factor_rows: Integers
    pattern_starts: Integers
    pattern: Integers


def elimination(hessian: Any, jacobian: Any, equalities: NDArray[np.bool_]) -> Elimination:
    """The elimination of a program's system.

    Args:
        hessian: of the Lagrangian, upper triangle, an expression of shape (variables, variables).
        jacobian: of the rows, an expression of shape (rows, variables).
        equalities: which rows are equalities.
    """
    variables, unknowns = hessian.size1(), hessian.size1() + jacobian.size1()
    system = np.eye(unknowns, dtype=bool)
    above = _entries(hessian)
    beside = _entries(jacobian)
    system[above] = True
    system[beside[0] + variables, beside[1]] = True
    system |= system.T
    order = _order(system, jacobian, equalities)
    reordered = np.triu(system[np.ix_(order, order)])
    factor = _factor(system[np.ix_(order, order)])
    starts, rows = _by_columns(reordered)
    where = np.full(system.shape, -1)
    where[rows, np.repeat(np.arange(unknowns), np.diff(starts))] = np.arange(len(rows))
    new = np.empty(unknowns, int)
    new[order] = np.arange(unknowns)

    def places(row: Integers, column: Integers) -> Integers:
        first, second = new[row], new[column]
        return where[np.minimum(first, second), np.maximum(first, second)].astype(np.int32)

    everyone = np.arange(unknowns, dtype=np.int32)
    return Elimination(
        order.astype(np.int32),
        starts,
        rows,
        places(*above),
        places(beside[0] + variables, beside[1]),
        places(everyone, everyone),
        *_by_columns(factor),
        *_by_columns(factor.T),
    )


def _entries(matrix: Any) -> tuple[Integers, Integers]:
    """Row and column of each entry, by columns."""
    rows, columns = matrix.sparsity().get_triplet()
    return np.asarray(rows, np.int32), np.asarray(columns, np.int32)


def _by_columns(pattern: Pattern) -> tuple[Integers, Integers]:
    """Starts of the columns, and the rows of their entries, ascending."""
    columns, rows = np.nonzero(pattern.T)
    starts = np.concatenate([[0], np.cumsum(np.bincount(columns, minlength=len(pattern)))])
    return starts.astype(np.int32), rows.astype(np.int32)


def _order(system: Pattern, jacobian: Any, equalities: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Pairs and single unknowns in an order of little fill."""
    groups = _groups(jacobian, equalities)
    members = np.zeros((len(groups), len(system)), bool)
    for place, group in enumerate(groups):
        members[place, group] = True
    counts = members.astype(float)
    compressed = counts @ system.astype(float) @ counts.T > 0
    rows, columns = np.nonzero(compressed)
    sparsity = ca.Sparsity.triplet(len(groups), len(groups), rows.tolist(), columns.tolist())
    return np.array([unknown for place in sparsity.amd() for unknown in groups[place]])


def _groups(jacobian: Any, equalities: NDArray[np.bool_]) -> list[list[int]]:
    """A variable and the row that is eliminated after it, or one unknown alone."""
    from scipy.optimize import linear_sum_assignment  # takes half a second to load

    count, variables = jacobian.shape
    rows, columns = _entries(jacobian)
    values = [jacobian.nz[k] for k in range(jacobian.nnz())]
    sizes = [min(abs(float(v)), MOST_SIZE) if v.is_constant() else UNKNOWN_SIZE for v in values]
    costs = np.full((count, variables), NOT_AN_ENTRY)
    costs[rows, columns] = SPARSE * np.bincount(columns, minlength=variables)[columns] - np.asarray(sizes)
    equal = np.flatnonzero(equalities)
    pairs = {
        int(variable): variables + int(equal[place])
        for place, variable in zip(*linear_sum_assignment(costs[equal]), strict=True)
        if costs[equal[place], variable] < NOT_AN_ENTRY
    }
    alone = set(range(variables + count)) - set(pairs) - set(pairs.values())
    return [[variable, row] for variable, row in pairs.items()] + [[unknown] for unknown in sorted(alone)]


def _factor(system: Pattern) -> Pattern:
    """Pattern of L below its diagonal: a column passes what lies below on to the first of it."""
    factor = np.tril(system, -1)
    for column in range(len(system)):
        below = np.flatnonzero(factor[:, column])
        if len(below):
            factor[below[1:], below[0]] = True
    return factor
