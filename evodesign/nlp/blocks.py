"""Blocks of which programs are made that repeat, such as the knots of a motion, and their derivatives.

    minimise    sum_k f(y_k, p_k, s)        subject to  lower <= g(y_k, p_k, s) <= upper,    y = A x

Each repetition k of a block sees a linear image y_k of the variables x, numbers p_k of its own and numbers s
that all share. First and second derivatives of f and g are worked out once per block, with respect to y; the
chain rule through A is a product of sparse matrices:

    dg/dx = blockdiag(dg/dy) A        d2L/dx2 = A^T blockdiag(d2L/dy2) A

So the machine code is that of one block, whatever the number of repetitions, and the splines of a motion do
not blow up its second derivatives.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from evodesign.nlp.program import Array, Expression


@dataclass(frozen=True)
class Block:
    """What one repetition says; all expressions are SX.

    Args:
        name: of its functions.
        symbols: y, a column.
        own: p, the numbers that each repetition has for itself, a column.
        shared: s, a column.
        cost: f.
        rows: g, a column.
        lower, upper: limits of the rows.
    """

    name: str
    symbols: Expression
    own: Expression
    shared: Expression
    cost: Expression
    rows: Expression
    lower: Array
    upper: Array

    @property
    def arguments(self) -> list[Expression]:
        """Of all functions."""
        return [self.symbols, self.own, self.shared]

    @cached_property
    def multipliers(self) -> Expression:
        """Of the rows."""
        return ca.SX.sym("multipliers", self.rows.numel())

    @property
    def values(self) -> list[Expression]:
        """Cost and rows."""
        return [ca.densify(self.cost), ca.densify(self.rows)]

    @cached_property
    def first(self) -> list[Expression]:
        """Cost, its gradient, rows and their Jacobian."""
        gradient = ca.densify(ca.gradient(self.cost, self.symbols))
        return [self.values[0], gradient, self.values[1], ca.jacobian(self.rows, self.symbols)]

    def hessian(self, factor: Expression) -> Expression:
        """Upper triangle of the Hessian of factor * cost + multipliers * rows."""
        lagrangian = factor * self.cost + ca.dot(self.multipliers, self.rows)
        return ca.triu(ca.hessian(lagrangian, self.symbols)[0])

    @cached_property
    def slopes(self) -> Any:
        """Derivatives of the Lagrangian by symbols and by shared, of the arguments and the multipliers."""
        lagrangian = self.cost + ca.dot(self.multipliers, self.rows)
        slopes = [ca.densify(ca.gradient(lagrangian, each)) for each in (self.symbols, self.shared)]
        return ca.Function(f"{self.name}_slopes", [*self.arguments, self.multipliers], slopes, {"cse": True})


@dataclass(frozen=True, slots=True)
class Repeated:
    """A block and what its repetitions see.

    Args:
        block: said every time.
        image: A, shape (times * y, x), one repetition after the other; sparse.
        times: number of repetitions.
    """

    block: Block
    image: Any
    times: int

    @property
    def rows(self) -> int:
        """Number of rows of all repetitions."""
        return self.times * int(self.block.rows.numel())

    def slopes(self, symbols: Array, own: Array, shared: Array, multipliers: Array) -> tuple[Array, Array]:
        """Derivatives of the Lagrangian by x and by s.

        Args:
            symbols: x.
            own: p, shape (times, p).
            shared: s.
            multipliers: of the rows, one repetition after the other.
        """
        seen = (self.image @ symbols).reshape(self.times, -1)
        weights = np.reshape(multipliers, (self.times, -1))
        found = self.block.slopes(seen.T, np.reshape(own, (self.times, -1)).T, shared, weights.T)
        by_seen, by_shared = (np.asarray(each) for each in found)
        return self.image.T @ by_seen.T.ravel(), by_shared.sum(axis=1)


def stacked_limits(parts: Sequence[Repeated]) -> tuple[Array, Array]:
    """Lower and upper limits of all rows."""
    lower = [np.tile(part.block.lower, part.times) for part in parts]
    return np.concatenate(lower), np.concatenate([np.tile(part.block.upper, part.times) for part in parts])
