"""Programs made of blocks that repeat, such as the knots of a motion, with derivatives block by block.

    minimise    sum_k f(y_k, p_k, s)        subject to  lower <= g(y_k, p_k, s) <= upper,    y = A x

Each repetition k of a block sees a linear image y_k of the variables x, numbers p_k of its own and numbers s
that all share. First and second derivatives of f and g are worked out once per block, with respect to y; the
chain rule through A is a product of sparse matrices:

    dg/dx = blockdiag(dg/dy) A        d2L/dx2 = A^T blockdiag(d2L/dy2) A

So the machine code is that of one block, whatever the number of repetitions, and the splines of a motion do
not blow up its second derivatives.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from evodesign.nlp.codegen import compiled_function
from evodesign.nlp.ipopt import casadi_options
from evodesign.nlp.method import Ending, SolverOptions
from evodesign.nlp.program import Array, Expression

__all__ = ["Block", "BlockDerivatives", "Repeated", "RepeatedProgram"]


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
        compiled: whether its derivatives run as machine code.
    """

    name: str
    symbols: Expression
    own: Expression
    shared: Expression
    cost: Expression
    rows: Expression
    lower: Array
    upper: Array
    compiled: bool = False

    @cached_property
    def derivatives(self) -> BlockDerivatives:
        """Made once, for any number of repetitions."""
        return BlockDerivatives(self)

    @property
    def arguments(self) -> list[Expression]:
        """Of all functions."""
        return [self.symbols, self.own, self.shared]


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


class RepeatedProgram:
    """A program of repeated blocks, ready to be solved by IPOPT.

    Args:
        name: of the program.
        parts: blocks with what they see; all of the same variables and the same shared numbers.
        options: of the solver.
    """

    def __init__(self, name: str, parts: Sequence[Repeated], options: SolverOptions) -> None:
        self._name, self._parts, self._options = name, tuple(parts), options
        counts = [part.times * part.block.rows.numel() for part in parts]
        self.rows = sum(counts)
        self.variables = int(parts[0].image.shape[1])
        least = np.concatenate([np.tile(part.block.lower, part.times) for part in parts])
        self._limits = least, np.concatenate([np.tile(part.block.upper, part.times) for part in parts])
        self._counts = counts

    def solve(
        self, start: Array, bounds: tuple[Array, Array], shared: Array, own: Sequence[Array]
    ) -> tuple[Ending, float]:
        """Solve from a start.

        Args:
            start: x.
            bounds: lower and upper bounds of x.
            shared: s.
            own: p of each block, shape (times, p).
        Returns:
            The end of the solve, whose `cost_slope` is the derivative of the optimal cost with respect to s,
            and its wall time [s].
        """
        began = time.perf_counter()
        parameters = np.concatenate([shared, *[np.ravel(each) for each in own]])
        (low, high), (least, most) = bounds, self._limits
        result = self._solver(x0=start, p=parameters, lbx=low, ubx=high, lbg=least, ubg=most)
        stats = self._solver.stats()
        rows = np.asarray(result["lam_g"]).ravel()
        ending = Ending(
            symbols=np.asarray(result["x"]).ravel(),
            cost=float(result["f"]),
            word=str(stats["return_status"]),
            iterations=int(stats["iter_count"]),
            bounds=np.asarray(result["lam_x"]).ravel(),
            rows=rows,
            cost_slope=np.asarray(self._slope(result["x"], parameters, rows)).ravel(),
        )
        return ending, time.perf_counter() - began

    @cached_property
    def functions(self) -> Mapping[str, Any]:
        """Cost and rows, their first derivatives, and the Hessian of the Lagrangian, as `nlpsol` wants them.

        Beside them the Lagrangian's derivative with respect to the shared numbers.
        """
        shared_size = self._parts[0].block.shared.numel()
        sizes = [part.times * part.block.own.numel() for part in self._parts]
        x, p = ca.MX.sym("x", self.variables), ca.MX.sym("p", shared_size + sum(sizes))
        factor, multipliers = ca.MX.sym("lam_f"), ca.MX.sym("lam_g", self.rows)
        shared, *owns = ca.vertsplit(p, np.cumsum([0, shared_size, *sizes]).tolist())
        per_block = ca.vertsplit(multipliers, np.cumsum([0, *self._counts]).tolist())
        cost: Expression = 0.0
        gradient: Expression = 0.0
        hessian: Expression = 0.0
        slope: Expression = 0.0
        rows, jacobians = [], []
        for part, own, multiplier in zip(self._parts, owns, per_block, strict=True):
            image, block, times = ca.MX(ca.DM(part.image)), part.block, part.times
            made = block.derivatives
            seen = ca.reshape(image @ x, block.symbols.numel(), times)
            mine = ca.reshape(own, block.own.numel(), times)
            weights = ca.reshape(multiplier, block.rows.numel(), times)
            value, cost_slope, found, entries = made.first.map(made.first.name(), "serial", times, [2], [])(
                seen, mine, shared
            )
            cost += ca.sum2(value)
            gradient += image.T @ ca.vec(cost_slope)
            rows.append(ca.vec(found))
            jacobians.append(_diagonal(made.jacobian, entries, times) @ image)
            second = made.second.map(made.second.name(), "serial", times, [2, 3], [])
            curved = second(seen, mine, shared, factor, weights)
            hessian += image.T @ (_diagonal(made.hessian, curved[made.order, :], times) @ image)
            sloped = made.slope.map(made.slope.name(), "serial", times, [2], [])
            slope += ca.sum2(sloped(seen, mine, shared, weights))
        g, jacobian = ca.vertcat(*rows), ca.vertcat(*jacobians)
        return {
            "nlp": ca.Function("nlp", [x, p], [cost, g], ["x", "p"], ["f", "g"]),
            "grad_f": ca.Function(
                "nlp_grad_f", [x, p], [cost, ca.densify(gradient)], ["x", "p"], ["f", "grad_f_x"]
            ),
            "jac_g": ca.Function("nlp_jac_g", [x, p], [g, jacobian], ["x", "p"], ["g", "jac_g_x"]),
            "hess_lag": ca.Function(
                "nlp_hess_l",
                [x, p, factor, multipliers],
                [ca.triu(hessian)],
                ["x", "p", "lam_f", "lam_g"],
                ["triu_hess_gamma_x_x"],
            ),
            "slope": ca.Function("slope", [x, p, multipliers], [slope]),
        }

    @property
    def _slope(self) -> Any:
        return self.functions["slope"]

    @cached_property
    def _solver(self) -> Any:
        functions = self.functions
        options = {
            **casadi_options(self._options),
            "no_nlp_grad": True,
            "calc_lam_p": False,
            **{name: functions[name] for name in ("grad_f", "jac_g", "hess_lag")},
        }
        return ca.nlpsol(self._name, "ipopt", functions["nlp"], options)


class BlockDerivatives:
    """A block's derivatives.

    Attributes:
        first: cost, its gradient, rows and the entries of their Jacobian.
        second: entries of the upper triangle of the Lagrangian's Hessian.
        slope: the Lagrangian's derivative with respect to the shared numbers.
        jacobian, hessian: patterns; the Hessian's is of all of it.
        order: which entry of the triangle each entry of the Hessian is.
    """

    def __init__(self, block: Block) -> None:
        factor, weights = ca.SX.sym("lam_f"), ca.SX.sym("lam_g", block.rows.numel())
        jacobian = ca.jacobian(block.rows, block.symbols)
        lagrangian = factor * block.cost + ca.dot(weights, block.rows)
        triangle = ca.triu(ca.hessian(lagrangian, block.symbols)[0])
        self.jacobian = jacobian.sparsity()
        places = ca.triu2symm(ca.DM(triangle.sparsity(), np.arange(1.0, triangle.nnz() + 1.0)))
        self.hessian, self.order = places.sparsity(), [int(place) - 1 for place in places.nonzeros()]
        gradient = ca.densify(ca.gradient(block.cost, block.symbols))
        firsts = [ca.SX(block.cost), gradient, ca.densify(block.rows), _entries(jacobian)]
        made = compiled_function if block.compiled else (lambda function: function)
        once = {"cse": True}
        self.first = made(ca.Function(f"{block.name}_first", block.arguments, firsts, once))
        self.second = made(
            ca.Function(
                f"{block.name}_second", [*block.arguments, factor, weights], [_entries(triangle)], once
            )
        )
        whole = block.cost + ca.dot(weights, block.rows)
        slope = ca.densify(ca.gradient(whole, block.shared))
        self.slope = ca.Function(f"{block.name}_slope", [*block.arguments, weights], [slope], once)


def _entries(matrix: Expression) -> Expression:
    return ca.vertcat(*matrix.nonzeros()) if matrix.nnz() else ca.SX(0, 1)


def _diagonal(pattern: Any, entries: Expression, times: int) -> Expression:
    """The block-diagonal matrix of blocks of one pattern, from their entries, shape (entries, times)."""
    return ca.MX(ca.diagcat(*[pattern] * times), ca.vec(entries))
