"""How load cases count together: one posture, and wrenches and torques of its own for each disturbance.

With K_c the cost of what is carried in load case c (both agents' weighted efforts and the regularisation of
their wrenches; the undisturbed case is one of them), n cases count together as

    mean     sum_c K_c / n
    worst    (1 - e) s + e sum_c K_c / n    with s >= K_c for every c, and e = 0.01

beside the regularisation of the posture. A posture's wrenches in each case minimise K_c, whatever the weights
of the cases: the small share e of the mean sees to those cases that are not the worst. So a disturbance of
size zero leaves the undisturbed problem's optimum as it is, in both ways.

Source: epigraph form of a minimax problem: Boyd and Vandenberghe, Convex Optimization, section 4.1.3.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np

from evodesign.mechanics.disturbance import OverCases
from evodesign.nlp.buffered import BufferedFunction
from evodesign.nlp.program import ConstraintBlock, Expression, Program, Start, Variable

SHARE_OF_MEAN = 0.01
"""e: what the mean counts beside the worst case."""

WORST = "worst.cost"
"""Name of s, and of the rows K_c - s."""


def aggregated(program: Program, effort: OverCases, costs: Sequence[Expression]) -> Program:
    """A program that minimises the costs of its load cases beside the cost that it has.

    Args:
        program: whose cost is that of the posture itself.
        effort: how the cases count together.
        costs: K_c of each case, the undisturbed one among them.
    """
    cost, variables, constraints = counted_together(effort, costs)
    return replace(
        program,
        variables=(*program.variables, *variables),
        constraints=(*program.constraints, *constraints),
        cost=program.cost + cost,
    )


def counted_together(
    effort: OverCases, costs: Sequence[Expression]
) -> tuple[Expression, tuple[Variable, ...], tuple[ConstraintBlock, ...]]:
    """What load cases cost together, with the variable s and the rows K_c - s where the worst counts.

    Args:
        effort: how the cases count together.
        costs: K_c of each case, the undisturbed one among them.
    """
    mean = sum(costs) / len(costs)
    if effort is OverCases.MEAN:
        return mean, (), ()
    worst = Variable.column(WORST, [0.0], [np.inf], [0.0], 1.0)
    below = ConstraintBlock(WORST, ca.vertcat(*costs) - worst.value, -np.inf, 0.0)
    return (1.0 - SHARE_OF_MEAN) * worst.value + SHARE_OF_MEAN * mean, (worst,), (below,)


class WorstCase:
    """The variable s of a program, as its load cases ask for it at a start.

    Args:
        program: of any load cases; one without s leaves starts as they are.
    """

    def __init__(self, program: Program) -> None:
        self._program = program
        self._above: BufferedFunction | None = None
        for row in program.constraints:
            if row.name == WORST:
                given = [program.symbols, program.given]
                self._above = BufferedFunction(ca.Function("above", given, [ca.densify(row.expression)]))

    def put(self, start: Start, parameters: Mapping[str, Any]) -> Start:
        """A start with s as low as it may be."""
        if self._above is None:
            return start
        program = self._program
        (above,) = self._above(
            program.packed({**start, WORST: [0.0]}), program.packed_parameters(parameters, start)
        )
        return {**start, WORST: [float(above.max())]}
