"""The method in C for a program whose functions are compiled as a whole."""

from __future__ import annotations

import ctypes
import time
from dataclasses import replace

import casadi as ca
import numpy as np

from evodesign.identity import code_digest
from evodesign.nlp.codegen import Library
from evodesign.nlp.compiler import NotCompiled
from evodesign.nlp.method import Ending, MethodName, SolverOptions
from evodesign.nlp.native.calls import NOT_LOADED, CalledSolver, method_library
from evodesign.nlp.native.optimised import FunctionSource, Optimised, functions_of
from evodesign.nlp.native.program_code import PROBLEM, fixed_variables, program_text
from evodesign.nlp.program import Array, Program


class NativeMethod:
    """A program ready to be solved by the method in C.

    Args:
        program: what is solved.
        method: the method's own library.
        functions: the program's.
        optimised: makes them faster, where that is possible.
    Raises:
        OSError: a library cannot be loaded.
        MemoryError: memory is short.
    """

    name = MethodName.NATIVE

    def __init__(
        self, program: Program, method: ctypes.CDLL, functions: Library, optimised: Optimised | None = None
    ) -> None:
        self._rows, self._parameters = program.rows.numel(), program.given.numel()
        held = fixed_variables(program)
        self._free, self._fixed = np.flatnonzero(~held), np.flatnonzero(held)
        self._values = program.bounds[0][held]
        self._method, self._optimised = method, optimised
        self._load(functions)

    def _load(self, functions: Library) -> None:
        library = ctypes.CDLL(str(functions.path))
        problem = library[PROBLEM]
        problem.restype = ctypes.c_void_p
        self._called = CalledSolver(
            self._method,
            problem(),
            variables=len(self._free),
            rows=self._rows,
            parameters=self._parameters,
            fixed=len(self._fixed),
        )
        self.functions, self._library = functions, library

    def solve(self, options: SolverOptions, start: Array, parameters: Array) -> Ending:
        """Solve from a start, in the program's own units."""
        began = time.perf_counter()
        found, fixed_slopes = self._called.solve(options, start[self._free], parameters)
        if self._optimised:
            seconds = time.perf_counter() - began
            self._optimised = self._optimised.taken_over(self.functions, seconds, self._load)
        symbols, forces = np.empty(len(start)), np.empty(len(start))
        symbols[self._free], symbols[self._fixed] = found.symbols, self._values
        forces[self._free], forces[self._fixed] = found.bounds, -fixed_slopes
        return replace(found, symbols=symbols, bounds=forces)


def native_method(program: Program, *, seldom: bool = False) -> NativeMethod | NotCompiled:
    """The method for a program, with this process's compilers and the user's cache, or why there is none.

    Args:
        program: what is solved.
        seldom: whether it is solved so seldom that it is never worth optimising.
    """
    method = method_library()
    if isinstance(method, NotCompiled):
        return method
    try:
        found = functions_of(FunctionSource(_of(program), lambda: program_text(program)), seldom=seldom)
        return found if isinstance(found, NotCompiled) else NativeMethod(program, method, *found)
    except OSError as error:
        return NotCompiled(f"{NOT_LOADED}: {error}")


def _of(program: Program) -> object:
    """What the C of a program follows from."""
    expressions = ca.Function(
        "nlp", [program.symbols, program.given], [program.cost, program.rows]
    ).serialize()
    return code_digest(__name__), expressions, program.bounds, program.limits
