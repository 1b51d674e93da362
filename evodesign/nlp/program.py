"""Nonlinear programs: named variables, constraints and parameters.

A program is assembled from blocks and does not know what they mean. Variables are scaled so that a solver
sees numbers of order one; everything outside is in SI units.
"""

from __future__ import annotations

from collections.abc import Collection, Hashable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any, Protocol

import casadi as ca
import numpy as np

Array = Any
Expression = Any

Start = Mapping[str, Any]
"""Starting values by variable name; variables left out begin at the program's own."""


@dataclass(frozen=True, slots=True)
class Variable:
    """A named block of decision variables.

    Args:
        name: such as `robot.joints`.
        symbol: SX column that the solver varies; the physical value is scale * symbol.
        scale: size of one unit of the symbol, in SI units.
        lower, upper, start: bounds and starting values in SI units, one per row.
        labels: words for the rows; none: they are counted from zero.
        drawn: whether a random start draws it from between its bounds.
        key: by which those who assemble the program find it again.
        least, most: what the lower and upper bounds are to those who assemble the program: nothing, the same
            for all rows, or one each.
    """

    name: str
    symbol: Expression
    scale: float
    lower: Array
    upper: Array
    start: Array
    labels: tuple[str, ...] = ()
    drawn: bool = False
    key: Hashable = None
    least: tuple[Any, ...] = ()
    most: tuple[Any, ...] = ()

    @property
    def value(self) -> Expression:
        """The physical quantity as an expression."""
        return self.scale * self.symbol

    @classmethod
    def column(
        cls, name: str, lower: Sequence[float], upper: Sequence[float], start: Sequence[float], scale: float
    ) -> Variable:
        """A block with one row per bound; starts are moved inside the bounds."""
        low, high = np.asarray(lower, float), np.asarray(upper, float)
        inside = np.clip(np.asarray(start, float), low, high)
        return cls(name, ca.SX.sym(name, len(low)), scale, low, high, inside)


@dataclass(frozen=True, slots=True)
class ConstraintBlock:
    """A named block of constraints lower <= expression <= upper; labels, least and most as for a variable."""

    name: str
    expression: Expression
    lower: float
    upper: float
    labels: tuple[str, ...] = ()
    least: tuple[Any, ...] = ()
    most: tuple[Any, ...] = ()


class Switches(Protocol):
    """Rows that a program leaves out until a solution violates them.

    The program with all of them has the same variables, and parameters that say which of its rows are on: a
    solve takes those from its start. So most solves are spared the rows.
    """

    @property
    def names(self) -> Collection[str]:
        """Of the parameters."""
        ...

    @property
    def program(self) -> Program:
        """With all rows."""
        ...

    @property
    def off(self) -> float:
        """What a row is that is off."""
        ...

    def rows_of(self, program: Program) -> Sequence[tuple[int, int]]:
        """The rows of a program with all of them that may be off.

        Args:
            program: with all rows.
        Returns:
            Numbers of rows, and places among `given` of what is zero where they are off.
        """
        ...

    def begun(self, values: Start, given: Mapping[str, Any], alike: Start | None = None) -> Start:
        """Parameters that switch on rows, for a solve that begins at some values.

        Args:
            values: where it begins.
            given: the other parameters.
            alike: values with the same rows on; left out, all are on.
        """
        ...

    def violated(self, values: Start, given: Mapping[str, Any], short: float = 0.0) -> Start:
        """Parameters that switch on the rows that a solution violates; none where all hold.

        Args:
            values: of the solution, with the parameters that are on.
            given: the other parameters.
            short: by how much [m] a row may hold and still be switched on.
        """
        ...

    def needed(self, values: Start, multipliers: Array, price: float) -> Start:
        """Parameters that switch on no more than the rows that hold a solution.

        Args:
            values: of the solution, with the parameters that are on.
            multipliers: of the rows of the program with all rows.
            price: what a metre must cost for a row to count.
        """
        ...

    def better(self, values: Start, given: Mapping[str, Any], multipliers: Array, gain: float) -> Start:
        """Parameters with which rows that hold a solution leave it more room; none where that gains little.

        Args:
            values: of the solution, with the parameters that are on.
            given: the other parameters.
            multipliers: of the rows of the program with all rows.
            gain: the least one of its cost that counts, to first order: no more can be gained near by.
        """
        ...


@dataclass(frozen=True)
class Program:
    """Minimise a cost over variables, subject to constraints, with numbers given as parameters, by name.

    Some rows may be left out until they are violated (`switches`).
    """

    name: str
    variables: tuple[Variable, ...]
    constraints: tuple[ConstraintBlock, ...]
    cost: Expression
    parameters: Mapping[str, Expression]
    switches: Switches | None = None

    @cached_property
    def symbols(self) -> Expression:
        """Everything that the solver varies, as one column."""
        return ca.vertcat(*[variable.symbol for variable in self.variables])

    @cached_property
    def given(self) -> Expression:
        """All parameters, as one column."""
        return ca.vertcat(*self.parameters.values())

    @cached_property
    def columns(self) -> Mapping[str, slice]:
        """Where each parameter lies among the rows of `given`."""
        found, first = {}, 0
        for name, symbol in self.parameters.items():
            found[name] = slice(first, first + symbol.numel())
            first += symbol.numel()
        return found

    @cached_property
    def rows(self) -> Expression:
        """All constraints, as one column."""
        return ca.vertcat(*[constraint.expression for constraint in self.constraints])

    @cached_property
    def bounds(self) -> tuple[Array, Array]:
        """Lower and upper bounds of the symbols."""
        lower = np.concatenate([v.lower / v.scale for v in self.variables])
        return lower, np.concatenate([v.upper / v.scale for v in self.variables])

    @cached_property
    def limits(self) -> tuple[Array, Array]:
        """Lower and upper limits of the constraints' rows."""
        counts = [c.expression.numel() for c in self.constraints]
        lower = np.repeat([c.lower for c in self.constraints], counts)
        return lower, np.repeat([c.upper for c in self.constraints], counts)

    @cached_property
    def counts(self) -> Mapping[str, int]:
        """Number of rows of each variable."""
        return {variable.name: variable.symbol.numel() for variable in self.variables}

    def packed(self, values: Mapping[str, Array]) -> Array:
        """Symbols from values in SI units (variables left out: their own starting values)."""
        blocks = [values.get(variable.name, variable.start) for variable in self.variables]
        return np.concatenate(blocks, dtype=float) / self._scales

    def unpacked(self, symbols: Array) -> dict[str, Array]:
        """Values in SI units, by name, from a column of symbols or of their changes, shape (symbols, ...)."""
        return {
            v.name: v.scale * symbols[place] for v, place in zip(self.variables, self._places, strict=True)
        }

    @cached_property
    def switched(self) -> bool:
        """Whether it has all rows, and its switches among its parameters."""
        return self.switches is not None and set(self.switches.names) <= self.parameters.keys()

    def held(self, start: Start) -> dict[str, Array]:
        """The parameters that a solve takes from its start; zero where that says nothing."""
        return {name: np.asarray(start.get(name, off)) for name, off in self._off.items()}

    @cached_property
    def _off(self) -> Mapping[str, Array]:
        """The parameters of switches when all rows are off."""
        names = self.switches.names if self.switches is not None and self.switched else ()
        return {name: np.zeros(self.parameters[name].numel()) for name in names}

    @cached_property
    def _scales(self) -> Array:
        """Size of one unit of each symbol, in SI units."""
        return np.repeat([variable.scale for variable in self.variables], list(self.counts.values()))

    @cached_property
    def _given_rows(self) -> int:
        return int(self.given.numel())

    @cached_property
    def _places(self) -> tuple[slice, ...]:
        """Where each variable lies among the symbols."""
        ends = np.cumsum([0, *self.counts.values()]).tolist()
        return tuple(slice(first, last) for first, last in pairwise(ends))

    def packed_parameters(self, values: Mapping[str, Any], start: Start | None = None) -> Array:
        """The column of `given` from a number or several for each parameter.

        Args:
            values: by name.
            start: from which the parameters of switches are taken.
        Raises:
            ValueError: other parameters than the program's are given.
        """
        if self.switched:
            values = {**values, **self.held(start or {})}
        if values.keys() != self.parameters.keys():
            wanted, found = ", ".join(sorted(self.parameters)), ", ".join(sorted(values))
            raise ValueError(f"program '{self.name}' wants parameters {wanted}; found {found}")
        column = np.empty(self._given_rows)
        for name, place in self.columns.items():
            value, wanted = values[name], place.stop - place.start
            count = 1 if isinstance(value, float) else np.size(value)
            if count != wanted:
                raise ValueError(
                    f"parameter '{name}' of program '{self.name}' has {wanted} rows; found {count}"
                )
            column[place] = value
        return column
