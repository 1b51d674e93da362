"""Solvers that are built once, however many scenes need them.

The load's mass is a number that every program is given, and a robot's program knows of the person only what
the load passes on. So scenes that differ in the mass of their load alone share all programs, and scenes that
differ in the person share the robot's.
"""

from __future__ import annotations

from collections.abc import Callable

from evodesign.nlp.program import Program
from evodesign.nlp.solver import IpoptOptions, Solver

__all__ = ["SolverCache"]


class SolverCache:
    """Solvers by what their programs follow from."""

    def __init__(self) -> None:
        self._solvers: dict[tuple[str, IpoptOptions], Solver] = {}

    def solver(self, key: str, program: Callable[[], Program], options: IpoptOptions) -> Solver:
        """The solver of a program, built when it is first asked for.

        Args:
            key: of everything that the program follows from.
            program: builds it.
            options: of the solver.
        """
        if (key, options) not in self._solvers:
            self._solvers[key, options] = Solver(program(), options)
        return self._solvers[key, options]
