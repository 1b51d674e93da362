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

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np
import scipy
from numpy.typing import NDArray

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

    They run on CasADi's virtual machine: as machine code they took as long, and seconds to compile. Rows that
    can be switched off have functions of their own, made when they are first on: most never are.

    Args:
        program: whose they are.
    """

    def __init__(self, program: Program) -> None:
        self._program = program
        rows, self._places = ca.SX(program.rows), dict[int, int]()
        if program.switches is not None and program.switched:
            self._places = dict(program.switches.rows_of(program))
            for row in self._places:
                rows[row] = program.switches.off
        self._multipliers = ca.SX.sym("multipliers", rows.numel())
        self._always = self._function(program.cost, rows, self._multipliers)
        self._switched: dict[int, _PartsFunction] = {}

    def at(self, point: PrimalDual, parameters: Array) -> Derivatives:
        """Everything at a point."""
        arguments = point.symbols, point.multipliers, parameters
        found = self._always(*arguments)
        for row in (row for row, place in self._places.items() if parameters[place] != 0.0):
            if row not in self._switched:
                cost = ca.SX(0.0)
                own, multiplier = self._program.rows[row], self._multipliers[row]
                self._switched[row] = self._function(cost, own, multiplier)
            for name, part in self._switched[row](*arguments).items():
                if name in OF_ROWS:
                    found[name][row] = part[0]
                else:
                    found[name] += part
        return Derivatives(
            cost=float(found["cost"][0, 0]),
            cost_slope=found["cost_slope"].ravel(),
            rows=found["rows"].ravel(),
            row_slope=found["row_slope"],
            jacobian=found["jacobian"],
            gradient=found["gradient"].ravel(),
            gradient_slope=found["gradient_slope"],
            hessian=found["hessian"],
        )

    def _function(self, cost: Any, rows: Any, multipliers: Any) -> _PartsFunction:
        """The parts of `Derivatives` of a cost and some rows with their multipliers."""
        x, p = self._program.symbols, self._program.given
        lagrangian = cost + ca.dot(multipliers, rows)
        hessian, gradient = ca.hessian(lagrangian, x)
        parts = {
            "cost": cost,
            "cost_slope": ca.gradient(lagrangian, p),
            "rows": rows,
            "row_slope": ca.jacobian(rows, p),
            "jacobian": ca.jacobian(rows, x),
            "gradient": gradient,
            "gradient_slope": ca.jacobian(gradient, p),
            "hessian": hessian,
        }
        together = ca.vertcat(*[ca.vertcat(*part.nonzeros()) for part in parts.values()])
        function = ca.Function("sensitivity", [x, self._multipliers, p], [together])
        patterns = {
            name: _Pattern(part.shape, np.array(part.sparsity().find(), np.intp))
            for name, part in parts.items()
        }
        return _PartsFunction(BufferedFunction(function), patterns)


OF_ROWS = ("rows", "row_slope", "jacobian")
"""Parts of `Derivatives` that have an entry or a row for each constraint's row; others are sums over them."""


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


@dataclass(frozen=True, slots=True, eq=False)
class _PartsFunction:
    """A function of symbols, multipliers and parameters that gives entries of matrices in one column.

    Args:
        function: gives them, one matrix after another.
        patterns: of the matrices, by name.
    """

    function: BufferedFunction
    patterns: Mapping[str, _Pattern]

    def __call__(self, symbols: Array, multipliers: Array, parameters: Array) -> dict[str, Array]:
        """The matrices, by name."""
        together, begin, found = self.function(symbols, multipliers, parameters)[0], 0, dict[str, Array]()
        for name, pattern in self.patterns.items():
            end = begin + len(pattern.places)
            found[name], begin = pattern.filled(together[begin:end]), end
        return found


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
    solution, _ = scipy.linalg.lapack.dtrtrs(triangle, right, trans=int(transposed))
    return np.asarray(solution)
