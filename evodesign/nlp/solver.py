"""Programs solved by IPOPT, through CasADi.

Source: Waechter and Biegler, Mathematical Programming 106 (2006), 25-57.
"""

from __future__ import annotations

import time
from collections.abc import Mapping
from copy import copy
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from evodesign.nlp.codegen import CompiledFunctions, NotCompiled, compiled_functions
from evodesign.nlp.program import Program
from evodesign.records import Status

__all__ = ["IpoptOptions", "Multipliers", "RawSolution", "Solver"]

Array = Any


@dataclass(frozen=True, slots=True)
class IpoptOptions:
    """IPOPT's settings; the values are what measured best on posture problems (docs/benchmarks.md).

    Args:
        tolerance: of the scaled optimality error; bounds are taken as wider by as much, at most 1e-8.
        iterations: limit.
        seconds: limit of wall time per solve [s].
        compiled: whether the program's functions run as machine code; results are the same, sooner.
        near: whether solves begin at a solution, to be found again more exactly: the barrier starts small,
            and bounds are taken as they are.
    """

    tolerance: float = 1e-8
    iterations: int = 300
    seconds: float = 20.0
    compiled: bool = False
    near: bool = False


@dataclass(frozen=True, slots=True)
class Multipliers:
    """What the bounds and constraints of a program cost at its solution, per unit of each row.

    Positive at an upper bound, negative at a lower one: grad f + (grad g) constraints + bounds = 0.

    Args:
        bounds: of the variables (their symbols), one per row.
        constraints: one per row.
    """

    bounds: Array
    constraints: Array


@dataclass(frozen=True, slots=True)
class RawSolution:
    """What IPOPT returned.

    Args:
        values: value by variable name, SI units.
        status: solved, or why not.
        reason: IPOPT's word for it.
        iterations: number of iterations.
        seconds: wall time [s].
        cost: of the last iterate.
        cost_slope: derivative of the optimal cost with respect to each row of the program's `given` (envelope
            theorem; the negative of CasADi's lam_p).
        multipliers: of bounds and constraints.
    """

    values: Mapping[str, Array]
    status: Status
    reason: str
    iterations: int
    seconds: float
    cost: float
    cost_slope: Array
    multipliers: Multipliers


_STATUS = {
    "Solve_Succeeded": Status.SOLVED,
    "Solved_To_Acceptable_Level": Status.SOLVED,
    "Infeasible_Problem_Detected": Status.INFEASIBLE,
    "Maximum_Iterations_Exceeded": Status.ITERATION_LIMIT,
    "Maximum_CpuTime_Exceeded": Status.TIME_LIMIT,
    "Maximum_WallTime_Exceeded": Status.TIME_LIMIT,
}


class Solver:
    """A program made ready once; solved any number of times for other parameters and starts.

    Attributes:
        program: what is solved.
        functions: the machine code that evaluates it, or why CasADi's virtual machine does.
    """

    def __init__(self, program: Program, options: IpoptOptions) -> None:
        self.program = program
        self._options = options
        self._bounds, self._limits = program.bounds, program.limits
        problem = {"x": program.symbols, "p": program.given, "f": program.cost, "g": program.rows}
        self.functions: CompiledFunctions | NotCompiled = (
            compiled_functions(problem) if options.compiled else NotCompiled("compiling is switched off")
        )
        self._oracle = problem if isinstance(self.functions, NotCompiled) else self.functions.oracle
        self._solve = ca.nlpsol(program.name, "ipopt", self._oracle, _casadi_options(options))

    @cached_property
    def near(self) -> Solver:
        """The same for solves that begin close to a solution: a third of the iterations."""
        other = copy(self)
        options = replace(self._options, near=True)
        other._solve = ca.nlpsol(self.program.name, "ipopt", self._oracle, _casadi_options(options))
        return other

    @property
    def start(self) -> dict[str, Array]:
        """The program's own starting values, SI units."""
        return {variable.name: variable.start for variable in self.program.variables}

    def solve(self, parameters: Mapping[str, Any], start: Mapping[str, Array]) -> RawSolution:
        """Solve for parameters, by name, from a start (variables left out begin at the program's own)."""
        began = time.perf_counter()
        result = self._solve(
            x0=self.program.packed(start),
            p=self.program.packed_parameters(parameters),
            lbx=self._bounds[0],
            ubx=self._bounds[1],
            lbg=self._limits[0],
            ubg=self._limits[1],
        )
        seconds = time.perf_counter() - began
        stats = self._solve.stats()
        word = str(stats["return_status"])
        return RawSolution(
            values=self.program.unpacked(np.asarray(result["x"]).ravel()),
            status=_STATUS.get(word, Status.NUMERICAL_FAILURE),
            reason=word,
            iterations=int(stats["iter_count"]),
            seconds=seconds,
            cost=float(result["f"]),
            cost_slope=-np.asarray(result["lam_p"]).ravel(),
            multipliers=Multipliers(np.asarray(result["lam_x"]).ravel(), np.asarray(result["lam_g"]).ravel()),
        )


def _casadi_options(options: IpoptOptions) -> dict[str, Any]:
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
    "mu_init": 1e-8,
    "bound_push": 1e-9,
    "bound_frac": 1e-9,
    "slack_bound_push": 1e-9,
    "slack_bound_frac": 1e-9,
    "bound_mult_init_method": "mu-based",
    "bound_relax_factor": 0.0,
}
