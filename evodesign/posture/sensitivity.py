"""How the solution of a program moves with its parameters: exact, where it moves smoothly.

At a solution the active rows A (constraints and bounds that hold with equality) satisfy

    grad f + A^T lambda = 0,      a(x, p) = limits

By the implicit function theorem x and lambda move with p as

    | H  A^T | | dx/dp      |       | d(grad L)/dp |
    | A  0   | | dlambda/dp |  =  - | da/dp        |        H = Hessian of the Lagrangian L

as long as the rows of A are independent, H is positive definite on their null space (but for directions that
change nothing), and every active row has a multiplier of the right sign (strict complementarity). The same
system, with the residuals on the right, is Newton's step, which first brings IPOPT's solution to rounding
accuracy. Where a condition fails the solution has a kink there, and a sentence says so.

Source: Fiacco, Introduction to Sensitivity and Stability Analysis in Nonlinear Programming (1983), Theorem
3.2.2; Nocedal and Wright, Numerical Optimization, ch. 12 and 18.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from evodesign.posture.program import IpoptOptions, Program, RawSolution, Solver
from evodesign.records import Status

__all__ = ["Kink", "Limit", "Optimum", "Sensitivity"]

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

NEAR_TOLERANCE = 1e-10
NEWTON_STEPS = 8
EXACT = 1e-12
"""Residual of the optimality conditions, in the program's own units, of a solution that counts as exact."""

COMPLEMENTARY = 1e-6
"""Slack or multiplier of an inequality, in the program's own units, below which both count as zero."""

SINGULAR = 1e-8
"""Singular value of the held rows, relative to the largest, that counts as zero."""

FLAT = 1e-11
"""Curvature, in the program's own units, that counts as none."""

SADDLE = 1e-5
"""Negative curvature that counts: less stems from costs of little weight, and the system stays regular."""


@dataclass(frozen=True, slots=True)
class Kink:
    """Why a solution has no derivative, in a sentence."""

    reason: str


@dataclass(frozen=True, slots=True)
class Limit:
    """An inequality at a solution.

    Args:
        name: of the variable or constraint, with the row in it.
        active: whether it holds with equality.
        margin: its multiplier when active, its slack when not, in the program's own units; positive.
        slope: derivative of the margin with respect to each parameter; at zero the active set changes.
    """

    name: str
    active: bool
    margin: float
    slope: Array


@dataclass(frozen=True, slots=True)
class Optimum:
    """A local optimum, and how it moves.

    Args:
        values: by variable name, SI units, exact to rounding.
        slopes: derivatives of the values with respect to the parameters, shape (rows, parameters); nan for a
            value that can move at no cost.
        cost: the least cost.
        cost_slope: its derivative with respect to each parameter.
        limits: every inequality.
    """

    values: Mapping[str, Array]
    slopes: Mapping[str, Array]
    cost: float
    cost_slope: Array
    limits: tuple[Limit, ...]


@dataclass(frozen=True, slots=True)
class _Side:
    """The inequality side on which a row of symbols or constraints lies.

    Args:
        name: of the variable or constraint, with the row in it.
        at: its place among the symbols followed by the constraints.
        sign: +1 for an upper limit, -1 for a lower one.
        limit: the limit.
        active: whether it is taken as an equality.
    """

    name: str
    at: int
    sign: float
    limit: float
    active: bool


@dataclass(frozen=True, slots=True)
class _Point:
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
class _Derivatives:
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
class _Change:
    """A step, one per column; `undetermined` symbols can move at no cost."""

    symbols: Array
    multipliers: Array
    undetermined: Mask


class Sensitivity:
    """A program whose solutions are found again, exactly, with their derivatives.

    Args:
        program: with smooth functions.
        options: of the solver; its tolerance becomes a tighter one.
        labels: words for the rows of variables and constraints, by name, to speak of them in kinks; rows
            without one are counted from zero.
    """

    def __init__(self, program: Program, options: IpoptOptions, labels: Mapping[str, Sequence[str]]) -> None:
        self.program = program
        self._names = _names(program, labels)
        self._solver = Solver(program, replace(options, tolerance=NEAR_TOLERANCE, near=True))
        self._function = _function(program)

    def at(self, parameters: Sequence[float], start: Mapping[str, Any]) -> Optimum | Kink:
        """The local optimum at a solution that is known to the solver's accuracy, in SI units."""
        return self.of(parameters, self.solve(parameters, start))

    def solve(self, parameters: Sequence[float], start: Mapping[str, Any]) -> RawSolution:
        """The solver's most accurate solution from one that it knows less accurately, in SI units."""
        return self._solver.solve(parameters, start)

    def of(self, parameters: Sequence[float], raw: RawSolution) -> Optimum | Kink:
        """The local optimum at a solution with multipliers."""
        if raw.status is not Status.SOLVED:
            return Kink(f"the solution was not found again: {raw.reason}")
        given = np.asarray(parameters, float)
        sides, point = self._begin(given, raw)
        for _ in range(NEWTON_STEPS):
            here = self._derivatives(point, given)
            if _error(point, here) < EXACT:
                return self._optimum(sides, point, here)
            step = _moved(point, here, here.gradient[:, None], (here.rows - point.targets)[:, None])
            if isinstance(step, Kink):
                return step
            point = replace(
                point,
                symbols=point.symbols + step.symbols[:, 0],
                multipliers=point.multipliers + step.multipliers[:, 0],
            )
        return Kink(f"the solution could not be made exact (error {_error(point, here):.1e})")

    def _begin(self, parameters: Array, raw: RawSolution) -> tuple[tuple[_Side, ...], _Point]:
        """What is held at its limits, and the point with that taken literally."""
        symbols = self.program.packed(raw.values)
        rows = np.asarray(self._function(symbols, raw.multipliers.constraints, parameters)[2]).ravel()
        lower, upper = (
            np.concatenate(pair) for pair in zip(self.program.bounds, self.program.limits, strict=True)
        )
        values = np.concatenate([symbols, rows])
        forces = np.concatenate([raw.multipliers.bounds, raw.multipliers.constraints])
        sides = _sides(self._names, values, forces, lower, upper)
        held = lower == upper
        targets = np.where(held, lower, values)
        for side in sides:
            if side.active:
                held[side.at], targets[side.at] = True, side.limit
        count = len(symbols)
        point = _Point(
            symbols=np.where(held[:count], targets[:count], symbols),
            multipliers=np.where(held[count:], raw.multipliers.constraints, 0.0),
            held_symbols=held[:count],
            held_rows=held[count:],
            targets=targets[count:],
        )
        return sides, point

    def _derivatives(self, point: _Point, parameters: Array) -> _Derivatives:
        found = [np.asarray(m) for m in self._function(point.symbols, point.multipliers, parameters)]
        cost, cost_slope, rows, row_slope, jacobian, gradient, gradient_slope, hessian = found
        return _Derivatives(
            cost=float(cost[0, 0]),
            cost_slope=cost_slope.ravel(),
            rows=rows.ravel(),
            row_slope=row_slope,
            jacobian=jacobian,
            gradient=gradient.ravel(),
            gradient_slope=gradient_slope,
            hessian=hessian,
        )

    def _optimum(self, sides: tuple[_Side, ...], point: _Point, here: _Derivatives) -> Optimum | Kink:
        change = _moved(point, here, here.gradient_slope, here.row_slope)
        if isinstance(change, Kink):
            return change
        limits = _limits(sides, point, here, change)
        weakest = min(limits, key=lambda limit: limit.margin)
        if weakest.margin < COMPLEMENTARY:
            return Kink(f"{weakest.name} is just about to reach or to leave its limit")
        return Optimum(
            values=self.program.unpacked(point.symbols),
            slopes=self.program.unpacked(np.where(change.undetermined[:, None], np.nan, change.symbols)),
            cost=here.cost,
            cost_slope=here.cost_slope,
            limits=limits,
        )


def _function(program: Program) -> Any:
    """A CasADi function of symbols, multipliers and parameters that gives the parts of `_Derivatives`."""
    x, p, rows = program.symbols, program.parameters, program.rows
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
    return ca.Function(
        "sensitivity", [x, multipliers, p], [ca.densify(part) for part in parts], {"cse": True}
    )


def _names(program: Program, labels: Mapping[str, Sequence[str]]) -> tuple[str, ...]:
    """A name for every symbol, then every constraint's row."""
    blocks = [(v.name, v.symbol.numel()) for v in program.variables]  # a constraint may have the same name
    blocks += [(c.name, c.expression.numel()) for c in program.constraints]
    names: list[str] = []
    for name, count in blocks:
        rows = labels.get(name, [str(row) for row in range(count)])
        names += [f"{name} {row}" for row in rows] if count > 1 else [name]
    return tuple(names)


def _sides(
    names: Sequence[str], values: Array, forces: Array, lower: Array, upper: Array
) -> tuple[_Side, ...]:
    """Every inequality; it is active where its multiplier is larger than its slack."""
    sides = []
    for at, name in enumerate(names):
        if lower[at] == upper[at]:
            continue
        for sign, limit in ((-1.0, lower[at]), (1.0, upper[at])):
            if np.isfinite(limit):
                active = bool(sign * forces[at] > sign * (limit - values[at]))
                sides.append(_Side(name, at, sign, float(limit), active))
    return tuple(sides)


def _error(point: _Point, here: _Derivatives) -> float:
    """Largest residual of the optimality conditions."""
    stationary = here.gradient[~point.held_symbols]
    held = (here.rows - point.targets)[point.held_rows]
    return float(np.abs(np.concatenate([stationary, held])).max())


def _moved(point: _Point, here: _Derivatives, gradients: Array, rows: Array) -> _Change | Kink:
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
    left, sizes, right = np.linalg.svd(jacobian)
    if len(sizes) < len(jacobian) or sizes.min(initial=1.0) < SINGULAR * sizes.max(initial=1.0):
        return Kink("what holds the solution holds it twice over, so that it has no unique multipliers")
    across, along = right[: len(sizes)].T, right[len(sizes) :].T
    curvatures, axes = np.linalg.eigh(along.T @ hessian @ along)
    if len(curvatures) and curvatures[0] < -SADDLE:
        return Kink(f"the solution is no minimum (curvature {curvatures[0]:.1e})")
    curved = np.abs(curvatures) > FLAT
    bent, flat = along @ axes[:, curved], along @ axes[:, ~curved]
    step = -across @ ((left.T @ rows[point.held_rows]) / sizes[:, None])
    pull = gradients[free] + hessian @ step
    if flat.size and np.abs(flat.T @ pull).max() > COMPLEMENTARY:
        return Kink("the solution is not determined")
    step = step - bent @ ((bent.T @ pull) / curvatures[curved][:, None])
    force = -left @ ((across.T @ (gradients[free] + hessian @ step)) / sizes[:, None])
    symbols, multipliers = np.zeros(gradients.shape), np.zeros(rows.shape)
    undetermined = np.zeros(len(free), bool)
    symbols[free], multipliers[point.held_rows] = step, force
    undetermined[free] = (np.abs(flat) > COMPLEMENTARY).any(axis=1)
    return _Change(symbols, multipliers, undetermined)


def _limits(
    sides: tuple[_Side, ...], point: _Point, here: _Derivatives, change: _Change
) -> tuple[Limit, ...]:
    """Margin and slope of every inequality."""
    symbols, multipliers = change.symbols, change.multipliers
    forces = np.concatenate([-here.gradient, point.multipliers])
    force_slopes = np.concatenate(
        [-(here.hessian @ symbols + here.jacobian.T @ multipliers + here.gradient_slope), multipliers]
    )
    values = np.concatenate([point.symbols, here.rows])
    value_slopes = np.concatenate([symbols, here.jacobian @ symbols + here.row_slope])
    return tuple(
        Limit(side.name, True, float(side.sign * forces[side.at]), side.sign * force_slopes[side.at])
        if side.active
        else Limit(
            side.name,
            False,
            float(side.sign * (side.limit - values[side.at])),
            -side.sign * value_slopes[side.at],
        )
        for side in sides
    )
