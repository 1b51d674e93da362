"""How the solution of a program of blocks moves with the numbers that its blocks share.

At a solution with multipliers lambda of the rows g and z of the bounds, and t the distance of each inequality
from its limit, the conditions of the interior-point method, differentiated, are

    | H + sum w_i grad g_i grad g_i^T   A^T |  | dx/ds      |       | d2L/dx ds + sum w_i grad g_i dg_i/ds |
    | A                                 -D  |  | dlambda/ds |  =  - | dg_A/ds                              |

A holds the equalities (D = 0) and the inequalities with |lambda| > t (D = t / |lambda|); all others have the
weight w = |lambda| / t, bounds likewise on the diagonal. At a solve's end lambda t is its barrier parameter;
D and w are those of a barrier `SHARPER` times smaller, with the multipliers that are and the distances that
are. What is held does not move then, and what is not has next to no weight. Where neither lambda nor t is
large enough to tell which it is, there is no derivative. Derivatives by s are central differences of first
derivatives, which are exact.

Source: Waechter and Biegler 2006, Eq. 9 to 13; Fiacco 1983, ch. 2 (sensitivity).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy

from evodesign.nlp.optimality import COMPLEMENTARY, NotDifferentiable
from evodesign.nlp.program import Array

LEAST_DISTANCE = 1e-12
"""Of an inequality from its limit, in the program's own units; bounds are relaxed by 1e-8."""

SHARPER = 1e-4
"""Of the solve's barrier parameter. A limit that is missed by 3e-6 would else still be felt after a solve to
1e-12: its weight is 1e-2."""

DUAL_SHIFT = 1e-11
"""Keeps the system regular where equalities depend on each other."""

STEP = 1e-5
"""Of central differences, relative to the number that is moved where that is above 1."""

REFINEMENTS = 3
"""Of the linear system's solution."""


def solution_slopes(
    hessian: scipy.sparse.spmatrix,
    jacobian: scipy.sparse.spmatrix,
    rows: tuple[Array, Array, Array, Array],
    bounds: tuple[Array, Array, Array, Array],
    slopes: tuple[Array, Array],
) -> Array | NotDifferentiable:
    """Derivatives of the solution by the shared numbers, shape (x, s).

    Args:
        hessian: of the Lagrangian, all of it.
        jacobian: of the rows.
        rows: their values, lower and upper limits and multipliers, positive at an upper limit.
        bounds: x, its lower and upper bounds and multipliers, likewise.
        slopes: d2L/dx ds and dg/ds, shapes (x, s) and (rows, s).
    """
    _, low, high, forces = rows
    equal, distances = low == high, _distances(*rows)
    if _undecided(*rows) or _undecided(*bounds):
        return NotDifferentiable(
            "a limit of the motion is only just reached, on one side of the design alone"
        )
    free = np.flatnonzero(bounds[1] < bounds[2])
    firm = equal | (np.abs(forces) > distances)
    own = scipy.sparse.csc_matrix(jacobian)[:, free].tocsr()
    loose = scipy.sparse.diags(np.where(firm, 0.0, SHARPER * np.abs(forces) / distances)) @ own
    on_bounds = scipy.sparse.diags(_on_bounds(*(each[free] for each in bounds)))
    primal = scipy.sparse.csc_matrix(hessian)[free][:, free] + own.T @ loose + on_bounds
    held = own[np.flatnonzero(firm)]
    softness = np.where(equal, 0.0, SHARPER * distances / np.maximum(np.abs(forces), LEAST_DISTANCE))[firm]
    right = -np.vstack([slopes[0][free] + loose.T @ slopes[1], slopes[1][firm]])
    system = scipy.sparse.bmat([[primal, held.T], [held, -scipy.sparse.diags(softness)]], format="csc")
    moved = _solved(system, right, len(free))
    if isinstance(moved, NotDifferentiable):
        return moved
    found = np.zeros((len(bounds[0]), right.shape[1]))
    found[free] = moved[: len(free)]
    return found


def _solved(system: scipy.sparse.csc_matrix, right: Array, count: int) -> Array | NotDifferentiable:
    """The system's solution, refined; so many of its rows are variables, the others held rows."""
    shift = scipy.sparse.diags(np.repeat([0.0, -DUAL_SHIFT], [count, len(right) - count]))
    try:
        factors = scipy.sparse.linalg.splu(scipy.sparse.csc_matrix(system + shift))
    except RuntimeError:
        return NotDifferentiable("the motion can move at no cost")
    found = factors.solve(right)
    for _ in range(REFINEMENTS):
        found += factors.solve(right - system @ found)
    return found if np.isfinite(found).all() else NotDifferentiable("the motion can move at no cost")


def _distances(values: Array, low: Array, high: Array, forces: Array) -> Array:
    """Of each inequality from the limit that pushes."""
    return np.maximum(np.where(forces > 0.0, high - values, values - low), LEAST_DISTANCE)


def _on_bounds(values: Array, low: Array, high: Array, forces: Array) -> Array:
    """The weight of each variable."""
    distances, pushes = _distances(values, low, high, forces), np.abs(forces)
    sharper = np.where(pushes > distances, 1.0 / SHARPER, SHARPER)
    return sharper * pushes / distances


def _undecided(values: Array, low: Array, high: Array, forces: Array) -> bool:
    """Whether any inequality has neither a multiplier nor a distance that counts."""
    least = np.minimum(high - values, values - low)
    return bool(((low < high) & (np.maximum(least, np.abs(forces)) < COMPLEMENTARY)).any())


def central_differences(
    value: Callable[[Array], tuple[Array, Array]], at: Array, count: int
) -> tuple[Array, Array]:
    """Derivatives of two arrays by the first numbers of an argument, each of shape (rows, count)."""
    columns = []
    for place in range(count):
        step = STEP * max(1.0, abs(float(at[place])))
        unit = np.zeros(len(at))
        unit[place] = step
        more, less = value(at + unit), value(at - unit)
        columns.append(tuple((a - b) / (2.0 * step) for a, b in zip(more, less, strict=True)))
    first, second = zip(*columns, strict=True)
    return np.column_stack(first), np.column_stack(second)
