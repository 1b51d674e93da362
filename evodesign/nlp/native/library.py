"""The method in C for a program whose functions are compiled as a whole."""

from __future__ import annotations

import ctypes
import os

import casadi as ca
import numpy as np

from evodesign.identity import code_digest
from evodesign.nlp.codegen import FUNCTION_FLAGS, Library, built, compiler_and_cache
from evodesign.nlp.compiler import Compiler, NotCompiled
from evodesign.nlp.disk_cache import Cache
from evodesign.nlp.method import Ending, MethodName, SolverOptions
from evodesign.nlp.native.calls import NOT_LOADED, CalledSolver, method_library
from evodesign.nlp.native.pieces import in_pieces
from evodesign.nlp.native.source import PROBLEM, fixed_variables, program_text
from evodesign.nlp.program import Array, Program

__all__ = ["SELDOM_FLAGS", "NativeMethod", "native_method"]

SELDOM_FLAGS = ("-O0", *FUNCTION_FLAGS[1:])
"""Of programs that are solved seldom, where there is no TinyCC: the same bits, twice as slow to run."""


class NativeMethod:
    """A program ready to be solved by the method in C.

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
        held = fixed_variables(program)
        self._free, self._fixed = np.flatnonzero(~held), np.flatnonzero(held)
        self._values = program.bounds[0][held]
        self._called = CalledSolver(
            method,
            problem(),
            variables=len(self._free),
            rows=program.rows.numel(),
            parameters=program.given.numel(),
            fixed=len(self._fixed),
        )

    def solve(self, options: SolverOptions, start: Array, parameters: Array) -> Ending:
        """Solve from a start, in the program's own units."""
        found = self._called.solve(options, start[self._free], parameters)
        symbols, forces = np.empty(len(start)), np.empty(len(start))
        symbols[self._free], symbols[self._fixed] = found.variables, self._values
        forces[self._free], forces[self._fixed] = found.bounds, -found.fixed_slopes
        return Ending(symbols, found.cost, found.word, found.iterations, forces, found.rows, found.slopes)


def native_method(program: Program, *, seldom: bool = False) -> NativeMethod | NotCompiled:
    """The method for a program, with this process's compiler and the user's cache, or why there is none.

    Args:
        program: what is solved.
        seldom: whether it is solved so seldom that the compiler had better be quick than its code.
    """
    method, tools = method_library(), compiler_and_cache(os.environ, quick=seldom)
    if isinstance(method, NotCompiled):
        return method
    if isinstance(tools, NotCompiled):
        return tools
    try:
        functions = _functions(program, *tools, seldom=seldom)
        return functions if isinstance(functions, NotCompiled) else NativeMethod(program, method, functions)
    except OSError as error:
        return NotCompiled(f"{NOT_LOADED}: {error}")


def _functions(program: Program, compiler: Compiler, cache: Cache, *, seldom: bool) -> Library | NotCompiled:
    outputs, cut = [program.cost, program.rows], seldom and not compiler.bundled
    expressions = ca.Function("nlp", [program.symbols, program.given], outputs).serialize()
    return built(
        (code_digest(__name__), expressions, program.bounds, program.limits),
        lambda: {"functions.c": in_pieces(program_text(program)) if cut else program_text(program)},
        SELDOM_FLAGS if cut else FUNCTION_FLAGS,
        compiler,
        cache,
    )
