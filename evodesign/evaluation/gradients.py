"""Gradients of a design's objectives and constraints, quickly, as a search asks for with an evaluation.

The postures' tangents are those of `posture.solution_derivative`, good to one part in 10^6. A quantity of
torques follows by the chain rule, since torques are variables of the posture problem,

    d |tau| / d pi = tau . (d tau / d pi) / |tau|

and in a lift along the speeds of joints likewise. One of postures and wrenches goes along these, which are
variables too. The mean, the largest value or a quantile over cases is that of the same cases. What an
actuator changes of the formula itself (its motor constant, its limit) is differenced at the same torques.
A deflection moves with the robot's values too, differentiated by CasADi (`mechanics.robot_gradient`).
Reach has its own tangent. What depends on the robot's bodies alone is differenced along the resized robot.
Everything else goes along the whole tangent, as in `sensitivities`, which takes many times as long.

Beyond 300 lines: a rule of differentiation for each kind of quantity, all over the same tangents.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np

from evodesign.collision.parts import part_clearance
from evodesign.collision.zero_posture import built_in_slack, distance_along
from evodesign.design.parameter import ParameterKind
from evodesign.evaluation.sensitivities import ObjectiveSensitivity, Sensitivities
from evodesign.evaluation.sized_slopes import CaseDerivative, along_design, program_slopes, reach_along_design
from evodesign.evaluation.trees_beside import STEP
from evodesign.mechanics.robot_gradient import OF_MASSES
from evodesign.motion.derivative import LiftDerivative
from evodesign.motion.solution import MotionCase
from evodesign.nlp.optimality import Array, NotDifferentiable
from evodesign.posture.formulations.reach import HIGHEST, LOWEST
from evodesign.posture.results import AgentPosture, Instant
from evodesign.posture.solution_derivative import ReachDerivative
from evodesign.problem.build import DesignProblem
from evodesign.quantities.design_result import (
    WORST,
    CaseQuantity,
    DesignResult,
    PostureSlopes,
    mean_over_time,
)
from evodesign.quantities.motion_quantities import (
    ENDURANCE,
    ENERGY,
    LEAST_TIME,
    POWER,
)
from evodesign.quantities.objectives import QUANTITIES, REACH, SHARED_REACH, objective_value, split_name
from evodesign.quantities.person_quantities import HOLDING_TIME
from evodesign.quantities.push_quantities import SIMULATED
from evodesign.records import Case, CaseGradient, Gradients, Lift
from evodesign.violations import BODIES_APART, HEIGHT, PARTS_APART

MOST_CASES = 8
"""Cases of which each is logged for itself; a mean over more is logged alone."""

OF_THE_ROBOT = frozenset({*OF_MASSES, "cost"})
"""Objectives that depend on the robot's bodies alone."""

Found = Array | NotDifferentiable

OverTime = list[tuple[float, float, Found]]
"""Time [s], value and gradient at each instant of a case."""


def assessed_gradients(
    problem: DesignProblem, sensitivities: Sensitivities, values: Sequence[float], result: DesignResult
) -> Gradients:
    """The gradients of a design's objectives, constrained quantities and height margin, as they are logged.

    Args:
        problem: whose design it is.
        sensitivities: of the same problem.
        values: of the design, one number per parameter.
        result: what was computed of it.
    """
    design = _Design(problem, sensitivities, tuple(values), result)
    names = dict.fromkeys([*(o.name for o in problem.objectives), *(c.name for c in problem.constraints)])
    found = {name: design.gradient(name) for name in names} | {HEIGHT: design.of_height()}
    spans = {
        place: (p.name, p.record.slope_at(value))
        for place, (p, value) in enumerate(zip(problem.space.parameters, values, strict=True))
        if not p.choices and not p.is_fixed
    }

    def slopes(gradient: Array) -> dict[str, float]:
        return {parameter: float(gradient[place]) * span for place, (parameter, span) in spans.items()}

    def in_case(value: float, gradient: Found) -> CaseGradient:
        if isinstance(gradient, NotDifferentiable):
            return CaseGradient(value)
        return CaseGradient(value, tuple(slopes(gradient).values()))

    return Gradients(
        values={
            name: slopes(gradient)
            for name, gradient in found.items()
            if not isinstance(gradient, NotDifferentiable)
        },
        absent={name: each.reason for name, each in found.items() if isinstance(each, NotDifferentiable)},
        cases={
            objective.name: tuple(in_case(*each) for each in cases)
            for objective in problem.objectives
            if 1 < len(cases := design.in_cases(objective.name)) <= MOST_CASES
        },
    )


class _Design:
    """A design whose tangents are taken when something asks for them."""

    def __init__(
        self,
        problem: DesignProblem,
        sensitivities: Sensitivities,
        values: tuple[float, ...],
        result: DesignResult,
    ) -> None:
        self._problem, self._sensitivities = problem, sensitivities
        self._values, self._result = values, result
        self._known: dict[str, list[OverTime]] = {}
        self._near: dict[int, list[tuple[Instant, ...]]] = {}
        self._trees = sensitivities.beside(result)

    @cached_property
    def _as_given(self) -> list[CaseDerivative | NotDifferentiable]:
        """Tangents by what programs are given."""
        of_case, given = self._sensitivities.of_case, self._result.program_values
        return [of_case(given, solution, exact=False) for solution in self._result.cases]

    @cached_property
    def _given(self) -> Array | NotDifferentiable | None:
        """The derivatives of what programs are given; None where that is the design itself."""
        return program_slopes(self._result, self._as_given, self._sensitivities.robot)

    @cached_property
    def _cases(self) -> list[CaseDerivative | NotDifferentiable]:
        return [along_design(each, self._given) for each in self._as_given]

    @cached_property
    def _highest(self) -> ReachDerivative | NotDifferentiable:
        return self._of_reach(HIGHEST)

    @cached_property
    def _lowest(self) -> ReachDerivative | NotDifferentiable:
        return self._of_reach(LOWEST)

    @cached_property
    def _by_differences(self) -> Mapping[str, ObjectiveSensitivity]:
        """Of every quantity, along the exact tangent: the slow way, for those that have no other."""
        return self._sensitivities.at(self._values, self._result).sensitivities()

    def _of_reach(self, sense: float) -> ReachDerivative | NotDifferentiable:
        found = self._sensitivities.of_reach(self._result.program_values, sense, exact=False)
        return reach_along_design(found, self._given)

    def gradient(self, name: str) -> Found:
        """One per parameter, in the quantity's unit per unit of the parameter."""
        if name in SIMULATED:
            return NotDifferentiable("a simulation has no gradient")
        if objective_value(name, self._result) is None:
            return NotDifferentiable("the design has no such value")
        way, quantity = split_name(name)
        known = QUANTITIES.get(quantity)
        if known is not None and known.has_slopes:
            found = self._by_case(quantity, known)
            cases = [each for case in found for each in case] if way == WORST else [*map(_mean, found)]
            gradients = [gradient for _, _, gradient in cases if isinstance(gradient, np.ndarray)]
            absent = [each for _, _, each in cases if isinstance(each, NotDifferentiable)]
            values = [value for _, value, _ in cases]
            return absent[0] if absent else np.asarray(_weights(values, way) @ np.array(gradients))
        if name == ENERGY:
            return self._of_energy()
        if name == ENDURANCE:
            return self._of_endurance()
        if quantity == LEAST_TIME:
            return self._of_least_time(way)
        if name == REACH:
            return _slope(self._highest)
        if name == SHARED_REACH:
            return self._of_shared_reach()
        if name == BODIES_APART:
            return self._of_bodies()
        if name == PARTS_APART:
            return self._of_parts()
        if name in OF_THE_ROBOT:
            return self._of_robot(name)
        sensitivity = self._by_differences[name]
        if sensitivity.gradient is None:
            return NotDifferentiable("; ".join(sensitivity.notes) or "no derivative exists")
        return np.array(list(sensitivity.gradient.values()))

    def of_height(self) -> Found:
        """Of the margin by which the worst required height is missed (`violations.height_margin`)."""
        reach = self._result.reach
        if reach.highest is None or reach.lowest is None:
            return NotDifferentiable("the reach is not known")
        heights = [height for solution in self._result.cases for height in solution.case.task.heights]
        if reach.lowest - min(heights) > max(heights) - reach.highest:
            return _slope(self._lowest)
        found = _slope(self._highest)
        return found if isinstance(found, NotDifferentiable) else -found

    def in_cases(self, name: str) -> list[tuple[float, Found]]:
        """Value and gradient in every case of a quantity that is their mean; none of any other quantity."""
        way, quantity = split_name(name)
        known = QUANTITIES.get(quantity)
        if way or known is None or not known.has_slopes or objective_value(name, self._result) is None:
            return []
        return [(value, gradient) for _, value, gradient in map(_mean, self._by_case(quantity, known))]

    def _by_case(self, name: str, quantity: CaseQuantity) -> list[OverTime]:
        """By the chain rule, in every case and under every disturbance; worked out once."""
        if name in self._known:
            return self._known[name]
        found = self._known[name] = []
        for case, (solution, derivative) in enumerate(zip(self._result.cases, self._cases, strict=True)):
            scene = self._result.scene_of(solution.case)
            exact = derivative.instants if isinstance(derivative, LiftDerivative) else solution.instants
            for load_case, disturbance in enumerate(("", *solution.instants[0].disturbed)):
                over_time: OverTime = []
                for number, instant in enumerate(solution.instants):
                    postures = instant.disturbed.get(disturbance, instant.postures)
                    value = quantity.value(scene, postures)
                    if isinstance(derivative, NotDifferentiable):
                        over_time.append((instant.time, value, derivative))
                        continue
                    postures = exact[number].disturbed.get(disturbance, exact[number].postures)
                    slope = np.zeros(len(self._values))
                    if quantity.by_torque is not None:
                        weights = quantity.by_torque(scene, postures)
                        slope += derivative.along_torques(number, load_case, weights)
                    if quantity.by_speed is not None and isinstance(derivative, LiftDerivative):
                        slope += derivative.along_speeds(number, quantity.by_speed(scene, postures))
                    if quantity.of_actuators:
                        slope += self._by_actuators(quantity, solution.case, postures)
                    if quantity.by_robot is not None and self._sensitivities.robot is not None:
                        robot, values = self._sensitivities.robot, self._result.program_values
                        along, slopes = quantity.by_robot(robot, values, scene, postures)
                        slope += along @ self._given if isinstance(self._given, np.ndarray) else along
                        slope += self._by_posture(case, derivative, number, disturbance, slopes)
                    if quantity.by_posture is not None:
                        slopes = quantity.by_posture(scene, postures)
                        slope += self._by_posture(case, derivative, number, disturbance, slopes)
                    over_time.append((instant.time, value, slope))
                found.append(over_time)
        return found

    def _by_posture(
        self,
        case: int,
        derivative: CaseDerivative,
        instant: int,
        disturbance: str,
        slopes: Mapping[str, PostureSlopes],
    ) -> Array:
        """Along the tangent of a case, which is linear: its postures after a unit step less its own."""
        if case not in self._near:
            steps = np.vstack([np.zeros(len(self._values)), np.eye(len(self._values))])
            self._near[case] = [derivative.moved(step) for step in steps]
        found = []
        for instants in self._near[case]:
            postures = instants[instant].disturbed.get(disturbance, instants[instant].postures)
            found.append(sum(each.along(postures[agent]) for agent, each in slopes.items()))
        return np.array(found[1:]) - found[0]

    def _by_actuators(
        self, quantity: CaseQuantity, case: Case, postures: Mapping[str, AgentPosture]
    ) -> Array:
        """What the parameters of actuators change of a quantity at the same torques."""
        found = np.zeros(len(self._values))
        given = self._given if isinstance(self._given, np.ndarray) else np.eye(len(found))
        for position, parameter in enumerate(self._problem.space.parameters):
            if parameter.joints and not parameter.choices:
                step, *beside = self._beside(position)
                below, above = (quantity.value(result.scene_of(case), postures) for result in beside)
                found[position] = (above - below) / (2.0 * step)
        return np.asarray(found @ given)

    def _beside(self, position: int) -> tuple[float, DesignResult, DesignResult]:
        """The same postures with another value of a parameter: a step, and results below and above."""
        step, below, above = self._trees.along(position)
        return step, replace(self._result, tree=below), replace(self._result, tree=above)

    def _of_shared_reach(self) -> Found:
        people, robot = self._result.people_highest, self._result.reach.highest
        if people is not None and robot is not None and people < robot:
            return np.zeros(len(self._values))
        return _slope(self._highest)

    def _of_energy(self) -> Found:
        """The power's over the time of each lift, the mean over all of them."""
        found = self._by_case(POWER, QUANTITIES[POWER])
        lifts = [
            (solution.case.task.seconds, _mean(over_time)[2])
            for (solution, _), over_time in zip(self._result.every_case(), found, strict=True)
            if isinstance(solution.case.task, Lift)
        ]
        absent = [each for _, each in lifts if isinstance(each, NotDifferentiable)]
        slopes = [seconds * each for seconds, each in lifts if isinstance(each, np.ndarray)]
        return absent[0] if absent else np.asarray(np.mean(slopes, axis=0))

    def _of_endurance(self) -> Found:
        """Of the case that can be held least long."""
        cases = [each for case in self._by_case(ENDURANCE, HOLDING_TIME) for each in case]
        return min(cases, key=lambda case: case[1])[2]

    def _of_least_time(self, way: str) -> Found:
        """From the multipliers of each lift's own program."""
        motions = [each.motion for each in self._result.cases if isinstance(each, MotionCase)]
        found = [each.least for each in motions if each is not None and each.least is not None]
        weights = _weights([each.seconds for each in found], way)
        slope = np.asarray(weights @ np.array([each.slope for each in found]))
        if not self._result.rated or self._given is None:
            return slope
        given = self._given
        return given if isinstance(given, NotDifferentiable) else np.asarray(slope @ given)

    def _of_bodies(self) -> Found:
        """Of the nearest two bodies at zero, differenced along the resized robot: lengths alone move them."""
        slack = built_in_slack(self._result.tree, self._result.robot.collisions)
        if slack is None:
            return NotDifferentiable("the design has no such value")
        found, (_, nearest) = np.zeros(len(self._values)), slack
        apart = distance_along(self._result.tree, (nearest.first, nearest.second))

        def value(position: int, moved: float) -> float:
            values = list(self._result.program_values)
            values[position] += moved
            return apart(self._trees.family.without_actuators(values))

        for position, parameter in enumerate(self._problem.space.parameters):
            if parameter.kind is ParameterKind.LENGTH:
                step = STEP * self._values[position]
                found[position] = (value(position, step) - value(position, -step)) / (2.0 * step)
        return found

    def _of_parts(self) -> Found:
        """Of the pairs of parts that decide."""
        unscaled = self._problem.scene.designed_tree
        clearance = part_clearance(self._result.tree, unscaled)
        if clearance is None:
            return NotDifferentiable("the design has no such value")

        def apart(result: DesignResult) -> float:
            found = part_clearance(result.tree, unscaled, clearance.decisive)
            return 0.0 if found is None else found.apart  # all that lacked room have it by now

        return self._of_trees(apart)

    def _of_robot(self, name: str) -> Found:
        robot = self._sensitivities.robot
        if robot is not None and name in OF_MASSES and not isinstance(self._given, NotDifferentiable):
            found = robot.of_masses(name, self._result.program_values)
            return found if self._given is None else np.asarray(found @ self._given)
        return self._of_trees(lambda result: objective_value(name, result) or 0.0)

    def _of_trees(self, value: Callable[[DesignResult], float]) -> Found:
        """Of a value that follows from the robot's tree alone, by differences."""
        if isinstance(self._given, NotDifferentiable):
            return self._given
        found = np.zeros(len(self._values))
        for position, parameter in enumerate(self._problem.space.parameters):
            if not parameter.choices:
                step, *beside = self._beside(position)
                below, above = map(value, beside)
                found[position] = (above - below) / (2.0 * step)
        return found if self._given is None else np.asarray(found @ self._given)


def _slope(derivative: ReachDerivative | NotDifferentiable) -> Found:
    return derivative if isinstance(derivative, NotDifferentiable) else derivative.slope


def _mean(case: OverTime) -> tuple[float, float, Found]:
    """Of a case over its time: its value and gradient, by the trapezoidal rule."""
    times, values, gradients = zip(*case, strict=True)
    absent = next((each for each in gradients if isinstance(each, NotDifferentiable)), None)
    return times[0], mean_over_time(times, values), absent or mean_over_time(times, gradients)


def _weights(values: Sequence[float], way: str) -> Array:
    """How much each case counts in the mean, the largest value or a quantile of all."""
    count, weights = len(values), np.zeros(len(values))
    order = np.argsort(values)
    if not way:
        return np.full(count, 1.0 / count)
    place = (count - 1.0) if way == WORST else (count - 1) * float(way[1:-1]) / 100.0
    below = int(place)
    weights[order[below]] += 1.0 - (place - below)
    weights[order[min(below + 1, count - 1)]] += place - below
    return weights
