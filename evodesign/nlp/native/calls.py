"""The method in C as Python calls it, over a problem in memory.

A library is executed with the user's rights; see `codegen` for which ones are trusted.
"""

from __future__ import annotations

import ctypes
import functools
import os
import weakref
from collections.abc import Callable
from threading import Lock

import numpy as np

from evodesign.nlp.codegen import built, compiler_and_cache
from evodesign.nlp.compiler import NotCompiled
from evodesign.nlp.method import NEAR_BARRIER, NEAR_PUSH, Ending, SolverOptions
from evodesign.nlp.native.program_code import HERE, METHOD_FILES
from evodesign.nlp.program import Array

METHOD_FLAGS = ("-std=c11", "-O2", "-shared", "-fPIC", "-ffp-contract=off")

WORDS = (
    "Solve_Succeeded",
    "Solved_To_Acceptable_Level",
    "Maximum_Iterations_Exceeded",
    "Maximum_WallTime_Exceeded",
    "Infeasible_Problem_Detected",
    "Restoration_Failed",
    "Error_In_Step_Computation",
    "Invalid_Number_Detected",
)
"""IPOPT's words for the ends of a solve, in the order of the C's `Status`."""

NOT_LOADED = "the compiled functions could not be loaded"

BARRIER = 0.1
"""IPOPT's mu_init."""

PUSH = 1e-2
"""IPOPT's bound_push."""

RELAXATION = 1e-8
"""IPOPT's bound_relax_factor."""


class _Options(ctypes.Structure):
    """The C's `Options`."""

    _fields_ = (
        ("tolerance", ctypes.c_double),
        ("seconds", ctypes.c_double),
        ("barrier", ctypes.c_double),
        ("push", ctypes.c_double),
        ("relaxation", ctypes.c_double),
        ("iterations", ctypes.c_int),
        ("near", ctypes.c_int),
    )


class _Outcome(ctypes.Structure):
    """The C's `Outcome`."""

    _fields_ = (
        ("cost", ctypes.c_double),
        ("status", ctypes.c_int),
        ("iterations", ctypes.c_int),
        ("restorations", ctypes.c_int),
    )


class CalledSolver:
    """A problem in memory, ready to be solved. Solves share memory, so that threads take turns.

    Args:
        method: the method's library.
        problem: address of the C's `Problem`, which must outlive the solver.
        variables, rows, parameters, fixed: their numbers; fixed ones are no variables of the problem.
    Raises:
        MemoryError: memory is short.
    """

    def __init__(
        self,
        method: ctypes.CDLL,
        problem: int | None,
        *,
        variables: int,
        rows: int,
        parameters: int,
        fixed: int,
    ) -> None:
        method.create.argtypes, method.create.restype = (ctypes.c_void_p,), ctypes.c_void_p
        method.destroy.argtypes, method.destroy.restype = (ctypes.c_void_p,), None
        self._solve: Callable[..., None] = method.solve
        self._solve.argtypes, self._solve.restype = (ctypes.c_void_p,) * 9, None
        solver = method.create(problem)
        if not solver:
            raise MemoryError(f"no memory to solve a program of {variables} variables")
        weakref.finalize(self, method.destroy, solver)
        self._outcome, self._alone = _Outcome(), Lock()
        self._vectors = [np.zeros(n) for n in (parameters, variables, variables, rows, parameters, fixed)]
        addresses = [vector.ctypes.data for vector in self._vectors]
        self._addresses = (solver, *addresses, ctypes.addressof(self._outcome))

    def solve(self, options: SolverOptions, start: Array, parameters: Array) -> tuple[Ending, Array]:
        """Solve from a start, in the program's own units.

        Returns:
            the end, with the C's variables; slopes of the Lagrangian by variables that have one value only.
            Both slopes are zeros for a program of blocks.
        """
        numbers, x, bounds, rows, slopes, fixed = self._vectors
        solver, *rest = self._addresses
        settings, outcome = _settings(options), self._outcome
        with self._alone:
            numbers[:], x[:] = parameters, start
            self._solve(solver, ctypes.addressof(settings), *rest)
            ending = Ending(
                symbols=x.copy(),
                cost=outcome.cost,
                word=WORDS[outcome.status],
                iterations=outcome.iterations + outcome.restorations,
                bounds=bounds.copy(),
                rows=rows.copy(),
                cost_slope=slopes.copy(),
            )
            return ending, fixed.copy()


@functools.cache
def _settings(options: SolverOptions) -> _Options:
    """The options in C."""
    near = options.near
    return _Options(
        tolerance=options.tolerance,
        seconds=options.seconds,
        barrier=NEAR_BARRIER if near else BARRIER,
        push=NEAR_PUSH if near else PUSH,
        relaxation=0.0 if near else min(options.tolerance, RELAXATION),
        iterations=options.iterations,
        near=near,
    )


@functools.cache
def method_library() -> ctypes.CDLL | NotCompiled:
    """The method's own library, for all programs, or why there is none."""
    texts = {name: (HERE / name).read_text(encoding="ascii") for name in METHOD_FILES}
    tools = compiler_and_cache(os.environ)
    if isinstance(tools, NotCompiled):
        return tools
    try:
        found = built(texts, lambda: texts, METHOD_FLAGS, *tools)
        return found if isinstance(found, NotCompiled) else ctypes.CDLL(str(found.path))
    except OSError as error:  # such as a directory mounted without the right to execute
        return NotCompiled(f"{NOT_LOADED}: {error}")
