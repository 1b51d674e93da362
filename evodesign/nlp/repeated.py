"""Programs of blocks, solved by the method in C or by IPOPT, its judge."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np
import scipy

from evodesign.nlp.blocks import Block, Repeated, stacked_limits
from evodesign.nlp.codegen import compiled_function
from evodesign.nlp.compiler import NotCompiled
from evodesign.nlp.ipopt import casadi_options, ending_of
from evodesign.nlp.method import Ending, MethodName, SolverOptions
from evodesign.nlp.native.block_code import NativeMaker, native_maker
from evodesign.nlp.optimality import NotDifferentiable
from evodesign.nlp.program import Array, Expression
from evodesign.nlp.repeated_slopes import central_differences, solution_slopes

EXACTLY = (1e-12, 1e-10)
"""Tolerances with which a solution is found again to be differentiated; the second where the first is beyond
what rounding leaves."""

SAME = 1e-2
"""Change of a symbol, in the program's own units, below which a solution that is found again is the same."""

SUCCEEDED = "Solve_Succeeded"


class RepeatedProgram:
    """A program of repeated blocks, ready to be solved.

    Args:
        name: of the program.
        parts: blocks with what they see; all of the same variables and the same shared numbers.
        options: of the solver.
    """

    def __init__(self, name: str, parts: Sequence[Repeated], options: SolverOptions) -> None:
        self._name, self._parts, self._options = name, tuple(parts), options
        self._limits = stacked_limits(self._parts)
        self._solvers: dict[SolverOptions, Any] = {}
        self.rows = len(self._limits[0])
        self.variables = int(parts[0].image.shape[1])

    @property
    def method(self) -> MethodName:
        """Who solves: IPOPT where nothing can be compiled."""
        return MethodName.IPOPT if self._native is None else MethodName.NATIVE

    def solve(
        self,
        start: Array,
        bounds: tuple[Array, Array],
        shared: Array,
        own: Sequence[Array],
        options: SolverOptions | None = None,
    ) -> tuple[Ending, float]:
        """Solve from a start.

        Args:
            start: x, within its bounds.
            bounds: lower and upper bounds of x.
            shared: s.
            own: p of each block, shape (times, p).
            options: others than the program's.
        Returns:
            The end of the solve, whose `cost_slope` is the derivative of the optimal cost with respect to s,
            and its wall time [s].
        """
        began, options = time.perf_counter(), options or self._options
        parameters = np.concatenate([shared, *[np.ravel(each) for each in own]])
        if self._native is not None:
            found = self._native.solve(options, start, bounds, parameters)
        else:
            found = ending_of(self._ipopt(options), start, parameters, bounds, self._limits)
        by_x, by_shared = self._slopes(found.symbols, shared, own, found.rows)
        return replace(found, bounds=-by_x, cost_slope=by_shared), time.perf_counter() - began

    def exact(
        self, ending: Ending, bounds: tuple[Array, Array], shared: Array, own: Sequence[Array]
    ) -> Ending | NotDifferentiable:
        """A solution found again so exactly that it can be differentiated; arguments as in `slopes`."""
        for tolerance in EXACTLY:
            options = replace(self._options, tolerance=tolerance, near=True)
            found, _ = self.solve(ending.symbols, bounds, shared, own, options)
            if found.word != SUCCEEDED:
                continue
            if np.abs(found.symbols - ending.symbols).max() > SAME:
                return NotDifferentiable("the motion was not found again")
            return found
        return NotDifferentiable(f"the motion could not be made exact ({found.word})")

    def slopes(
        self,
        ending: Ending,
        bounds: tuple[Array, Array],
        shared: Array,
        own: Sequence[Array],
        count: int,
    ) -> Array | NotDifferentiable:
        """Derivatives of a solution by the first shared numbers, shape (x, count).

        Args:
            ending: of a solve that succeeded, made exact.
            bounds: lower and upper bounds of x.
            shared: s.
            own: p of each block, shape (times, p).
            count: how many of the shared numbers move.
        """
        parameters = np.concatenate([shared, *[np.ravel(each) for each in own]])
        functions, symbols = self._uncompiled.functions, ending.symbols
        values, jacobian = functions["jac_g"](symbols, parameters)
        triangle = functions["hess_lag"](symbols, parameters, 1.0, ending.rows)
        upper = scipy.sparse.csc_matrix(triangle.sparse())
        hessian = upper + scipy.sparse.triu(upper, 1).T

        def first(moved: Array) -> tuple[Array, Array]:
            by_x, _ = self._slopes(symbols, moved, own, ending.rows)
            numbers = np.concatenate([moved, *[np.ravel(each) for each in own]])
            return by_x, np.asarray(functions["nlp"](symbols, numbers)[1]).ravel()

        return solution_slopes(
            hessian,
            scipy.sparse.csr_matrix(jacobian.sparse()),
            (np.asarray(values).ravel(), *self._limits, ending.rows),
            (symbols, *bounds, ending.bounds),
            central_differences(first, shared, count),
        )

    @cached_property
    def _uncompiled(self) -> RepeatedProgram:
        """The same on CasADi's virtual machine: derivatives of solutions are few."""
        return RepeatedProgram(self._name, self._parts, replace(self._options, compiled=False))

    def _slopes(
        self, symbols: Array, shared: Array, own: Sequence[Array], rows: Array
    ) -> tuple[Array, Array]:
        """Derivatives of the Lagrangian without bounds by x and by s."""
        ends = np.cumsum([part.rows for part in self._parts])[:-1]
        found = [
            part.slopes(symbols, mine, shared, weights)
            for part, mine, weights in zip(self._parts, own, np.split(rows, ends), strict=True)
        ]
        by_x, by_shared = (np.sum(each, axis=0) for each in zip(*found, strict=True))
        return by_x, by_shared

    @cached_property
    def _native(self) -> NativeMaker | None:
        """The method in C; none where IPOPT solves."""
        if self._options.method is MethodName.IPOPT:
            return None
        maker = native_maker(self._parts, seldom=self._options.seldom)
        return None if isinstance(maker, NotCompiled) else maker

    @cached_property
    def functions(self) -> Mapping[str, Any]:
        """Cost, rows, their first derivatives and the Hessian of the Lagrangian, as `nlpsol` wants them."""
        shared_size = self._parts[0].block.shared.numel()
        sizes = [part.times * part.block.own.numel() for part in self._parts]
        x, p = ca.MX.sym("x", self.variables), ca.MX.sym("p", shared_size + sum(sizes))
        factor, multipliers = ca.MX.sym("lam_f"), ca.MX.sym("lam_g", self.rows)
        shared, *owns = ca.vertsplit(p, np.cumsum([0, shared_size, *sizes]).tolist())
        counts = [part.rows for part in self._parts]
        per_block = ca.vertsplit(multipliers, np.cumsum([0, *counts]).tolist())
        cost: Expression = 0.0
        gradient: Expression = 0.0
        hessian: Expression = 0.0
        rows, jacobians = [], []
        for part, own, multiplier in zip(self._parts, owns, per_block, strict=True):
            image, block, times = ca.MX(ca.DM(part.image)), part.block, part.times
            made = _BlockDerivatives(block, compiled=self._options.compiled)
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
        }

    def _ipopt(self, asked: SolverOptions) -> Any:
        """IPOPT with some options."""
        if asked not in self._solvers:
            self._solvers[asked] = self._made(asked)
        return self._solvers[asked]

    def _made(self, asked: SolverOptions) -> Any:
        functions = self.functions
        options = {
            **casadi_options(asked),
            "no_nlp_grad": True,
            "calc_lam_p": False,
            **{name: functions[name] for name in ("grad_f", "jac_g", "hess_lag")},
        }
        return ca.nlpsol(self._name, "ipopt", functions["nlp"], options)


class _BlockDerivatives:
    """A block's derivatives as functions of CasADi.

    Attributes:
        first: cost, its gradient, rows and the entries of their Jacobian.
        second: entries of the upper triangle of the Lagrangian's Hessian.
        jacobian, hessian: patterns; the Hessian's is of all of it.
        order: which entry of the triangle each entry of the Hessian is.
    """

    def __init__(self, block: Block, *, compiled: bool) -> None:
        factor = ca.SX.sym("lam_f")
        *values, jacobian = block.first
        triangle = block.hessian(factor)
        self.jacobian = jacobian.sparsity()
        places = ca.triu2symm(ca.DM(triangle.sparsity(), np.arange(1.0, triangle.nnz() + 1.0)))
        self.hessian, self.order = places.sparsity(), [int(place) - 1 for place in places.nonzeros()]
        made = compiled_function if compiled else (lambda function: function)
        once, arguments = {"cse": True}, [*block.arguments, factor, block.multipliers]
        first = [*values, _entries(jacobian)]
        self.first = made(ca.Function(f"{block.name}_first", block.arguments, first, once))
        self.second = made(ca.Function(f"{block.name}_second", arguments, [_entries(triangle)], once))


def _entries(matrix: Expression) -> Expression:
    return ca.vertcat(*matrix.nonzeros()) if matrix.nnz() else ca.SX(0, 1)


def _diagonal(pattern: Any, entries: Expression, times: int) -> Expression:
    """The block-diagonal matrix of blocks of one pattern, from their entries, shape (entries, times)."""
    return ca.MX(ca.diagcat(*[pattern] * times), ca.vec(entries))
