"""Programs of random sparse structure, whose numbers are parameters: one compilation serves many of them."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from evodesign.nlp.program import ConstraintBlock, Program, Variable

Array = NDArray[np.float64]

FILLED = 0.3
"""Share of entries of sparse matrices that are there."""


@dataclass(frozen=True)
class RandomProgram:
    """A program and how many numbers it is given.

    Args:
        program: with one parameter, `numbers`.
        numbers: its length.
    """

    program: Program
    numbers: int


class Numbers:
    """Hands out symbols for numbers, one after the other."""

    def __init__(self) -> None:
        self.taken: list[ca.SX] = []

    def __call__(self) -> ca.SX:
        self.taken.append(ca.SX.sym(f"number{len(self.taken)}"))
        return self.taken[-1]


def random_program(seed: int, *, convex: bool) -> RandomProgram:
    """Sparse squares, or sines and products, over box, equalities and inequalities.

    The equalities and inequalities hold at zero, or are loose there, so that the program is feasible; without
    `convex` the cost and the rows are curved either way.
    """
    rng, number = np.random.default_rng(seed), Numbers()
    count = int(rng.integers(4, 12))
    x = ca.SX.sym("x", count)
    cost = ca.SX(0)
    for row in range(count + 2):
        chosen = np.flatnonzero(rng.uniform(size=count) < FILLED)
        residual = sum((number() * x[int(i)] for i in chosen), number())
        cost += residual**2
        if not convex and len(chosen):
            cost += (
                number() * ca.sin(2.0 * x[int(chosen[0])]) + number() * x[int(chosen[-1])] * x[row % count]
            )
    equalities, inequalities = [], []
    for row in range(count // 3):
        chosen = np.flatnonzero(rng.uniform(size=count) < FILLED)
        line = number() * x[row] + sum(number() * x[int(i)] for i in chosen)
        equalities.append(line if convex else line + number() * ca.sin(x[row]) * x[-1])
    for row in range(count // 2):
        chosen = np.flatnonzero(rng.uniform(size=count) < FILLED)
        line = sum((number() * x[int(i)] for i in chosen), number() * x[-1 - row])
        inequalities.append(line + (x[row] ** 2 if convex else number() * x[row] * x[-1]))
    lower, upper = np.full(count, -2.0), np.full(count, 2.0)
    lower[0], upper[-1] = -np.inf, np.inf
    lower[1] = upper[1] = 0.0  # one value only
    constraints = [ConstraintBlock("above", ca.vertcat(*inequalities), -np.inf, 1.0)]
    if equalities:
        constraints.append(ConstraintBlock("equal", ca.vertcat(*equalities), 0.0, 0.0))
    return RandomProgram(
        Program(
            name=f"random{seed}",
            variables=(Variable("x", x, 1.0, lower, upper, np.full(count, 0.1)),),
            constraints=tuple(constraints),
            cost=cost + 1e-3 * ca.sumsqr(x),
            parameters={"numbers": ca.vertcat(*number.taken)},
        ),
        len(number.taken),
    )
