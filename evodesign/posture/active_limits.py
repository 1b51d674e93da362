"""Which limits hold an optimum, and what each of them costs.

A case's effort is the root of its least cost C, as one number of N m: where nothing disturbs it,

    E = sqrt(C) = sqrt(w_r |tau_r|^2 + w_h |tau_h|^2 + regularisation)

and under disturbances the C of `load_cases`, of which all but a hundredth is that of the worst load case.
With a limit's value l, and the multiplier lambda of a row a(x) <= b(l) that it bounds, its price is

    dE / dl  =  dC / dl / (2 sqrt(C))  =  - lambda d(b - a) / dl / (2 sqrt(C))

summed over all rows and load cases that the value bounds, of an agent. Multipliers are those of the solve, so
that nothing is computed anew. A half of a symmetric posture has one row for a pair, and its cost counts both
sides, so its multiplier is the price of both. The design is as it is: sized actuators keep their sizes. So is
the regularisation, which takes joints relative to their ranges: that a wider range makes it less is no price.

Where more limits meet than hold the optimum, multipliers are not unique; a solver's lie between those of the
limits' either side, and the sum of what they cost together holds.

Source: Nocedal and Wright, Numerical Optimization, section 12.8 (multipliers as sensitivities).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from evodesign.nlp.buffered import BufferedFunction
from evodesign.nlp.program import ConstraintBlock, Program, Variable
from evodesign.nlp.solver import RawSolution, has_any
from evodesign.posture.terms.base import TORQUE_UNIT, Bound
from evodesign.records import ActiveLimit

Array = NDArray[np.float64]

HOLDS = 1e-5
"""Multiplier, in the program's own units, above which a limit holds: slacks end at 1e-9 over it."""

NOTICEABLE = 1e-3
"""Effort [N m] that a step of a limit (`ActiveLimit.step`) must change for it to count, of both agents and
all bodies together whose limit it is."""

Slopes = dict[tuple[str, str, str, bool], tuple[Bound, float, float]]
"""By what a user knows a limit by: a bound, its value, and the derivative of the least cost by the value."""


@dataclass(frozen=True, slots=True)
class _Side:
    """One side of a row that is bounded.

    Args:
        place: among the multipliers of symbols, followed by those of constraints.
        sign: +1 for an upper bound, -1 for a lower one.
        bound: what it is.
        scale: size of one unit of the multiplier's row, in the unit of the bound's `moves`.
    """

    place: int
    sign: float
    bound: Bound
    scale: float


class LimitSlopes:
    """How the least cost of a program moves with the limits of its terms.

    Args:
        program: assembled from terms.
    """

    def __init__(self, program: Program) -> None:
        self._program = program

    @cached_property
    def _with_all_rows(self) -> LimitSlopes:
        switches = self._program.switches
        return self if switches is None or self._program.switched else LimitSlopes(switches.program)

    @cached_property
    def _sides(self) -> tuple[_Side, ...]:
        found: list[_Side] = []
        place = 0
        for variable in self._program.variables:
            found += _sides(variable, place, variable.lower, variable.upper, variable.scale)
            place += variable.symbol.numel()
        for block in self._program.constraints:
            count = block.expression.numel()
            lower, upper = np.full(count, block.lower), np.full(count, block.upper)
            found += _sides(block, place, lower, upper, 1.0)
            place += count
        return tuple(found)

    @cached_property
    def _signs(self) -> Array:
        return np.array([side.sign for side in self._sides])

    @cached_property
    def _places(self) -> NDArray[np.intp]:
        return np.array([side.place for side in self._sides], np.intp)

    @cached_property
    def _constants(self) -> tuple[Array, Array]:
        """Values and moves of all bounds; not a number where one is an expression."""
        pairs = [(side.bound.value, side.bound.moves) for side in self._sides]
        known = [[x if isinstance(x, float | int) else np.nan for x in pair] for pair in pairs]
        values, moves = np.array(known, float).reshape(-1, 2).T
        return values, moves

    @cached_property
    def _expressions(self) -> BufferedFunction:
        """The same of symbols and parameters, expressions and all."""
        bounds = [side.bound for side in self._sides]
        columns = [[bound.value for bound in bounds], [bound.moves for bound in bounds]]
        given = [self._program.symbols, self._program.given]
        results = [ca.densify(ca.vertcat(ca.SX(0, 1), *column)) for column in columns]
        return BufferedFunction(ca.Function("bounds", given, results))

    def _numbers(
        self, holding: list[int], parameters: Mapping[str, Any], raw: RawSolution
    ) -> tuple[Array, Array]:
        """Values and moves of all bounds, as far as those that hold need them."""
        values, moves = self._constants
        if not np.isnan(values[holding] + moves[holding]).any():
            return values, moves
        given = self._program.packed_parameters(parameters, raw.values)
        values, moves = self._expressions(self._program.packed(raw.values), given)
        return values, moves

    def of(self, parameters: Mapping[str, Any], raw: RawSolution) -> Slopes:
        """The limits that hold a solution, with dC / dl in units of the program's cost.

        Args:
            parameters: of the program, by name.
            raw: the solution.
        """
        program = self._program
        switches = program.switches
        if switches is not None and not program.switched and has_any(switches.names, raw.values):
            return self._with_all_rows.of(parameters, raw)
        multipliers = np.concatenate([raw.multipliers.bounds, raw.multipliers.constraints])[self._places]
        holding = np.flatnonzero(self._signs * multipliers > HOLDS).tolist()
        values, moves = self._numbers(holding, parameters, raw)
        slopes: Slopes = {}
        for number in holding:
            side = self._sides[number]
            slope = -float(multipliers[number] * moves[number]) / side.scale
            key = side.bound.agent, side.bound.name, side.bound.part, side.bound.at_most
            before = slopes[key][2] if key in slopes else 0.0
            slopes[key] = side.bound, float(values[number]), before + slope
        return slopes


def _sides(
    block: Variable | ConstraintBlock, first: int, lower: Array, upper: Array, scale: float
) -> Iterator[_Side]:
    """The sides of a block's rows that are bounded by what its terms say; a row with one value has none."""
    for sign, limits, bounds in ((-1.0, lower, block.least), (1.0, upper, block.most)):
        for row, limit in enumerate(limits if bounds else ()):
            if np.isfinite(limit) and lower[row] != upper[row]:
                yield _Side(first + row, sign, bounds[row if len(bounds) > 1 else 0], scale)


def priced(found: Slopes, cost: float) -> tuple[ActiveLimit, ...]:
    """The limits that hold a posture, with the price of each; the most expensive first.

    Args:
        found: by limit.
        cost: the least cost, in the unit of the slopes: TORQUE_UNIT^2.
    """
    effort_slope = TORQUE_UNIT / (2.0 * math.sqrt(cost)) if cost > 0.0 else 0.0
    limits = [_limit(bound, value, effort_slope * slope) for bound, value, slope in found.values()]
    change: dict[tuple[str, str, bool], float] = {}
    for limit in limits:
        change[_shared(limit)] = change.get(_shared(limit), 0.0) + abs(limit.change_n_m)
    noticed = [limit for limit in limits if change[_shared(limit)] >= NOTICEABLE]
    return tuple(sorted(noticed, key=lambda limit: -abs(limit.change_n_m)))


def _shared(limit: ActiveLimit) -> tuple[str, str, bool]:
    """What limits have in common that one number of a problem file sets, for both agents and all bodies."""
    return limit.name, "" if limit.key else f"{limit.agent} {limit.part}", limit.at_most


def _limit(bound: Bound, value: float, price: float) -> ActiveLimit:
    return ActiveLimit(
        name=bound.name,
        value=value,
        unit=bound.unit,
        price_n_m=price,
        at_most=bound.at_most,
        agent=bound.agent,
        part=bound.part,
        key=bound.key,
    )
