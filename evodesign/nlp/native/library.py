"""The method in C, called from Python.

A library is executed with the user's rights; see `codegen` for which ones are trusted.
"""

from __future__ import annotations

import ctypes
import functools
import os
import weakref
from collections.abc import Callable
from threading import Lock

import casadi as ca
import numpy as np

from evodesign.identity import code_digest
from evodesign.nlp.codegen import FUNCTION_FLAGS, Compiler, Library, NotCompiled, built, compiler_and_cache
from evodesign.nlp.disk_cache import Cache
from evodesign.nlp.method import NEAR_BARRIER, NEAR_PUSH, Ending, MethodName, SolverOptions
from evodesign.nlp.native.pieces import in_pieces
from evodesign.nlp.native.source import HERE, METHOD_FILES, PROBLEM, fixed_variables, program_text
from evodesign.nlp.program import Array, Program

__all__ = ["NativeMethod", "method_library", "native_method"]

SELDOM_FLAGS = ("-O0", *FUNCTION_FLAGS[1:])
"""Of programs that are solved seldom: a fifth of the time to compile, twice as slow to run, the same bits."""

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


class NativeMethod:
    """A program ready to be solved by the method in C.

    Solves share memory, so that threads take turns.

    Args:
        program: what is solved.
        method: the method's own library.
        functions: the program's.
    Raises:
        OSError: a library cannot be loaded.
        MemoryError: memory is short.
    """

    name = MethodName.NATIVE

    def __init__(self, program: Program, method: ctypes.CDLL, functions: Library) -> None:
        self.functions = functions
        self._library = ctypes.CDLL(str(functions.path))
        problem = self._library[PROBLEM]
        problem.restype = ctypes.c_void_p
        method.create.argtypes, method.create.restype = (ctypes.c_void_p,), ctypes.c_void_p
        method.destroy.argtypes, method.destroy.restype = (ctypes.c_void_p,), None
        self._solve: Callable[..., None] = method.solve
        self._solve.argtypes, self._solve.restype = (ctypes.c_void_p,) * 9, None
        solver = method.create(problem())
        if not solver:
            raise MemoryError(f"no memory to solve the program '{program.name}'")
        weakref.finalize(self, method.destroy, solver)
        held = fixed_variables(program)
        self._free, self._fixed = np.flatnonzero(~held), np.flatnonzero(held)
        self._values = program.bounds[0][held]
        self._parameters = np.zeros(program.given.numel())
        self._outcome, self._alone = _Outcome(), Lock()
        rows, given = program.rows.numel(), program.given.numel()
        self._vectors = [
            np.zeros(n) for n in (len(self._free), len(self._free), rows, given, len(self._fixed))
        ]
        vectors = [vector.ctypes.data for vector in (self._parameters, *self._vectors)]
        self._addresses = (solver, *vectors, ctypes.addressof(self._outcome))

    def solve(self, options: SolverOptions, start: Array, parameters: Array) -> Ending:
        """Solve from a start, in the program's own units."""
        symbols, forces = np.empty(len(start)), np.empty(len(start))
        x, bounds, rows, given, fixed = self._vectors
        solver, *rest = self._addresses
        settings, outcome = _settings(options), self._outcome
        with self._alone:
            x[:] = start[self._free]
            self._parameters[:] = parameters
            self._solve(solver, ctypes.addressof(settings), *rest)
            symbols[self._free], symbols[self._fixed] = x, self._values
            forces[self._free], forces[self._fixed] = bounds, -fixed
            return Ending(
                symbols,
                outcome.cost,
                WORDS[outcome.status],
                outcome.iterations + outcome.restorations,
                forces,
                rows.copy(),
                given.copy(),
            )


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


def native_method(program: Program, *, seldom: bool = False) -> NativeMethod | NotCompiled:
    """The method for a program, with this process's compiler and the user's cache, or why there is none.

    Args:
        program: what is solved.
        seldom: whether it is solved so seldom that the compiler had better be quick than its code.
    """
    method, tools = method_library(), compiler_and_cache(os.environ)
    if isinstance(method, NotCompiled):
        return method
    if isinstance(tools, NotCompiled):
        return tools
    try:
        functions = _functions(program, *tools, seldom=seldom)
        return functions if isinstance(functions, NotCompiled) else NativeMethod(program, method, functions)
    except OSError as error:
        return NotCompiled(f"{NOT_LOADED}: {error}")


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


def _functions(program: Program, compiler: Compiler, cache: Cache, *, seldom: bool) -> Library | NotCompiled:
    outputs = [program.cost, program.rows]
    expressions = ca.Function("nlp", [program.symbols, program.given], outputs).serialize()
    return built(
        (code_digest(__name__), expressions, program.bounds, program.limits),
        lambda: {"functions.c": in_pieces(program_text(program)) if seldom else program_text(program)},
        SELDOM_FLAGS if seldom else FUNCTION_FLAGS,
        compiler,
        cache,
    )
