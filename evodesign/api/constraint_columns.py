"""What other optimisers are given of the constraints: a number for each, positive where it is violated."""

from __future__ import annotations

import math
from collections.abc import Sequence

from evodesign.analysis.front import minimised
from evodesign.records import Assessment, Objective

__all__ = ["CONSTRAINTS", "constraint_values"]

CONSTRAINTS = ("violation",)
"""Names of the columns: the distance to feasibility [m]."""


def constraint_values(objectives: Sequence[Objective], assessment: Assessment) -> tuple[float, ...]:
    """A number per name in `CONSTRAINTS`: zero where it holds, infinite where a failure left it unknown.

    A design that lacks an objective although nothing is violated counts as one of unknown violation: no
    optimiser could compare it.
    """
    violation = math.inf if assessment.violation is None else assessment.violation
    if violation == 0.0 and minimised(objectives, assessment) is None:
        violation = math.inf
    return (violation,)
