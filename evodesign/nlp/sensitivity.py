"""How the solution of a program moves with its parameters: exact, where it moves smoothly.

IPOPT finds the solution again with a tight tolerance; the active set is read from multipliers and slacks;
Newton's method on it reaches rounding accuracy; and the implicit function theorem gives the derivative
(`optimality`). Every active inequality must have a multiplier of the right sign and every other one must hold
(strict complementarity). Where a condition fails the derivative does not exist, and a sentence says so.

Source: Fiacco, Introduction to Sensitivity and Stability Analysis in Nonlinear Programming (1983), Theorem
3.2.2; Nocedal and Wright, Numerical Optimization, ch. 12.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from evodesign.nlp.optimality import (
    COMPLEMENTARY,
    Array,
    Change,
    Conditions,
    Derivatives,
    NotDifferentiable,
    PrimalDual,
    error,
    moved,
)
from evodesign.nlp.program import Program
from evodesign.nlp.solver import RawSolution, Solver, SolverOptions
from evodesign.records import Status

__all__ = ["Limit", "Optimum", "SolutionSensitivity"]

NEAR_TOLERANCE = 1e-10
NEWTON_STEPS = 8
EXACT = 1e-12
"""Residual of the optimality conditions, in the program's own units, of a solution that counts as exact."""


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
        columns: where each parameter lies among the columns of the derivatives.
    """

    values: Mapping[str, Array]
    slopes: Mapping[str, Array]
    cost: float
    cost_slope: Array
    limits: tuple[Limit, ...]
    columns: Mapping[str, slice]

    def along(self, parameter: str, change: Array | None = None) -> Optimum:
        """The optimum as a function of one parameter, or of what that parameter follows.

        Args:
            parameter: its name; the others stay as they are.
            change: derivative of the parameter with respect to what it follows, shape (its rows, columns).
        """
        own = self.columns[parameter]
        chain = np.eye(own.stop - own.start) if change is None else change
        return Optimum(
            values=self.values,
            slopes={name: slope[:, own] @ chain for name, slope in self.slopes.items()},
            cost=self.cost,
            cost_slope=self.cost_slope[own] @ chain,
            limits=tuple(replace(limit, slope=limit.slope[own] @ chain) for limit in self.limits),
            columns={parameter: slice(0, chain.shape[1])},
        )


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


class SolutionSensitivity:
    """A program whose solutions are found again, exactly, with their derivatives.

    Args:
        program: with smooth functions.
        options: of the solver; its tolerance becomes a tighter one.
    """

    def __init__(self, program: Program, options: SolverOptions) -> None:
        self.program = program
        self._names = _names(program)
        few = replace(options, tolerance=NEAR_TOLERANCE, near=True, compiled=False)  # too few to compile for
        self._solver = Solver(program, few)
        self._conditions = Conditions(program)

    def at(self, parameters: Mapping[str, Any], start: Mapping[str, Any]) -> Optimum | NotDifferentiable:
        """The local optimum at a solution that is known to the solver's accuracy, in SI units."""
        return self.of(parameters, self.solve(parameters, start))

    def solve(self, parameters: Mapping[str, Any], start: Mapping[str, Any]) -> RawSolution:
        """The solver's most accurate solution from one that it knows less accurately, in SI units."""
        return self._solver.solve(parameters, start)

    def of(self, parameters: Mapping[str, Any], raw: RawSolution) -> Optimum | NotDifferentiable:
        """The local optimum at a solution with multipliers."""
        if raw.status is not Status.SOLVED:
            return NotDifferentiable(f"the solution was not found again: {raw.reason}")
        given = self.program.packed_parameters(parameters)
        sides, point = self._begin(given, raw)
        for _ in range(NEWTON_STEPS):
            here = self._conditions.at(point, given)
            if error(point, here) < EXACT:
                return self._optimum(sides, point, here)
            step = moved(point, here, here.gradient[:, None], (here.rows - point.targets)[:, None])
            if isinstance(step, NotDifferentiable):
                return step
            point = replace(
                point,
                symbols=point.symbols + step.symbols[:, 0],
                multipliers=point.multipliers + step.multipliers[:, 0],
            )
        return NotDifferentiable(f"the solution could not be made exact (error {error(point, here):.1e})")

    def _begin(self, parameters: Array, raw: RawSolution) -> tuple[tuple[_Side, ...], PrimalDual]:
        """What is held at its limits, and the point with that taken literally."""
        symbols = self.program.packed(raw.values)
        rows = self._conditions.rows(symbols, parameters)
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
        point = PrimalDual(
            symbols=np.where(held[:count], targets[:count], symbols),
            multipliers=np.where(held[count:], raw.multipliers.constraints, 0.0),
            held_symbols=held[:count],
            held_rows=held[count:],
            targets=targets[count:],
        )
        return sides, point

    def _optimum(
        self, sides: tuple[_Side, ...], point: PrimalDual, here: Derivatives
    ) -> Optimum | NotDifferentiable:
        change = moved(point, here, here.gradient_slope, here.row_slope)
        if isinstance(change, NotDifferentiable):
            return change
        limits = _limits(sides, point, here, change)
        for limit in limits:
            if limit.margin < COMPLEMENTARY:
                return NotDifferentiable(f"{limit.name} is just about to reach or to leave its limit")
        return Optimum(
            values=self.program.unpacked(point.symbols),
            slopes=self.program.unpacked(np.where(change.undetermined[:, None], np.nan, change.symbols)),
            cost=here.cost,
            cost_slope=here.cost_slope,
            limits=limits,
            columns=self.program.columns,
        )


def _names(program: Program) -> tuple[str, ...]:
    """A name for every symbol, then every constraint's row."""
    blocks = [(v.name, v.symbol.numel(), v.labels) for v in program.variables]
    blocks += [(c.name, c.expression.numel(), c.labels) for c in program.constraints]
    names: list[str] = []
    for name, count, labels in blocks:
        rows = labels or [str(row) for row in range(count)]
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


def _limits(
    sides: tuple[_Side, ...], point: PrimalDual, here: Derivatives, change: Change
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
