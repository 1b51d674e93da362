"""The optimality conditions of a program at its active set, as a linear system.

At a solution the active rows A (constraints and bounds that hold with equality) satisfy

    grad f + A^T lambda = 0,      a(x, p) = limits

By the implicit function theorem x and lambda move with p as

    | H  A^T | | dx/dp      |       | d(grad L)/dp |
    | A  0   | | dlambda/dp |  =  - | da/dp        |        H = Hessian of the Lagrangian L

as long as the rows of A are independent and H is positive definite on their null space, but for directions
that change nothing. The same system, with the residuals on the right, is Newton's step.

Source: Nocedal and Wright, Numerical Optimization, ch. 16 (null-space method) and 18.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dtrtrs

from evodesign.nlp.buffered import BufferedFunction
from evodesign.nlp.program import Program

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Places = NDArray[np.intp]

COMPLEMENTARY = 1e-6
"""Slack or multiplier of an inequality, in the program's own units, below which both count as zero."""

SINGULAR = 1e-8
"""Diagonal entry of the held rows' triangle, relative to the largest, that counts as zero."""

FLAT = 1e-11
"""Curvature, in the program's own units, that counts as none."""

SADDLE = 1e-5
"""Negative curvature that counts: less stems from costs of little weight, and the system stays regular."""


MOST_ELIMINATED = 100
"""Symbols of a program whose common subexpressions are worth the time to find: a larger one takes a second
longer to make, and has a quarter less to do."""


@dataclass(frozen=True, slots=True)
class NotDifferentiable:
    """Why a solution has no derivative, in a sentence."""

    reason: str


@dataclass(frozen=True, slots=True)
class PrimalDual:
    """Symbols, then constraints' rows: their values and multipliers, and which of them are held at limits.

    Args:
        symbols: shape (symbols,).
        multipliers: of the constraints; zero where they are not held.
        held_symbols, held_rows: what is an equality.
        targets: where the rows are held.
    """

    symbols: Array
    multipliers: Array
    held_symbols: Mask
    held_rows: Mask
    targets: Array


@dataclass(frozen=True, slots=True)
class Derivatives:
    """A program at a point, in its own units; L is the cost plus multipliers times constraints."""

    cost: float
    cost_slope: Array  # dL/dp
    rows: Array
    row_slope: Array  # d rows / dp
    jacobian: Array  # d rows / dx
    gradient: Array  # dL/dx
    gradient_slope: Array  # d2L/dx dp
    hessian: Array  # d2L/dx2


@dataclass(frozen=True, slots=True)
class Change:
    """A step, one per column; `undetermined` symbols can move at no cost."""

    symbols: Array
    multipliers: Array
    undetermined: Mask


class Conditions:
    """A program's functions and their derivatives.

    They run on CasADi's virtual machine: as machine code they took as long, and seconds to compile.

    Args:
        program: whose they are.
    """

    def __init__(self, program: Program) -> None:
        symbolic, self._patterns = _function(program)
        self._ends = np.cumsum([len(pattern.places) for pattern in self._patterns]).tolist()
        self._function = BufferedFunction(symbolic)

    def _parts(self, symbols: Array, multipliers: Array, parameters: Array) -> list[Array]:
        """What the function gives, in numbers."""
        together = self._function(symbols, multipliers, parameters)[0]
        begins = [0, *self._ends]
        return [
            pattern.filled(together[begin:end])
            for begin, end, pattern in zip(begins, self._ends, self._patterns, strict=False)
        ]

    def at(self, point: PrimalDual, parameters: Array) -> Derivatives:
        """Everything at a point."""
        found = self._parts(point.symbols, point.multipliers, parameters)
        cost, cost_slope, rows, row_slope, jacobian, gradient, gradient_slope, hessian = found
        return Derivatives(
            cost=float(cost[0, 0]),
            cost_slope=cost_slope.ravel(),
            rows=rows.ravel(),
            row_slope=row_slope,
            jacobian=jacobian,
            gradient=gradient.ravel(),
            gradient_slope=gradient_slope,
            hessian=hessian,
        )


@dataclass(frozen=True, slots=True, eq=False)
class _Pattern:
    """Where a matrix of some shape has entries: places in it, column after column."""

    shape: tuple[int, int]
    places: Places

    def filled(self, entries: Array) -> Array:
        """The matrix with its entries."""
        found = np.zeros(self.shape[0] * self.shape[1])
        found[self.places] = entries
        return found.reshape(self.shape, order="F")


def _function(program: Program) -> tuple[Any, list[_Pattern]]:
    """A CasADi function of symbols, multipliers and parameters, and where what it gives belongs.

    It gives the entries of the parts of `Derivatives`, one after another in one column.
    """
    x, p, rows = program.symbols, program.given, program.rows
    multipliers = ca.SX.sym("multipliers", rows.numel())
    lagrangian = program.cost + ca.dot(multipliers, rows)
    hessian, gradient = ca.hessian(lagrangian, x)
    parts = [
        program.cost,
        ca.gradient(lagrangian, p),
        rows,
        ca.jacobian(rows, p),
        ca.jacobian(rows, x),
        gradient,
        ca.jacobian(gradient, p),
        hessian,
    ]
    together = ca.vertcat(*[ca.vertcat(*part.nonzeros()) for part in parts])
    small = x.numel() <= MOST_ELIMINATED
    function = ca.Function("sensitivity", [x, multipliers, p], [together], {"cse": small})
    return function, [_Pattern(part.shape, np.array(part.sparsity().find(), np.intp)) for part in parts]


def error(point: PrimalDual, here: Derivatives) -> float:
    """Largest residual of the optimality conditions."""
    stationary = here.gradient[~point.held_symbols]
    held = (here.rows - point.targets)[point.held_rows]
    return float(np.abs(np.concatenate([stationary, held])).max(initial=0.0))


def moved(point: PrimalDual, here: Derivatives, gradients: Array, rows: Array) -> Change | NotDifferentiable:
    """Changes that undo residuals of the optimality conditions, one per column.

    A step within the null space Z of the held rows is split into the eigenvectors of Z^T H Z; along those
    without curvature it is zero, for what they move has no cost.

    Args:
        point: where.
        here: derivatives there.
        gradients: residuals of the Lagrangian's gradient, shape (symbols, columns).
        rows: residuals of the constraints, shape (rows, columns).
    """
    free = ~point.held_symbols
    hessian = here.hessian[np.ix_(free, free)]
    jacobian = here.jacobian[np.ix_(point.held_rows, free)]
    turned, triangle = np.linalg.qr(jacobian.T, mode="complete")
    held = len(jacobian)
    sizes = np.abs(np.diag(triangle))
    if len(sizes) < held or sizes.min(initial=1.0) < SINGULAR * sizes.max(initial=1.0):
        return NotDifferentiable(
            "what holds the solution holds it twice over, so that it has no unique multipliers"
        )
    across, along, triangle = turned[:, :held], turned[:, held:], triangle[:held]
    curvatures, axes = np.linalg.eigh(along.T @ hessian @ along)
    if len(curvatures) and curvatures[0] < -SADDLE:
        return NotDifferentiable(f"the solution is no minimum (curvature {curvatures[0]:.1e})")
    curved = np.abs(curvatures) > FLAT
    bent, flat = along @ axes[:, curved], along @ axes[:, ~curved]
    step = -across @ _solved(triangle, rows[point.held_rows], transposed=True)
    pull = gradients[free] + hessian @ step
    if flat.size and np.abs(flat.T @ pull).max() > COMPLEMENTARY:
        return NotDifferentiable("the solution is not determined")
    step = step - bent @ ((bent.T @ pull) / curvatures[curved][:, None])
    force = -_solved(triangle, across.T @ (gradients[free] + hessian @ step))
    symbols, multipliers = np.zeros(gradients.shape), np.zeros(rows.shape)
    undetermined = np.zeros(len(free), bool)
    symbols[free], multipliers[point.held_rows] = step, force
    undetermined[free] = (np.abs(flat) > COMPLEMENTARY).any(axis=1)
    return Change(symbols, multipliers, undetermined)


def _solved(triangle: Array, right: Array, *, transposed: bool = False) -> Array:
    """R^-1 b, or R^-T b, of an upper triangle R."""
    if not len(triangle):
        return right
    solution, _ = dtrtrs(triangle, right, trans=int(transposed))
    return np.asarray(solution)
