"""In which order the unknowns of a step are eliminated, and what its factors look like.

The system of a step is quasi-definite (`linear_system.c`), so that any order has a factorisation L D L'
without pivoting, but not each is accurate. Each equality's row is eliminated right after a variable that it
determines: pairs are found by linear assignment, large constant entries in sparse columns first; pairs and
single unknowns are then ordered for little fill (approximate minimum degree). That costs about a tenth more
fill than without pairs, and then the iterates are those of a factorisation that pivots. Programs of blocks
do without: there pairs double the work, and the iterates stay the same.

Source: pairs: Duff and Pralet, SIAM J. Matrix Anal. Appl. 27 (2005), 313-340; factors: Davis, Direct Methods
for Sparse Linear Systems (2006), ch. 4.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np
import scipy
from numpy.typing import NDArray

Integers = NDArray[np.int32]

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


@dataclass(frozen=True, slots=True)
class Entries:
    """Where a matrix has entries, by columns, the rows of each ascending.

    Args:
        shape: rows and columns.
        rows, columns: of each entry.
    """

    shape: tuple[int, int]
    rows: Integers
    columns: Integers

    @classmethod
    def of(cls, matrix: Any) -> Entries:
        """Of an expression (SX)."""
        rows, columns = matrix.sparsity().get_triplet()
        return cls(matrix.shape, np.asarray(rows, np.int32), np.asarray(columns, np.int32))

    @property
    def starts(self) -> Integers:
        """Of the columns among the entries."""
        return _starts(self.columns, self.shape[1])


def elimination(hessian: Entries, jacobian: Entries, pairs: Mapping[int, int]) -> Elimination:
    """The elimination of a program's system.

    Args:
        hessian: of the Lagrangian, upper triangle, shape (variables, variables).
        jacobian: of the rows, shape (rows, variables).
        pairs: rows by the variable after which they are eliminated; none: little fill is all that counts.
    """
    variables = hessian.shape[0]
    unknowns = variables + jacobian.shape[0]
    everyone = np.arange(unknowns)
    beside = jacobian.rows + variables
    ends = [(hessian.rows, hessian.columns), (beside, jacobian.columns), (everyone, everyone)]
    firsts, seconds = (np.concatenate(each).astype(np.int64) for each in zip(*ends, strict=True))
    groups = [[variable, variables + row] for variable, row in pairs.items()]
    paired = {unknown for group in groups for unknown in group}
    groups += [[unknown] for unknown in range(unknowns) if unknown not in paired]
    order = _order(firsts, seconds, groups, unknowns)
    new = np.empty(unknowns, np.int64)
    new[order] = everyone
    rows, columns = np.minimum(new[firsts], new[seconds]), np.maximum(new[firsts], new[seconds])
    keys, places = np.unique(columns * unknowns + rows, return_inverse=True)
    system_rows, system_columns = keys % unknowns, keys // unknowns
    below, across = _factor(system_rows, system_columns, unknowns)
    by_rows = np.lexsort((across, below))
    counts = np.cumsum([len(hessian.rows), len(jacobian.rows)])
    hessian_places, jacobian_places, diagonal_places = np.split(places.astype(np.int32), counts)
    return Elimination(
        order.astype(np.int32),
        _starts(system_columns, unknowns),
        system_rows.astype(np.int32),
        hessian_places,
        jacobian_places,
        diagonal_places,
        _starts(across, unknowns),
        below.astype(np.int32),
        _starts(below, unknowns),
        across[by_rows].astype(np.int32),
    )


def _starts(columns: NDArray[Any], count: int) -> Integers:
    """Of columns among the entries that lie in them."""
    return np.concatenate([[0], np.cumsum(np.bincount(columns, minlength=count))]).astype(np.int32)


def _order(
    firsts: NDArray[np.int64], seconds: NDArray[np.int64], groups: list[list[int]], unknowns: int
) -> NDArray[np.int64]:
    """Pairs and single unknowns in an order of little fill, of a system with entries at (first, second)."""
    group = np.empty(unknowns, np.int64)
    for place, members in enumerate(groups):
        group[members] = place
    one, other = group[firsts], group[seconds]
    sparsity = ca.Sparsity.triplet(
        len(groups), len(groups), np.r_[one, other].tolist(), np.r_[other, one].tolist()
    )
    return np.array([unknown for place in sparsity.amd() for unknown in groups[place]], np.int64)


def determined(jacobian: Any, equalities: NDArray[np.bool_]) -> dict[int, int]:
    """Of each variable that an equality determines, its row.

    Args:
        jacobian: of the rows, an expression (SX).
        equalities: which rows are equalities.
    """
    entries, (count, variables) = Entries.of(jacobian), jacobian.shape
    values = [jacobian.nz[k] for k in range(jacobian.nnz())]
    sizes = [min(abs(float(v)), MOST_SIZE) if v.is_constant() else UNKNOWN_SIZE for v in values]
    further = np.bincount(entries.columns, minlength=variables)[entries.columns]
    costs = np.full((count, variables), NOT_AN_ENTRY)
    costs[entries.rows, entries.columns] = SPARSE * further - np.asarray(sizes)
    equal = np.flatnonzero(equalities)
    return {
        int(variable): int(equal[place])
        for place, variable in zip(*scipy.optimize.linear_sum_assignment(costs[equal]), strict=True)
        if costs[equal[place], variable] < NOT_AN_ENTRY
    }


def _factor(
    rows: NDArray[np.int64], columns: NDArray[np.int64], unknowns: int
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Rows and columns of L below its diagonal, by columns, from the system's upper triangle.

    A column passes what lies below on to the first of it.
    """
    below: list[set[int]] = [set() for _ in range(unknowns)]
    for row, column in zip(rows.tolist(), columns.tolist(), strict=True):
        if row < column:
            below[row].add(column)
    for here in below:
        if here:
            first = min(here)
            below[first] |= here - {first}
    found = [sorted(here) for here in below]
    across = np.repeat(np.arange(unknowns), [len(here) for here in found])
    return np.array([row for here in found for row in here], np.int64), across
