"""Which constraints a design violates, by how much, and the one number that designs are ranked by.

A design must hold the load at every required height, and keep every constrained quantity within its bounds.
With d_i the distance [m] of the i-th required height from the interval of heights within reach, and b the
bound that a quantity q exceeds,

    violation = sum_i d_i + sum_q e_q        e_q = |q - b| / |b|,  or |q - b| in q's unit where b is 0

so a metre of height counts as much as the whole of a bound. The torques of a design that misses a height do
not exist; such a quantity counts as violated by the whole of its bound, e_q = 1. Where all heights are within
reach but a posture was not found, or a quantity does not exist for another reason, the violation is unknown.

Of a design whose build brings bodies together no posture is sought. What they lack [m] to be as far apart as
asked while all joints are at zero is the excess of `bodies_apart` over its lower bound 0.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import msgspec

from evodesign.records import Assessment, CaseOutcome, Constraint, ReachOutcome, Status

HEIGHT = "height"
"""Name of the constraint that every problem has: that the load is held at all required heights."""

BODIES_APART = "bodies_apart"
"""By how much bodies that some design's build brings together are farther apart than asked [m], and the
constraint that this is positive, which every problem has where bodies keep clear of each other."""

PARTS_APART = "parts_apart"
"""How much room the parts of a robot have that have least, or minus what all lack [m], and the constraint
that this is positive, which every problem has where actuators are bodies (`collision.parts`)."""

WHOLE_BOUND = 1.0
"""Relative excess of a quantity that does not exist because a height is missed, or no posture was sought."""


def excess(constraint: Constraint, value: float) -> float:
    """How far a value lies beyond the bound that it exceeds, in its unit; zero within the bounds."""
    below = 0.0 if constraint.lower is None else constraint.lower - value
    above = 0.0 if constraint.upper is None else value - constraint.upper
    return max(below, above, 0.0)


def missed_height(reach: ReachOutcome | None, cases: Sequence[CaseOutcome]) -> float | None:
    """Sum over tasks of the distance of the worst of their heights from the interval within reach [m].

    None when a failure hides it: the reach is unknown, or a case within reach was not solved. Zero where the
    reach is unknown of a design whose bodies are in each other.
    """
    if reach is None or reach.lowest_m is None or reach.highest_m is None:
        return _unasked(cases)
    total = 0.0
    for outcome in cases:
        distance = max(
            max(reach.lowest_m - height, height - reach.highest_m, 0.0)
            for height in outcome.case.task.heights
        )
        if distance == 0.0 and outcome.status not in (Status.SOLVED, Status.BODIES_OVERLAP):
            return None
        total += distance if outcome.case.pair == cases[0].case.pair else 0.0  # the same for everyone
    return total


def _unasked(cases: Sequence[CaseOutcome]) -> float | None:
    """What counts of heights where the reach is unknown [m]: nothing if bodies in each other explain it."""
    return 0.0 if any(outcome.status is Status.BODIES_OVERLAP for outcome in cases) else None


def height_margin(reach: ReachOutcome | None, cases: Sequence[CaseOutcome]) -> float | None:
    """How far the worst required height lies beyond the interval within reach [m]; negative within it.

    None when the reach is unknown, but zero of a design whose bodies are in each other.
    """
    if reach is None or reach.lowest_m is None or reach.highest_m is None:
        return _unasked(cases)
    heights = [height for outcome in cases for height in outcome.case.task.heights]
    return max(reach.lowest_m - min(heights), max(heights) - reach.highest_m)


def bound_margin(constraint: Constraint, value: float) -> tuple[float, float]:
    """How far a quantity lies beyond its nearest bound, relative to it, and the derivative by the quantity.

    Negative within the bounds: where it is positive, it is the excess of which `total_violation` is made.
    """
    sides = ((constraint.lower, -1.0), (constraint.upper, 1.0))
    margins = [
        (sign * (value - bound) / (abs(bound) or 1.0), sign / (abs(bound) or 1.0))
        for bound, sign in sides
        if bound is not None
    ]
    return max(margins)


def total_violation(
    constraints: Sequence[Constraint], values: Mapping[str, float], missed: float | None
) -> float | None:
    """What designs are ranked by: zero for a feasible design, None where it is unknown.

    Args:
        constraints: of the problem.
        values: of constrained quantities that exist, by name.
        missed: see `missed_height` [m].
    """
    total = 0.0
    for term in violation_terms(constraints, values, missed).values():
        if term is None:
            return None
        total += term
    return total


def violation_terms(
    constraints: Sequence[Constraint], values: Mapping[str, float], missed: float | None
) -> dict[str, float | None]:
    """The terms of `total_violation` by name of the constraint, None for those that are unknown."""
    terms: dict[str, float | None] = {HEIGHT: missed}
    absent = WHOLE_BOUND if missed or values.get(BODIES_APART, 0.0) < 0.0 else None
    for constraint in constraints:
        value = values.get(constraint.name)
        terms[constraint.name] = absent if value is None else _relative_excess(constraint, value)
    return terms


def _relative_excess(constraint: Constraint, value: float) -> float:
    bound = constraint.upper
    if bound is None or (constraint.lower is not None and value < constraint.lower):
        bound = constraint.lower
    return excess(constraint, value) / (abs(bound or 0.0) or 1.0)


def violations(constraints: Sequence[Constraint], assessment: Assessment) -> dict[str, float | None]:
    """By how much a design violates each constraint, by name and in its unit; zero where one holds.

    `height` is the missed height [m]. None stands for a value that does not exist.
    """
    missed = missed_height(assessment.reach, assessment.cases) if constraints else assessment.violation
    found: dict[str, float | None] = {HEIGHT: missed}
    for constraint in constraints:
        value = assessment.constrained.get(constraint.name)
        found[constraint.name] = None if value is None else excess(constraint, value)
    return found


def constraint_sentences(constraints: Sequence[Constraint], assessment: Assessment) -> tuple[str, ...]:
    """A clause for each quantity beyond its bounds, such as `mass is 3.2 kg above 65 kg`."""
    found = violations(constraints, assessment)
    return tuple(
        f"{_words(constraint)} is {_figure(constraint, much)} {_beyond(constraint, assessment)}"
        for constraint in constraints
        if (much := found[constraint.name]) and not _is_reported(constraint, assessment)
    )


def reason_of_infeasibility(constraints: Sequence[Constraint], assessment: Assessment) -> str:
    """Why a design is not feasible: the reason of its status unless that is SOLVED, and exceeded bounds."""
    beyond = constraint_sentences(constraints, assessment)
    failed = () if assessment.status is Status.SOLVED and beyond else (assessment.reason,)
    return "; ".join((*failed, *beyond))


def _is_reported(constraint: Constraint, assessment: Assessment) -> bool:
    """Whether the reason of a design's status says it already."""
    return constraint.name == BODIES_APART and assessment.status is Status.BODIES_OVERLAP


def exceeded_bounds(constraints: Sequence[Constraint], assessment: Assessment) -> tuple[str, ...]:
    """The bounds beyond which a design lies, such as `mass above 65 kg`."""
    found = violations(constraints, assessment)
    return tuple(
        f"{_words(constraint)} {_beyond(constraint, assessment)}"
        for constraint in constraints
        if found[constraint.name]
    )


def bounds_text(constraint: Constraint) -> str:
    """The bounds in words: `at most 65 kg`, `at least 1.5 m`, `1.5 to 2 m`."""
    if constraint.lower is None or constraint.upper is None:
        word = "at most" if constraint.lower is None else "at least"
        bound = constraint.upper if constraint.lower is None else constraint.lower
        return f"{word} {_figure(constraint, bound or 0.0)}"
    return f"{constraint.lower:.4g} to {_figure(constraint, constraint.upper)}"


def constraints_json(constraints: Sequence[Constraint], assessment: Assessment) -> list[dict[str, Any]]:
    """Each constraint with a design's value and violation, as JSON files have it."""
    found = violations(constraints, assessment)
    return [
        {
            **msgspec.to_builtins(constraint),
            "value": assessment.constrained.get(constraint.name),
            "violation": found[constraint.name],
        }
        for constraint in constraints
    ]


def _words(constraint: Constraint) -> str:
    return constraint.name.replace("_", " ")


def _beyond(constraint: Constraint, assessment: Assessment) -> str:
    lower, value = constraint.lower, assessment.constrained[constraint.name]
    if lower is not None and value < lower:
        return f"below {_figure(constraint, lower)}"
    return f"above {_figure(constraint, constraint.upper or 0.0)}"


def _figure(constraint: Constraint, value: float) -> str:
    return f"{value:.4g}" if constraint.unit == "1" else f"{value:.4g} {constraint.unit}"
