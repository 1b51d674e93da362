"""IPOPT, through CasADi."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np

from evodesign.nlp.codegen import CompiledFunctions, compiled_functions
from evodesign.nlp.compiler import NotCompiled
from evodesign.nlp.method import NEAR_BARRIER, NEAR_PUSH, Ending, MethodName, SolverOptions
from evodesign.nlp.program import Array, Program


class Ipopt:
    """A program made ready to be solved by IPOPT.

    Attributes:
        functions: the machine code that evaluates it, or why CasADi's virtual machine does.
    """

    name = MethodName.IPOPT

    def __init__(self, program: Program, options: SolverOptions) -> None:
        self._name, self._bounds, self._limits = program.name, program.bounds, program.limits
        problem = {"x": program.symbols, "p": program.given, "f": program.cost, "g": program.rows}
        self.functions: CompiledFunctions | NotCompiled = (
            compiled_functions(problem) if options.compiled else NotCompiled("compiling is switched off")
        )
        self._oracle = problem if isinstance(self.functions, NotCompiled) else self.functions.oracle
        self._solvers: dict[SolverOptions, Any] = {}

    def solve(self, options: SolverOptions, start: Array, parameters: Array) -> Ending:
        """Solve from a start, in the program's own units."""
        if options not in self._solvers:
            self._solvers[options] = ca.nlpsol(self._name, "ipopt", self._oracle, casadi_options(options))
        return ending_of(self._solvers[options], start, parameters, self._bounds, self._limits)


def ending_of(
    solver: Any, start: Array, parameters: Array, bounds: tuple[Array, Array], limits: tuple[Array, Array]
) -> Ending:
    """Where CasADi's `nlpsol` leads from a start; bounds are of variables, limits of rows."""
    (lower, upper), (least, most) = bounds, limits
    result = solver(x0=start, p=parameters, lbx=lower, ubx=upper, lbg=least, ubg=most)
    stats = solver.stats()
    return Ending(
        symbols=np.asarray(result["x"]).ravel(),
        cost=float(result["f"]),
        word=str(stats["return_status"]),
        iterations=int(stats["iter_count"]),
        bounds=np.asarray(result["lam_x"]).ravel(),
        rows=np.asarray(result["lam_g"]).ravel(),
        cost_slope=-np.asarray(result["lam_p"]).ravel(),
    )


def casadi_options(options: SolverOptions) -> dict[str, Any]:
    """The options as CasADi takes them."""
    return {
        "print_time": False,
        "error_on_fail": False,
        "ipopt": {
            "print_level": 0,
            "sb": "yes",
            "tol": options.tolerance,
            "bound_relax_factor": min(options.tolerance, 1e-8),
            "max_iter": options.iterations,
            "max_wall_time": options.seconds,
            "fast_step_computation": "yes",
            "nlp_scaling_method": "none",
            **(_NEAR if options.near else {}),
        },
    }


_NEAR = {
    "mu_init": NEAR_BARRIER,
    "bound_push": NEAR_PUSH,
    "bound_frac": NEAR_PUSH,
    "slack_bound_push": NEAR_PUSH,
    "slack_bound_frac": NEAR_PUSH,
    "bound_mult_init_method": "mu-based",
    "bound_relax_factor": 0.0,
}
