"""How a design's objectives move with its parameters, and where they stop moving smoothly.

Postures and reach have exact derivatives (`posture.solution_derivative`), so the results of a neighbouring
design are known to first order. An objective is a function of such results; its derivative is that function's
along the exact tangent, by five-point differences,

    f' = (f(-2t) - 8 f(-t) + 8 f(t) - f(2t)) / 12 t        t = one part in 10^4 of the parameter's range

which for formulas of a few operations agree with the exact derivative to about 1e-9. So an objective needs
nothing beyond its function to have a gradient.

What an objective depends on shows when it is taken away: an objective that does not exist without a case's
posture gets that case's notes. A solution is one of several local optima, held by some of its limits. Its
derivative holds as long as the same optimum wins and the same limits hold; the notes say how far that is.

Beyond 300 lines: the sentences on why nothing is smooth belong to the derivatives that they replace.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np

from evodesign.design.parameter import DesignParameter
from evodesign.evaluation.inner import InnerProblems, inner_problems
from evodesign.evaluation.sized_slopes import CaseDerivative, along_design, program_slopes, reach_along_design
from evodesign.evaluation.trees_beside import TreesBeside
from evodesign.mechanics.robot_gradient import RobotGradient
from evodesign.motion.derivative import LiftDerivative
from evodesign.motion.solution import MotionCase
from evodesign.nlp.optimality import Array, NotDifferentiable
from evodesign.nlp.sensitivity import Limit
from evodesign.posture.formulations.reach import HIGHEST, LOWEST
from evodesign.posture.precompute.precomputed import NOTHING_PRECOMPUTED, Precomputed
from evodesign.posture.results import CaseSolution
from evodesign.posture.solution_derivative import ReachDerivative
from evodesign.problem.build import DesignProblem
from evodesign.quantities.design_result import DesignResult
from evodesign.quantities.objectives import objective_value
from evodesign.records import Status

STEP = 1e-4
"""Step of the differences, as a share of a parameter's range."""


@dataclass(frozen=True, slots=True)
class ObjectiveSensitivity:
    """How one objective moves.

    Args:
        gradient: derivative by parameter name, in the objective's unit per unit of the parameter; None where
            the objective has none.
        notes: sentences on where, how near and why the derivative does not exist.
    """

    gradient: Mapping[str, float] | None
    notes: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class DesignDerivative:
    """A design's results, made exact, and how they move.

    Args:
        problem: whose design it is.
        values: of the design, one number per parameter.
        result: what was computed of it.
        cases: one derivative per case; a reason where there is none.
        highest, lowest: tangents of the reach.
        given: the derivatives of what programs are given; None where that is the design itself.
    """

    problem: DesignProblem
    values: tuple[float, ...]
    result: DesignResult
    cases: tuple[CaseDerivative | NotDifferentiable, ...]
    highest: ReachDerivative | NotDifferentiable
    lowest: ReachDerivative | NotDifferentiable
    given: Array | None = None

    def moved(self, step: Array) -> DesignResult:
        """To first order, the results of a design that differs by a step; what has no tangent is left out."""
        along = step if self.given is None else self.given @ step
        values = np.array(self.result.program_values) + along
        tree = self.problem.space.resized(self.result.scenes[0].designed_tree, values.tolist())
        reach = replace(self.result.reach, highest=_end(self.highest, step), lowest=_end(self.lowest, step))
        cases = tuple(
            _moved(solution, derivative, step)
            for solution, derivative in zip(self.result.cases, self.cases, strict=True)
        )
        return replace(self.result, tree=tree, reach=reach, cases=cases)

    def sensitivities(self) -> dict[str, ObjectiveSensitivity]:
        """How each objective and constrained quantity of the problem moves that exists for the design."""
        problem = self.problem
        names = dict.fromkeys([*(o.name for o in problem.objectives), *(c.name for c in problem.constraints)])
        existing = [name for name in names if objective_value(name, self.result) is not None]
        parameters = enumerate(problem.space.parameters)
        around = {p.name: self._around(position) for position, p in parameters if not p.is_fixed}
        return {name: self._sensitivity(name, around) for name in existing}

    def _around(self, position: int) -> tuple[float, tuple[DesignResult, ...]]:
        """Step and results at -2, -1, 0, 1 and 2 steps along one parameter."""
        step = STEP * _scale(self.problem.space.parameters[position], self.values[position])
        unit = np.eye(len(self.values))[position]
        return step, tuple(self.moved(count * step * unit) for count in range(-2, 3))

    def _sensitivity(
        self, name: str, around: Mapping[str, tuple[float, Sequence[DesignResult]]]
    ) -> ObjectiveSensitivity:
        value = partial(objective_value, name)
        notes = self._notes_of(name)
        gradient: dict[str, float] = {}
        for parameter, (step, results) in around.items():
            found = [x for result in results if (x := value(result)) is not None]
            if len(found) < len(results):
                return ObjectiveSensitivity(None, tuple(notes))
            gradient[parameter] = five_point(found, step)
            if _not_smooth(found):
                notes.append(f"its formula has a kink in {parameter}, where another value becomes largest")
        return ObjectiveSensitivity(gradient, tuple(notes))

    def _notes_of(self, name: str) -> list[str]:
        """Sentences on every part of the results that an objective depends on."""
        value, result = partial(objective_value, name), self.result
        said: list[str] = []
        for solution, derivative in zip(result.cases, self.cases, strict=True):
            others = [_without(each) if each.case == solution.case else each for each in result.cases]
            if solution.solved and value(replace(result, cases=tuple(others))) is None:
                said += posture_notes(self.problem, solution, derivative)
        if value(replace(result, reach=replace(result.reach, highest=None))) is None:
            said += reach_notes(self.problem, "highest", self.highest)
        if value(replace(result, reach=replace(result.reach, lowest=None))) is None:
            said += reach_notes(self.problem, "lowest", self.lowest)
        return said


class Sensitivities:
    """Tangents of a problem's designs.

    Args:
        problem: whose designs they are.
        known: what is known beforehand.
        inner: its inner problems, where they are built already.
    """

    def __init__(
        self,
        problem: DesignProblem,
        known: Precomputed = NOTHING_PRECOMPUTED,
        inner: InnerProblems | None = None,
    ) -> None:
        self._problem = problem
        self._inner = inner or inner_problems(problem, known)
        self._family = problem.space.family(problem.scene.designed_tree)

    @cached_property
    def robot(self) -> RobotGradient | None:
        """Derivatives of what depends on the designed robot alone; None without one."""
        designed = self._problem.scene.designed
        return RobotGradient(self._family, designed[0], self._problem.stances) if designed else None

    def beside(self, result: DesignResult) -> TreesBeside:
        """The robots of designs beside one, from its results."""
        return TreesBeside(self._family, result.program_values)

    def at(self, values: Sequence[float], result: DesignResult) -> DesignDerivative:
        """The tangent of a design from its results."""
        given = result.program_values
        cases = [self.of_case(given, solution) for solution in result.cases]
        slopes = program_slopes(result, cases, self.robot)
        highest, lowest = (self.of_reach(given, sense) for sense in (HIGHEST, LOWEST))
        return DesignDerivative(
            problem=self._problem,
            values=tuple(values),
            result=result,
            cases=tuple(along_design(each, slopes) for each in cases),
            highest=reach_along_design(highest, slopes),
            lowest=reach_along_design(lowest, slopes),
            given=None if isinstance(slopes, NotDifferentiable) else slopes,
        )

    def of_case(
        self, values: Sequence[float], solution: CaseSolution, *, exact: bool = True
    ) -> CaseDerivative | NotDifferentiable:
        """How the posture of a case, or its motion, moves with what programs are given."""
        if isinstance(solution, MotionCase):
            return self._inner.lifts[solution.case.pair].derivative(values, solution)
        return self._inner.postures[solution.case.pair].derivative(values, solution, exact=exact)

    def of_reach(
        self, values: Sequence[float], sense: float, *, exact: bool = True
    ) -> ReachDerivative | NotDifferentiable:
        """The extreme height of the load that binds: the least of the highest, the largest of the lowest."""
        found = [reach.derivative(values, sense, exact=exact) for reach in self._inner.reaches.values()]
        notes = [derivative for derivative in found if isinstance(derivative, NotDifferentiable)]
        ends = [derivative for derivative in found if isinstance(derivative, ReachDerivative)]
        return notes[0] if notes else max(ends, key=lambda derivative: sense * derivative.height)


def _end(derivative: ReachDerivative | NotDifferentiable, step: Array) -> float | None:
    return (
        None
        if isinstance(derivative, NotDifferentiable)
        else derivative.height + float(derivative.slope @ step)
    )


def _moved(
    solution: CaseSolution, derivative: CaseDerivative | NotDifferentiable, step: Array
) -> CaseSolution:
    if isinstance(derivative, NotDifferentiable):
        return _without(solution)
    if isinstance(solution, MotionCase) and isinstance(derivative, LiftDerivative):
        solution = solution.with_least_time_moved(derivative.least_slope, step)
    return replace(solution, instants=derivative.moved(step))


def _without(solution: CaseSolution) -> CaseSolution:
    """A case without its posture."""
    return replace(solution, status=Status.NUMERICAL_FAILURE, instants=(), residuals={})


def _scale(parameter: DesignParameter, value: float) -> float:
    """What the value changes by over the genome's range, or between the choices' ends."""
    return parameter.record.slope_at(value) or parameter.upper - parameter.lower


def five_point(values: Sequence[float], step: float) -> float:
    """Five-point difference."""
    return (8.0 * (values[3] - values[1]) - (values[4] - values[0])) / (12.0 * step)


def _not_smooth(values: Sequence[float]) -> bool:
    """Whether second differences grow with the step, as without a derivative, and not with its square."""
    near, far = (abs(values[2 - k] - 2.0 * values[2] + values[2 + k]) for k in (1, 2))
    return near > 1e-9 * max(1.0, abs(values[2])) and far < 3.0 * near


NEAR = 0.01
"""Share of a parameter's range within which a change of limits gets a sentence."""

DISTINCT = 1e-5
"""Relative difference of costs above which two optima are not the same."""


def posture_notes(
    problem: DesignProblem, solution: CaseSolution, derivative: CaseDerivative | NotDifferentiable
) -> Iterator[str]:
    """What is to be said of the posture in one case that was solved."""
    place = ", ".join(part for part in (f"at {solution.case.task}", solution.case.label) if part)
    yield f"{place}: {_winner(solution, derivative)}"
    if isinstance(derivative, NotDifferentiable):
        yield f"{place}: no gradient, for {derivative.reason}"
    else:
        yield from _near(problem, place, derivative.limits)


def reach_notes(
    problem: DesignProblem, which: str, derivative: ReachDerivative | NotDifferentiable
) -> Iterator[str]:
    """What is to be said of the highest or the lowest load."""
    place = f"{which} load"
    if isinstance(derivative, NotDifferentiable):
        yield f"{place}: no gradient, for {derivative.reason}"
        return
    other = (
        "the starts agree"
        if derivative.runner_up is None
        else f"the next best is {derivative.runner_up:.2g} m off"
    )
    yield f"{place}: start {derivative.start + 1} of {derivative.starts} won, {other}"
    yield from _near(problem, place, derivative.limits)


def _winner(solution: CaseSolution, derivative: CaseDerivative | NotDifferentiable) -> str:
    """Which start won, and how far behind the next best optimum of the same program is."""
    best = solution.attempt
    won = f"{best.name if best else 'no start'} won"
    if best is None or isinstance(derivative, NotDifferentiable):
        return won
    others = [a for a in solution.attempts if a.formulation == best.formulation and a.start != best.start]
    behind = [a.cost / derivative.cost - 1.0 for a in others if a.status is Status.SOLVED]
    distinct = [share for share in behind if share > DISTINCT]
    if not others:
        return f"{won}, the only start"
    return (
        f"{won}, the next best optimum costs {min(distinct):.2%} more"
        if distinct
        else f"{won}, no other was met"
    )


def _near(problem: DesignProblem, place: str, limits: Sequence[Limit]) -> Iterator[str]:
    """The change of limits that the least change of one parameter brings about, if it is near."""
    parameters = problem.space.parameters
    ranges = np.array([p.upper - p.lower for p in parameters])
    nearest, which, where = np.inf, None, 0
    for limit in limits if parameters else ():
        with np.errstate(divide="ignore"):
            shares = limit.margin / np.abs(limit.slope * ranges)
        position = int(np.argmin(shares))
        if shares[position] < nearest:
            nearest, which, where = float(shares[position]), limit, position
    if which is not None and nearest < NEAR:
        verb = "leaves" if which.active else "reaches"
        toward = "less" if which.slope[where] > 0.0 else "more"
        much = f"{nearest * ranges[where]:.2g} {toward} {parameters[where].name}"
        yield f"{place}: {which.name} {verb} its limit with {much} ({nearest:.1%} of its range)"
