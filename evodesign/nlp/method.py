"""What a method that solves programs is asked for, and what it gives back.

Source: Waechter and Biegler, Mathematical Programming 106 (2006), 25-57, for both methods.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Protocol

from evodesign.nlp.codegen import CompiledFunctions, Library
from evodesign.nlp.compiler import NotCompiled
from evodesign.nlp.program import Array

NEAR_BARRIER = 1e-8
"""Barrier parameter of a solve that begins at a solution."""

NEAR_PUSH = 1e-9
"""How far such a solve keeps its start off the bounds, relative to their size."""


class MethodName(StrEnum):
    """Who solves: our interior-point method in C, or IPOPT, which it follows."""

    NATIVE = "native"
    IPOPT = "ipopt"


@dataclass(frozen=True, slots=True)
class SolverOptions:
    """Settings; the values are what measured best on posture problems (docs/benchmarks.md).

    Args:
        tolerance: of the scaled optimality error; bounds are taken as wider by as much, at most 1e-8.
        iterations: limit.
        seconds: limit of wall time per solve [s].
        compiled: whether the program's functions run as machine code; results are the same, sooner.
        near: whether solves begin at a solution, to be found again more exactly: the barrier starts small,
            and bounds are taken as they are.
        seldom: whether solves are so few that the compiler had better be quick than its code.
        method: who solves; IPOPT, whatever is asked for, where nothing is compiled.
    """

    tolerance: float = 1e-8
    iterations: int = 300
    seconds: float = 20.0
    compiled: bool = False
    near: bool = False
    seldom: bool = False
    method: MethodName = MethodName.IPOPT

    def __post_init__(self) -> None:
        """Native is compiled."""
        if not self.compiled:
            object.__setattr__(self, "method", MethodName.IPOPT)


@dataclass(frozen=True, slots=True)
class Ending:
    """The end of a solve, in the program's own units.

    Args:
        symbols: of the last iterate.
        cost: there.
        word: IPOPT's for what ended the solve.
        iterations: number of iterations.
        bounds, rows: multipliers, positive at an upper limit.
        cost_slope: derivative of the optimal cost with respect to the program's `given`.
    """

    symbols: Array
    cost: float
    word: str
    iterations: int
    bounds: Array
    rows: Array
    cost_slope: Array


class Method(Protocol):
    """Solves one program, any number of times."""

    name: MethodName

    @property
    def functions(self) -> CompiledFunctions | Library | NotCompiled:
        """The machine code that evaluates the program, or why CasADi's virtual machine does."""
        ...

    def solve(self, options: SolverOptions, start: Array, parameters: Array) -> Ending:
        """Solve from a start, in the program's own units."""
        ...
