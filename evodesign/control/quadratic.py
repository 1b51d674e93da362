"""A convex quadratic program with few variables, solved by DAQP to rounding, or a sentence that says why not.

    minimise |A x - b|^2     subject to  lower <= C x <= upper

Source: Arnström, Bemporad and Axehill 2022, A dual active-set solver for embedded quadratic programming.
"""

from __future__ import annotations

from dataclasses import dataclass

import daqp
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

REASONS = {
    -1: "its limits exclude each other",
    -2: "its solver cycled",
    -3: "its cost has no minimum",
    -4: "its solver reached its iteration limit",
    -5: "its cost is not convex",
}
"""DAQP's exit flags below zero."""

FOUND = (1, 2)
"""DAQP's exit flags of a minimum, and of one in which limits gave way."""

ITERATIONS = 1000
"""Of the solver at most; programs of controllers take a few dozen."""


@dataclass(frozen=True, slots=True)
class QuadraticSolution:
    """The minimum, or why there is none.

    Args:
        x: shape (n,); what the solver had last where there is none.
        reason: empty for a minimum.
    """

    x: Array
    reason: str = ""


def least_squares(
    a: Array, b: Array, c: Array, lower: Array, upper: Array, yielding: int = 0
) -> QuadraticSolution:
    """The minimum of |A x - b|^2 within limits.

    Args:
        a: shape (r, n), of full column rank.
        b: shape (r,).
        c: shape (m, n).
        lower: shape (m,), -inf for none.
        upper: shape (m,), inf for none.
        yielding: how many of the last limits give way where they exclude each other or the others, as little
            as can be.
    """
    if not (np.isfinite(a).all() and np.isfinite(b).all() and np.isfinite(c).all()):
        return QuadraticSolution(np.zeros(a.shape[1]), "its numbers are not finite")
    sense = np.zeros(len(c), np.int32)
    sense[len(c) - yielding :] = YIELDS
    x, _, flag, _ = daqp.solve(
        a.T @ a,
        -(a.T @ b),
        c,
        np.minimum(upper, NO_LIMIT),
        np.maximum(lower, -NO_LIMIT),
        sense,
        iter_limit=ITERATIONS,
        primal_tol=1e-9,
    )
    if flag not in FOUND:
        return QuadraticSolution(np.asarray(x), REASONS.get(flag, f"its solver ended with flag {flag}"))
    return QuadraticSolution(np.asarray(x))


YIELDS = 8
"""DAQP's mark of a limit that gives way."""

NO_LIMIT = 1e30
"""What DAQP takes for infinity."""
