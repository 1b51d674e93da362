"""How the solution of a program moves with its parameters: exact, where it moves smoothly.

The method that solved finds the solution again, and IPOPT with a tight tolerance where that leads to no
derivative; the active set is read from multipliers and slacks;
Newton's method on it reaches rounding accuracy; and the implicit function theorem gives the derivative
(`optimality`). Every active inequality must have a multiplier of the right sign and every other one must hold
(strict complementarity). Where a condition fails the derivative does not exist, and a sentence says so.

Beyond 300 lines: finding again, the active set and its refinement are one algorithm.

Source: Fiacco, Introduction to Sensitivity and Stability Analysis in Nonlinear Programming (1983), Theorem
3.2.2; Nocedal and Wright, Numerical Optimization, ch. 12.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, overload

import numpy as np
from numpy.typing import NDArray

from evodesign.nlp.optimality import (
    COMPLEMENTARY,
    Array,
    Change,
    Conditions,
    Derivatives,
    Mask,
    NotDifferentiable,
    PrimalDual,
    error,
    moved,
)
from evodesign.nlp.program import Program
from evodesign.nlp.solver import RawSolution, Solver, has_any
from evodesign.records import Status

Places = NDArray[np.intp]

NEAR_TOLERANCE = 1e-10
NEWTON_STEPS = 8
TOUCHING = 1e-3
"""How little may be missing to the violation of rows that are switched on, in their unit [m]."""

EXACT = 1e-12
"""Residual of the optimality conditions, in the program's own units, of a solution that counts as exact.

One that Newton's method brings no nearer is exact as well if this is its residual over the largest
multiplier: gradients are differences of terms of that size, and are rounded as these are.
"""

CLOSE = 3e-6
"""That of a solution near enough for its slopes to be good to one part in 10^6 or so."""


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
class LimitTable(Sequence[Limit]):
    """Many limits, each made when it is looked at.

    Args:
        names, active, margins: as in `Limit`, one for each.
        slopes: shape (limits, parameters).
    """

    names: tuple[str, ...]
    active: Mask
    margins: Array
    slopes: Array

    @overload
    def __getitem__(self, which: int) -> Limit: ...

    @overload
    def __getitem__(self, which: slice) -> Sequence[Limit]: ...

    def __getitem__(self, which: int | slice) -> Limit | Sequence[Limit]:
        if isinstance(which, slice):
            return [self[position] for position in range(len(self))[which]]
        return Limit(
            self.names[which], bool(self.active[which]), float(self.margins[which]), self.slopes[which]
        )

    def __len__(self) -> int:
        return len(self.names)


def no_limits(parameters: int) -> LimitTable:
    """None at all, beside so many parameters."""
    return LimitTable((), np.zeros(0, bool), np.zeros(0), np.zeros((0, parameters)))


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
    limits: LimitTable
    columns: Mapping[str, slice]

    def along(self, parameter: str) -> Optimum:
        """The optimum as a function of one parameter; the others stay as they are."""
        own = self.columns[parameter]
        return Optimum(
            values=self.values,
            slopes={name: slope[:, own] for name, slope in self.slopes.items()},
            cost=self.cost,
            cost_slope=self.cost_slope[own],
            limits=replace(self.limits, slopes=self.limits.slopes[:, own]),
            columns={parameter: slice(0, own.stop - own.start)},
        )


@dataclass(frozen=True, slots=True)
class _Sides:
    """Every inequality side on which a row of symbols or constraints lies.

    Args:
        names: of the variable or constraint, with the row in it.
        at: their places among the symbols followed by the constraints.
        signs: +1 for an upper limit, -1 for a lower one.
        limits: where they lie.
    """

    names: tuple[str, ...]
    at: Places
    signs: Array
    limits: Array


class SolutionSensitivity:
    """A program whose solutions are found again, exactly, with their derivatives.

    Args:
        solver: of a program with smooth functions; IPOPT's tolerance becomes a tighter one.
    """

    def __init__(self, solver: Solver) -> None:
        self._solver, self.program = solver, solver.program
        self._near = solver.near if solver.native else None
        self._options = replace(solver.options, tolerance=NEAR_TOLERANCE, near=True, compiled=False)
        pairs = zip(solver.program.bounds, solver.program.limits, strict=True)
        self._lower, self._upper = (np.concatenate(pair) for pair in pairs)
        self._sides = _sides(_names(solver.program), self._lower, self._upper)
        self._conditions = Conditions(solver.program)

    @cached_property
    def _ipopt(self) -> Solver:
        """Too seldom to compile for."""
        return Solver(self.program, self._options)

    def at(
        self, parameters: Mapping[str, Any], start: Mapping[str, Any], *, exact: bool = True
    ) -> Optimum | NotDifferentiable:
        """The local optimum at a solution that is known to the solver's accuracy, in SI units.

        Args:
            parameters: of the program, by name.
            start: the solution, by variable name.
            exact: whether it is made exact to rounding; otherwise slopes are good to about one part in 10^6,
                in half the time, and those of limits are nan.
        """
        switches = self.program.switches
        if switches is not None and not self.program.switched:
            start = {**start, **switches.violated(start, parameters, TOUCHING)}
            if has_any(switches.names, start):
                return self._parted.at(parameters, start, exact=exact)
        if self._near is not None:
            found = self.of(parameters, self._near.solve(parameters, start), exact=exact)
            if isinstance(found, Optimum):
                return found
        return self.of(parameters, self._ipopt.solve(parameters, start), exact=exact)

    @cached_property
    def _parted(self) -> SolutionSensitivity:
        """The same with all rows."""
        return SolutionSensitivity(self._solver.parted)

    def at_solution(
        self, parameters: Mapping[str, Any], raw: RawSolution, *, exact: bool = True
    ) -> Optimum | NotDifferentiable:
        """The same at a solution with multipliers: with these, or solved again where they are too inaccurate.

        With its own rows on the solution stays what it is: along other directions bodies that touch would
        part farther, and the posture would be another one.
        """
        found = self.of(parameters, raw, exact=exact)
        return found if isinstance(found, Optimum) else self.at(parameters, raw.values, exact=exact)

    def of(
        self, parameters: Mapping[str, Any], raw: RawSolution, *, exact: bool = True
    ) -> Optimum | NotDifferentiable:
        """The local optimum at a solution with multipliers; `exact` as in `at`."""
        switches = self.program.switches
        if switches is not None and not self.program.switched and has_any(switches.names, raw.values):
            return self._parted.of(parameters, raw, exact=exact)
        if raw.status is not Status.SOLVED:
            return NotDifferentiable(f"the solution was not found again: {raw.reason}")
        given = self.program.packed_parameters(parameters, raw.values)
        active, point, here = self._begin(given, raw)
        for _ in range(NEWTON_STEPS):
            if error(point, here) < (EXACT if exact else CLOSE):
                return self._optimum(active, point, here, exact=exact)
            step = moved(point, here, here.gradient[:, None], (here.rows - point.targets)[:, None])
            if isinstance(step, NotDifferentiable):
                return step
            point = replace(
                point,
                symbols=point.symbols + step.symbols[:, 0],
                multipliers=point.multipliers + step.multipliers[:, 0],
            )
            here = self._conditions.at(point, given)
        if error(point, here) < EXACT * np.abs(point.multipliers).max(initial=1.0):
            return self._optimum(active, point, here, exact=exact)
        return NotDifferentiable(f"the solution could not be made exact (error {error(point, here):.1e})")

    def _begin(self, parameters: Array, raw: RawSolution) -> tuple[Mask, PrimalDual, Derivatives]:
        """Which sides hold, those whose multiplier is larger than their slack, and the point with that.

        The point is as near as the solver's accuracy, so that its derivatives are those at the solution with
        residuals to first order.
        """
        symbols, rows_forces = self.program.packed(raw.values), raw.multipliers.constraints
        none = np.zeros(len(symbols) + len(rows_forces), bool)
        loose = PrimalDual(symbols, rows_forces, none[: len(symbols)], none[len(symbols) :], np.empty(0))
        here = self._conditions.at(loose, parameters)
        values = np.concatenate([symbols, here.rows])
        forces = np.concatenate([raw.multipliers.bounds, raw.multipliers.constraints])
        sides = self._sides
        slacks = sides.signs * (sides.limits - values[sides.at])
        active = np.asarray(sides.signs * forces[sides.at] > slacks)
        held = self._lower == self._upper
        targets = np.where(held, self._lower, values)
        held[sides.at[active]], targets[sides.at[active]] = True, sides.limits[active]
        count = len(symbols)
        point = PrimalDual(
            symbols=np.where(held[:count], targets[:count], symbols),
            multipliers=np.where(held[count:], raw.multipliers.constraints, 0.0),
            held_symbols=held[:count],
            held_rows=held[count:],
            targets=targets[count:],
        )
        change, force = point.symbols - symbols, point.multipliers - rows_forces
        gradient = here.gradient + here.hessian @ change + here.jacobian.T @ force
        near = replace(here, gradient=gradient, rows=here.rows + here.jacobian @ change)
        return active, point, near

    def _optimum(
        self, active: Mask, point: PrimalDual, here: Derivatives, *, exact: bool
    ) -> Optimum | NotDifferentiable:
        change = moved(point, here, here.gradient_slope, here.row_slope)
        if isinstance(change, NotDifferentiable):
            return change
        margins = _margins(self._sides, active, point, here)
        slopes = np.full((len(margins), len(here.cost_slope)), np.nan)
        if exact:
            slopes = _slopes(self._sides, active, here, change)
        limits = LimitTable(self._sides.names, active, margins, slopes)
        if len(limits) and limits.margins.min() < COMPLEMENTARY:
            name = limits.names[int(np.argmax(limits.margins < COMPLEMENTARY))]
            return NotDifferentiable(f"{name} is just about to reach or to leave its limit")
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


def _sides(names: Sequence[str], lower: Array, upper: Array) -> _Sides:
    """Every inequality; a row with one value only has none."""
    found = [
        (name, at, sign, limits[at])
        for at, name in enumerate(names)
        for sign, limits in ((-1.0, lower), (1.0, upper))
        if lower[at] != upper[at] and np.isfinite(limits[at])
    ]
    labels, places, signs, limits = zip(*found, strict=True) if found else ((), (), (), ())
    return _Sides(tuple(labels), np.array(places, dtype=np.intp), np.array(signs), np.array(limits))


def _margins(sides: _Sides, active: Mask, point: PrimalDual, here: Derivatives) -> Array:
    """Multiplier of every active inequality, slack of every other one."""
    forces = np.concatenate([-here.gradient, point.multipliers])
    values = np.concatenate([point.symbols, here.rows])
    return np.asarray(sides.signs * np.where(active, forces[sides.at], sides.limits - values[sides.at]))


def _slopes(sides: _Sides, active: Mask, here: Derivatives, change: Change) -> Array:
    """Of the margins, shape (inequalities, parameters)."""
    symbols, multipliers = change.symbols, change.multipliers
    force_slopes = np.concatenate(
        [-(here.hessian @ symbols + here.jacobian.T @ multipliers + here.gradient_slope), multipliers]
    )
    value_slopes = np.concatenate([symbols, here.jacobian @ symbols + here.row_slope])
    slopes = np.where(active[:, None], force_slopes[sides.at], -value_slopes[sides.at])
    return np.asarray(sides.signs[:, None] * slopes)
