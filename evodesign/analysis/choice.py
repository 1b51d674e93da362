"""Choosing among the designs of a run: conditions first, then the front, then an order, then how many.

Conditions come before the front, as constraints do: the front is that of the designs that meet them, so that
a design that is dominated only by a forbidden one is on it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum

from evodesign.analysis.conditions import Condition, meeting
from evodesign.analysis.decision_making import closest, knees, most_different
from evodesign.analysis.front import front, to_minimise
from evodesign.records import Evaluation, Objective


class Order(StrEnum):
    """Which designs of the front are chosen, and in which order."""

    FIRST_OBJECTIVE = "first objective"
    KNEE = "knee"
    NEAR = "near"
    DIFFERENT = "different"


@dataclass(frozen=True, slots=True)
class Choice:
    """What somebody asks for.

    Args:
        where: conditions that every design must meet.
        order: all of the front, best first in its first objective; its knees, sharpest first; all of it,
            closest to the aspiration first; or its most different designs.
        aspiration: natural values hoped for, by objective, for the order `near`.
        limit: how many at most; None for all.
    """

    where: tuple[Condition, ...] = ()
    order: Order = Order.FIRST_OBJECTIVE
    aspiration: Mapping[str, float] = field(default_factory=dict)
    limit: int | None = None


@dataclass(frozen=True, slots=True)
class Chosen:
    """What was chosen.

    Args:
        designs: in the order asked for.
        front: the front that they were chosen from, in order of number.
        found: how many there were before the limit.
    """

    designs: tuple[Evaluation, ...]
    front: tuple[Evaluation, ...]
    found: int


def choose(objectives: Sequence[Objective], evaluations: Sequence[Evaluation], choice: Choice) -> Chosen:
    """The designs of a run that a choice asks for.

    Raises:
        InputError: the aspiration names something that is no objective.
    """
    candidates = front(objectives, meeting(evaluations, choice.where))
    ordered = _ordered(objectives, candidates, choice)
    return Chosen(ordered[: choice.limit], candidates, len(ordered))


def _ordered(
    objectives: Sequence[Objective], candidates: tuple[Evaluation, ...], choice: Choice
) -> tuple[Evaluation, ...]:
    match choice.order:
        case Order.KNEE:
            return knees(objectives, candidates)
        case Order.NEAR:
            return closest(objectives, candidates, choice.aspiration)
        case Order.DIFFERENT:
            count = len(candidates) if choice.limit is None else choice.limit
            return most_different(candidates, count)
        case Order.FIRST_OBJECTIVE:
            first = objectives[0]
            values = {each.number: each.assessment.objectives[first.name] for each in candidates}
            return tuple(sorted(candidates, key=lambda each: to_minimise(first, values[each.number])))
