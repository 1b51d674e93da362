"""Where the derivatives of repeated blocks are added among those of their program.

Of y = A x, an entry of a block's Jacobian, of row r and symbol c, goes to row r and to every variable that c
sees; one of its Hessian, of symbols a and b, to every pair of variables that a and b see:

    dg/dx += e_r (dg_r/dy_c) A_c
    d2L/dx2 += A_a^T (d2L/dy_a dy_b) A_b + A_b^T (d2L/dy_a dy_b) A_a        (a < b)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from evodesign.nlp.native.elimination import Entries
from evodesign.nlp.program import Array

Integers = NDArray[np.int64]
Places = tuple[Integers, Integers]


@dataclass(frozen=True, slots=True, eq=False)
class Scatter:
    """Where each entry of a block, one repetition after the other, is added, and with which weight.

    Args:
        starts: of each entry among the places.
        places: of entries of the program's matrix.
        weights: one per place.
    """

    starts: Integers
    places: Integers
    weights: Array


@dataclass(frozen=True, slots=True, eq=False)
class Targets:
    """The same by rows and columns.

    Args:
        sources: number of entries of all repetitions.
        source: which of them, ascending.
        rows, columns: of the program's matrix.
        weights: of the entry there.
    """

    sources: int
    source: Integers
    rows: Integers
    columns: Integers
    weights: Array


def jacobian_targets(entries: Places, image: Any, *, times: int, rows: int, first: int) -> Targets:
    """Of a block's Jacobian.

    Args:
        entries: rows and symbols of its entries.
        image: A by rows (CSR), shape (times * symbols, variables).
        times: number of repetitions.
        rows: of one repetition.
        first: row of the program that is the first repetition's first.
    """
    own, symbols = _repeated(entries[0], times, rows), _repeated(entries[1], times, image.shape[0] // times)
    source, places = _expanded(image.indptr, symbols)
    return Targets(len(symbols), source, first + own[source], image.indices[places], image.data[places])


def hessian_targets(entries: Places, image: Any, *, times: int) -> Targets:
    """Of the upper triangle of a block's Hessian; arguments as for `jacobian_targets`."""
    firsts, seconds = (_repeated(each, times, image.shape[0] // times) for each in entries)
    outer, one = _expanded(image.indptr, firsts)
    inner, other = _expanded(image.indptr, seconds[outer])
    source, one = outer[inner], one[inner]
    rows, columns = image.indices[one], image.indices[other]
    twice = (firsts != seconds)[source]
    weights = image.data[one] * image.data[other] * np.where(twice & (rows == columns), 2.0, 1.0)
    kept = twice | (rows <= columns)
    low, high = np.minimum(rows, columns), np.maximum(rows, columns)
    return Targets(len(firsts), source[kept], low[kept], high[kept], weights[kept])


def scattered(targets: Sequence[Targets], shape: tuple[int, int]) -> tuple[Entries, list[Scatter]]:
    """The entries of the program's matrix, and where those of each block go among them."""
    keys = np.concatenate([each.columns.astype(np.int64) * shape[0] + each.rows for each in targets])
    distinct, places = np.unique(keys, return_inverse=True)
    rows, columns = (distinct % shape[0]).astype(np.int32), (distinct // shape[0]).astype(np.int32)
    ends = np.cumsum([len(each.source) for each in targets])[:-1]
    tables = [
        Scatter(np.searchsorted(each.source, np.arange(each.sources + 1)), where, each.weights)
        for each, where in zip(targets, np.split(places, ends), strict=True)
    ]
    return Entries(shape, rows, columns), tables


def _repeated(places: Integers, times: int, stride: int) -> Integers:
    """Places in every repetition."""
    return np.asarray((places + stride * np.arange(times)[:, None]).ravel(), np.int64)


def _expanded(starts: Integers, rows: Integers) -> Places:
    """For every entry of some rows of a matrix stored by rows: whose it is, counted, and its place."""
    counts = (starts[rows + 1] - starts[rows]).astype(np.int64)
    owner = np.repeat(np.arange(len(rows)), counts)
    within = np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts)
    return owner, starts[rows][owner] + within
