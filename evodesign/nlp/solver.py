"""Programs made ready once, and solved by name: parameters and starts in SI units, whatever the method."""

from __future__ import annotations

import time
from collections import OrderedDict
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from typing import Any

import numpy as np

from evodesign.nlp.codegen import CompiledFunctions, Library
from evodesign.nlp.compiler import NotCompiled
from evodesign.nlp.ipopt import Ipopt
from evodesign.nlp.method import Method, MethodName, SolverOptions
from evodesign.nlp.native.calls import method_library
from evodesign.nlp.native.library import native_method
from evodesign.nlp.program import Array, Program, Start
from evodesign.records import Status


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
    """What a method returned.

    Args:
        values: value by variable name, SI units.
        status: solved, or why not.
        reason: IPOPT's word for it.
        iterations: number of iterations.
        seconds: wall time [s].
        cost: of the last iterate.
        cost_slope: derivative of the optimal cost with respect to each row of the program's `given` (envelope
            theorem).
        multipliers: of bounds and constraints.
        method: who solved.
        start: where the solve began.
    """

    values: Mapping[str, Array]
    status: Status
    reason: str
    iterations: int
    seconds: float
    cost: float
    cost_slope: Array
    multipliers: Multipliers
    method: MethodName = MethodName.IPOPT
    start: Start = field(default_factory=dict)


KEPT = 16
"""Solvers that a process keeps for its next work; a problem has about three for each person."""

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
        options: of every solve.
    """

    def __init__(self, program: Program, options: SolverOptions) -> None:
        self.program = program
        self.options = options
        self._method = _made(program, options)
        self._origin = self  # also of those with other options

    @property
    def functions(self) -> CompiledFunctions | Library | NotCompiled:
        """The machine code that evaluates the program, or why CasADi's virtual machine does."""
        return self._method.functions

    def with_options(self, options: SolverOptions) -> Solver:
        """The same program, solved with others of the options that say nothing of machine code and method."""
        if options == self.options:
            return self
        other = object.__new__(Solver)
        other.program, other.options = self.program, options
        other._method, other._origin = self._method, self._origin
        return other

    @cached_property
    def near(self) -> Solver:
        """The same for solves that begin close to a solution: a third of the iterations."""
        return self.with_options(replace(self.options, near=True))

    @cached_property
    def by_ipopt(self) -> Solver:
        """The same program for what the native method does not solve; too seldom to compile for."""
        options = replace(self.options, compiled=False)
        if self._origin is not self:
            return self._origin.by_ipopt.with_options(options)
        return Solver(self.program, options)

    @property
    def native(self) -> bool:
        """Whether the native method solves."""
        return self._method.name is MethodName.NATIVE

    @property
    def start(self) -> dict[str, Array]:
        """The program's own starting values, SI units."""
        return {variable.name: variable.start for variable in self.program.variables}

    def solve(self, parameters: Mapping[str, Any], start: Mapping[str, Array]) -> RawSolution:
        """Solve for parameters, by name, from a start (variables left out begin at the program's own)."""
        chosen = self.parted if self._is_parted(start) else self
        method, program, began = chosen._method, chosen.program, time.perf_counter()
        ending = method.solve(
            self.options, program.packed(start), program.packed_parameters(parameters, start)
        )
        return RawSolution(
            start=start,
            values={**program.unpacked(ending.symbols), **program.held(start)},
            status=status_of(ending.word),
            reason=ending.word,
            iterations=ending.iterations,
            seconds=time.perf_counter() - began,
            cost=ending.cost,
            cost_slope=ending.cost_slope,
            multipliers=Multipliers(ending.bounds, ending.rows),
            method=method.name,
        )

    @cached_property
    def parted(self) -> Solver:
        """The same with all rows, for starts that switch some on."""
        if self._origin is not self:
            return self._origin.parted
        switches = self.program.switches
        return self if switches is None else Solver(switches.program, self.options)

    def _is_parted(self, start: Start) -> bool:
        switches = self.program.switches
        return switches is not None and not self.program.switched and has_any(switches.names, start)


def status_of(word: str) -> Status:
    """What a method's word for the end of a solve means."""
    return _STATUS.get(word, Status.NUMERICAL_FAILURE)


def has_any(names: Collection[str], start: Start) -> bool:
    """Whether a start has something else than zeros under some names."""
    return any(np.count_nonzero(start[name]) for name in names if name in start)


def _made(program: Program, options: SolverOptions) -> Method:
    """Who solves a program."""
    if options.method is MethodName.NATIVE:
        native = native_method(program, seldom=options.seldom)
        if not isinstance(native, NotCompiled):
            return native
    return Ipopt(program, options)


def available(options: SolverOptions) -> SolverOptions:
    """The options with the method that can be had here: IPOPT where nothing can be compiled."""
    if options.method is MethodName.NATIVE and isinstance(method_library(), NotCompiled):
        return replace(options, method=MethodName.IPOPT)
    return options


class SolverCache:
    """Solvers that are built once, however many scenes need them, by what their programs follow from.

    The load's mass is a number that every program is given, and a robot's program knows of the person only
    what the load passes on. So scenes that differ in the mass of their load alone share all programs, and
    scenes that differ in the person share the robot's.

    Args:
        most: how many are kept at a time, those that were last asked for.
    """

    def __init__(self, most: float = np.inf) -> None:
        self._most = most
        self._solvers: OrderedDict[object, Solver] = OrderedDict()

    def solver(self, key: str, program: Callable[[], Program], options: SolverOptions) -> Solver:
        """The solver of a program, built when it is first asked for.

        Args:
            key: of everything that the program follows from.
            program: builds it.
            options: of the solver.
        """
        own = key, options.compiled, options.method, options.seldom
        if own not in self._solvers:
            self._solvers[own] = Solver(program(), options)
        self._solvers.move_to_end(own)
        if len(self._solvers) > self._most:
            self._solvers.popitem(last=False)
        return self._solvers[own].with_options(options)


@cache
def own_solvers() -> SolverCache:
    """Those of this process, for work that follows other work on the same problem."""
    return SolverCache(KEPT)
