"""What other optimisers are given of the constraints: a number for each, positive where it is violated."""

from __future__ import annotations

import math
from collections.abc import Sequence

from evodesign.analysis.front import minimised
from evodesign.records import Assessment, Constraint, Objective
from evodesign.violations import HEIGHT, missed_height, violation_terms


def constraint_names(constraints: Sequence[Constraint]) -> tuple[str, ...]:
    """Names of the columns: `height`, then the problem's constraints."""
    return (HEIGHT, *(constraint.name for constraint in constraints))


def constraint_values(
    objectives: Sequence[Objective], constraints: Sequence[Constraint], assessment: Assessment
) -> tuple[float, ...]:
    """A number per name: missed metres of height, relative excesses of bounds, which add up to the violation.

    Zero where a constraint holds, infinite where a failure left it unknown. A design that lacks an objective
    although nothing is violated counts as one of unknown violation: no optimiser could compare it.
    """
    missed = missed_height(assessment.reach, assessment.cases) if constraints else assessment.violation
    if assessment.violation == 0.0 and minimised(objectives, assessment) is None:
        missed = None
    terms = violation_terms(constraints, assessment.constrained, missed)
    return tuple(math.inf if term is None else term for term in terms.values())
