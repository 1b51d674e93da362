"""Polishing: one design made better by going downhill on its exact gradients.

What is minimised is a weighted sum of objectives, each relative to its value at the design that is polished,
maximised ones with the opposite sign. Every design on the way is evaluated as a search would evaluate it, and
counts only if it holds the load at every required height and meets every constraint: how far the required
heights lie within reach, and constrained quantities within their bounds, are the margins of the descent.
Without weights all objectives count alike and none may get worse; then each is a margin too. Between
materials there is nothing to descend on, so a density that is one's stays as it is.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from evodesign.errors import InputError, nearest_name
from evodesign.evaluation.evaluate import Evaluator
from evodesign.evaluation.sensitivities import ObjectiveSensitivity, Sensitivities
from evodesign.nlp.optimality import Array, NotDifferentiable
from evodesign.posture.solution_derivative import ReachDerivative
from evodesign.problem.build import DesignProblem
from evodesign.quantities.design_result import DesignResult
from evodesign.records import Assessment, Constraint, Genome, Sense
from evodesign.searches.descent import Iterate, Slopes, descend
from evodesign.violations import reason_of_infeasibility

AS_GOOD = 1e-6
"""Relative change for the worse of an objective that counts as none."""


@dataclass(frozen=True, slots=True)
class Aim:
    """What is to get better.

    Args:
        weights: positive, by objective; what is not named may change as it likes.
        none_worse: whether each of them must stay as good as it was.
    """

    weights: Mapping[str, float]
    none_worse: bool


def aim_of(problem: DesignProblem, weights: Mapping[str, float], option: str) -> Aim:
    """The aim that weights ask for; none at all ask for everything at once.

    Args:
        problem: whose objectives they are.
        weights: by objective; may be empty.
        option: the name of the option that gave them, for messages.
    Raises:
        InputError: an objective that the problem does not have, or a weight that is not positive.
    """
    names = [objective.name for objective in problem.objectives]
    for name, weight in weights.items():
        if name not in names:
            found = f"'{name}'{nearest_name(name, names)}"
            raise InputError(option, "", f"one of the problem's objectives {', '.join(names)}", found)
        if not (weight > 0.0 and np.isfinite(weight)):
            raise InputError(option, "", f"a positive weight of {name}", f"{weight:g}")
    return Aim(weights, False) if weights else Aim(dict.fromkeys(names, 1.0), True)


@dataclass(frozen=True, slots=True)
class Step:
    """One evaluation of a polish: its number, what it found, and whether it is the best so far."""

    number: int
    assessment: Assessment
    taken: bool


@dataclass(frozen=True, slots=True)
class Polished:
    """A design before and after.

    Args:
        before, after: results of the design before and after.
        values: of the polished design, one number per parameter.
        evaluations: how many designs were evaluated, the first one included.
        reason: why it ended, in a sentence.
    """

    before: Assessment
    after: Assessment
    values: tuple[float, ...]
    evaluations: int
    reason: str


def polish(
    evaluator: Evaluator, genome: Genome, aim: Aim, evaluations: int, watch: Callable[[Step], None]
) -> Polished:
    """Improve a design.

    Args:
        evaluator: of the design's problem.
        genome: of the design.
        aim: what is to get better.
        evaluations: how many designs may be evaluated.
        watch: is told of every evaluation after the first.
    Raises:
        InputError: the design does not hold the load at every required height, or violates a constraint.
    """
    slope = _Slope(evaluator, genome, aim)
    found = descend(
        slope,
        slope.start,
        evaluations - 1,
        lambda number, _, taken: watch(Step(number + 1, slope.last, taken)),
    )
    best = slope.known[_key(found.best.position)]
    return Polished(
        before=slope.first,
        after=best.assessment,
        values=best.values,
        evaluations=found.looks + 1,
        reason=found.reason,
    )


@dataclass(frozen=True, slots=True)
class _Evaluated:
    values: tuple[float, ...]
    result: DesignResult
    assessment: Assessment


class _Slope:
    """The landscape that a polish descends; it remembers what it was shown.

    Attributes:
        first: results of the design to be polished.
        last: results of the design looked at last.
        start: where the descent begins.
        known: designs that exist, by position.
    """

    def __init__(self, evaluator: Evaluator, genome: Genome, aim: Aim) -> None:
        self._evaluator, self._aim = evaluator, aim
        self._problem = problem = evaluator.problem
        self._sensitivities = Sensitivities(problem, evaluator.known)
        self._signs = {o.name: 1.0 if o.sense is Sense.MINIMISE else -1.0 for o in problem.objectives}
        self.known: dict[bytes, _Evaluated] = {}
        position = np.array(genome, float)
        self.first = self.last = self._evaluate(position).assessment
        start = self._point(position, self.last)
        if start is None:
            why = reason_of_infeasibility(problem.constraints, self.first)
            wanted = "a design that holds the load at every required height"
            wanted += " and meets every constraint" if problem.constraints else ""
            found = f"a design whose violation is {self.first.violation} ({why})"
            raise InputError("DESIGN", "", wanted, found)
        self.start = start

    def look(self, position: Array) -> Iterate | None:
        """The design at a position of the unit cube, if it is a design that counts."""
        self.last = self._evaluate(position).assessment
        return self._point(position, self.last)

    def slopes(self, point: Iterate) -> Slopes | None:
        """The derivatives of a design that was looked at."""
        design = self.known[_key(point.position)]
        derivative = self._sensitivities.at(design.values, design.result)
        moves = derivative.sensitivities()
        pairs = enumerate(zip(self._problem.space.parameters, design.values, strict=True))
        free = {place: p.record.slope_at(value) for place, (p, value) in pairs if not p.is_fixed}
        ranges = np.array([*free.values()])
        relative: dict[str, Array] = {}
        for name in self._aim.weights:
            gradient = _per_range(moves[name], ranges)
            if gradient is None:
                return None
            relative[name] = self._signs[name] * gradient / self._scale(name)
        value = sum(
            (weight * relative[name] for name, weight in self._aim.weights.items()),
            start=np.zeros(len(ranges)),
        )
        ends = [_turned(derivative.highest, free), -_turned(derivative.lowest, free)]
        bounds = [
            sign * (np.zeros(len(ranges)) if gradient is None else gradient)
            for constraint in self._problem.constraints
            for gradient in (_per_range(moves[constraint.name], ranges),)
            for sign, _ in _bounds(constraint)
        ]
        kept = [-slope for slope in relative.values()] if self._aim.none_worse else []
        return Slopes(value, np.array([*ends, *bounds, *kept]))

    def _evaluate(self, position: Array) -> _Evaluated:
        values = self._problem.space.values(tuple(position.tolist()))
        result = self._evaluator.solve(values)
        found = _Evaluated(values, result, self._evaluator.assessment(values, result))
        self.known[_key(position)] = found
        return found

    def _point(self, position: Array, found: Assessment) -> Iterate | None:
        """A design as a point, unless it is not feasible or gets worse where nothing may."""
        margins = _within_reach(found, [height for task in self._problem.tasks for height in task.heights])
        if margins is None or not set(self._aim.weights) <= set(found.objectives):
            return None
        margins += [
            sign * (found.constrained[constraint.name] - bound)
            for constraint in self._problem.constraints
            for sign, bound in _bounds(constraint)
        ]
        worse = {
            name: self._signs[name]
            * (found.objectives[name] - self.first.objectives[name])
            / self._scale(name)
            for name in self._aim.weights
        }
        if self._aim.none_worse:
            if max(worse.values()) > AS_GOOD:
                return None
            margins += [max(-much, 0.0) for much in worse.values()]
        value = sum(weight * worse[name] for name, weight in self._aim.weights.items())
        return Iterate(position, value, np.array(margins))

    def _scale(self, name: str) -> float:
        """The size of an objective at the start."""
        return abs(self.first.objectives[name]) or 1.0


def _within_reach(found: Assessment, heights: Sequence[float]) -> list[float] | None:
    """How far within reach [m] the required heights lie, at both ends; None if it is not feasible."""
    if found.violation != 0.0 or found.reach is None:
        return None
    highest, lowest = found.reach.highest_m, found.reach.lowest_m
    if highest is None or lowest is None:
        return None
    return [highest - max(heights), min(heights) - lowest]


def _bounds(constraint: Constraint) -> list[tuple[float, float]]:
    """The bounds that there are, each with the sign that makes room to it positive."""
    both = ((1.0, constraint.lower), (-1.0, constraint.upper))
    return [(sign, bound) for sign, bound in both if bound is not None]


def _per_range(sensitivity: ObjectiveSensitivity, ranges: Array) -> Array | None:
    """A quantity's derivative per range of each parameter; None where it does not exist."""
    gradient = sensitivity.gradient
    return None if gradient is None else np.array(list(gradient.values())) * ranges


def _turned(derivative: ReachDerivative | NotDifferentiable, ranges: Mapping[int, float]) -> Array:
    """The slope of an end of reach per range; none where it does not exist: evaluations alone guard it.

    Args:
        derivative: by all parameters.
        ranges: of the free ones, by their places.
    """
    if isinstance(derivative, NotDifferentiable):
        return np.zeros(len(ranges))
    return np.array([derivative.slope[place] * of_range for place, of_range in ranges.items()])


def _key(position: Array) -> bytes:
    return position.tobytes()
