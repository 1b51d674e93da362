"""The method in C for a program whose functions are compiled as a whole.

TinyCC compiles at once. A program that has been solved for longer than it takes to optimise its functions is
worth that: the machine's own compiler does it behind, and its code, which gives the same bits, takes over.
"""

from __future__ import annotations

import ctypes
import os
import time
from collections.abc import Mapping
from concurrent.futures import Future
from dataclasses import dataclass
from pathlib import Path

import casadi as ca
import numpy as np

from evodesign.identity import code_digest
from evodesign.nlp.background import in_background
from evodesign.nlp.codegen import FUNCTION_FLAGS, Library, built, compiler_and_cache, kept_library
from evodesign.nlp.compiler import Compiler, NotCompiled
from evodesign.nlp.disk_cache import Cache
from evodesign.nlp.method import Ending, MethodName, SolverOptions
from evodesign.nlp.native.calls import NOT_LOADED, CalledSolver, method_library
from evodesign.nlp.native.program_code import PROBLEM, fixed_variables, program_text
from evodesign.nlp.program import Array, Program

WORTH = 5e-6
"""Time [s] that a program must have been solved for, per byte of TinyCC's code, to be worth optimising.

Twice what GCC takes for it; its code saves a third to a half of a solve.
"""

NICENESS = 10
"""How much less urgent optimising is than the solves beside it."""


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
        found = self._called.solve(options, start[self._free], parameters)
        if self._optimised:
            self._optimise(self._optimised, time.perf_counter() - began)
        symbols, forces = np.empty(len(start)), np.empty(len(start))
        symbols[self._free], symbols[self._fixed] = found.variables, self._values
        forces[self._free], forces[self._fixed] = found.bounds, -found.fixed_slopes
        return Ending(symbols, found.cost, found.word, found.iterations, forces, found.rows, found.slopes)

    def _optimise(self, optimised: Optimised, seconds: float) -> None:
        """Take over what has been optimised behind, if a solve of so long [s] makes it worth that."""
        try:
            found = optimised.after(self.functions, seconds)
            if isinstance(found, Library):
                self._load(found)
        except (OSError, MemoryError) as error:
            found = NotCompiled(f"{NOT_LOADED}: {error}")
        if found:
            self._optimised = None


def native_method(program: Program, *, seldom: bool = False) -> NativeMethod | NotCompiled:
    """The method for a program, with this process's compilers and the user's cache, or why there is none.

    Args:
        program: what is solved.
        seldom: whether it is solved so seldom that it is never worth optimising.
    """
    method = method_library()
    quick, best = (compiler_and_cache(os.environ, quick=each) for each in (True, False))
    if isinstance(method, NotCompiled):
        return method
    if isinstance(quick, NotCompiled):
        return quick
    if isinstance(best, NotCompiled):
        return best
    source = _source(program)
    optimised = None if seldom or quick == best else Optimised(program, source, *best)
    try:
        functions = optimised.kept if optimised else None
        if functions:
            return NativeMethod(program, method, functions)
        found = built(source, lambda: _texts(program), FUNCTION_FLAGS, *quick)
        return found if isinstance(found, NotCompiled) else NativeMethod(program, method, found, optimised)
    except OSError as error:
        return NotCompiled(f"{NOT_LOADED}: {error}")


_SOLVED: dict[Path, float] = {}
"""How long [s] this process has solved with a library."""


@dataclass
class Optimised:
    """A program's functions from the machine's compiler, which is asked for them once they are worth it.

    Args:
        program: whose functions they are.
        source: what they follow from.
        compiler: to use.
        cache: where libraries are kept.
    """

    program: Program
    source: object
    compiler: Compiler
    cache: Cache
    _coming: Future[Library | NotCompiled] | None = None

    @property
    def kept(self) -> Library | None:
        """Those that were compiled before."""
        return kept_library(self.source, FUNCTION_FLAGS, self.compiler, self.cache)

    def after(self, quick: Library, seconds: float) -> Library | NotCompiled | None:
        """The functions, or why there are none, when it is known.

        Args:
            quick: the library that runs.
            seconds: that it has been solved with once more [s].
        Raises:
            OSError: a file cannot be read or written.
        """
        if self._coming:
            return self._coming.result() if self._coming.done() else None
        solved = _SOLVED[quick.path] = _SOLVED.get(quick.path, 0.0) + seconds
        if solved >= WORTH * quick.path.stat().st_size:
            texts = self.kept or _texts(self.program)  # CasADi stays in this thread
            if isinstance(texts, Library):
                return texts
            self._coming = in_background(
                lambda: built(self.source, lambda: texts, FUNCTION_FLAGS, self.compiler, self.cache, NICENESS)
            )
        return None


def _source(program: Program) -> object:
    """What the C of a program follows from."""
    expressions = ca.Function(
        "nlp", [program.symbols, program.given], [program.cost, program.rows]
    ).serialize()
    return code_digest(__name__), expressions, program.bounds, program.limits


def _texts(program: Program) -> Mapping[str, str]:
    return {"functions.c": program_text(program)}
