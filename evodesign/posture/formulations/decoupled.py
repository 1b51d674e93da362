"""Robot and person solved one after the other, joined by the internal force between them.

Where `HumanValue` knows the person's least cost V(X) at a height, the robot alone is solved against it,

    minimise  w_r |tau_r|^2 + regularisation_r + V(X)

and then the person at the internal force X that was found. The programs are half as large again, local minima
are a third as many, and the person's many starts are paid for once. The derivative follows the same chain:

    d person / d pi = d person / dX  dX / d pi
    d cost / d pi   = d cost_r / d pi + (cost_h'(X) - V'(X)) dX / d pi

with cost_r the robot's optimal cost (which holds V) and cost_h the person's. An X at its limit stays there.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from evodesign.mechanics.scene import HUMAN, ROBOT, SIDES
from evodesign.nlp.landscape import NEAR, Landscape
from evodesign.nlp.optimality import NotDifferentiable
from evodesign.nlp.program import Array, Program, Start
from evodesign.nlp.sensitivity import Optimum, SolutionSensitivity, no_limits
from evodesign.nlp.solver import RawSolution, Solver, SolverCache
from evodesign.posture.active_limits import LimitSlopes, merge, priced
from evodesign.posture.assemble import CaseSymbols, Embodied, Slot, assemble, free_hands_beside, total
from evodesign.posture.candidate import Candidate, Finishing, Trial, cheapest, checked
from evodesign.posture.check import Checker, Unchecked
from evodesign.posture.formulations.base import Setting, program_key
from evodesign.posture.formulations.human_value import (
    COEFFICIENTS,
    HumanProblem,
    HumanValue,
    chebyshev_sum,
)
from evodesign.posture.parting import parted
from evodesign.posture.results import CaseSolution, Neighbour
from evodesign.posture.solution_derivative import PostureDerivative, found_again
from evodesign.posture.starts import STARTS_BESIDE, fixed_starts, named_starts, universal_starts
from evodesign.posture.symmetry import Form
from evodesign.posture.terms.load import INTERNAL_FORCE, PUSH, any_load, force_along_x
from evodesign.posture.terms.registry import TERMS
from evodesign.posture.warm_start import Layout, instants_of, layout_of, start_from
from evodesign.records import ActiveLimit, Status, Task, worst_status

AT_LIMIT = 1e-6
"""How little below its limit an internal force [N] counts as being there; IPOPT ends a little before it."""


class DecoupledPostures:
    """The robot's program against the person's value function, for the tasks that have one.

    Args:
        name: of the formulation.
        forms: halves of robot and person.
        setting: of the problem.
        values: the person's value functions.
        solvers: of other scenes.
    """

    def __init__(
        self,
        name: str,
        forms: tuple[Form, Form],
        setting: Setting,
        values: Mapping[Task, HumanValue],
        solvers: SolverCache,
    ) -> None:
        self.name = name
        self._forms, self._setting, self._solvers = forms, setting, solvers
        self._values = values

    @cached_property
    def _robot(self) -> Solver:
        key = program_key(self.name, self._setting, self._forms[0])
        return self._solvers.solver(key, self._robot_program, self._setting.options)

    @cached_property
    def _human(self) -> HumanProblem:
        setting = self._setting
        weight = setting.weights.human
        return HumanProblem(self._forms[1], setting.scene, weight, setting.options, self._solvers)

    @cached_property
    def _layout(self) -> Layout:
        return {**layout_of(self._robot.program, ROBOT), **layout_of(self._human.program, HUMAN)}

    @cached_property
    def _left_hand(self) -> str:
        return _left_hand(self._robot.program)

    @cached_property
    def _fixed(self) -> tuple[Start, ...]:
        return fixed_starts(self._robot.program)

    @cached_property
    def _sensitivities(self) -> tuple[SolutionSensitivity, SolutionSensitivity]:
        return SolutionSensitivity(self._robot), SolutionSensitivity(self._human.solver)

    @cached_property
    def _limit_slopes(self) -> tuple[LimitSlopes, LimitSlopes]:
        return LimitSlopes(self._robot.program), LimitSlopes(self._human.program)

    def _robot_program(self) -> Program:
        return robot_program(self._forms[0], self._setting)

    def landscape(self, task: Task) -> Landscape:
        """The robot's cost for a task, with V(X)."""
        universal = universal_starts(self._robot.program)
        return Landscape(self._robot, self._beside(task), self._fixed, *NEAR, universal=universal)

    def sketched(self, design: Sequence[float], task: Task, portfolio: Sequence[Start]) -> Trial:
        """What the first start leads the robot to, with the person beside it."""
        return self.solve(design, task, portfolio[:1], Unchecked())

    def solve(
        self, design: Sequence[float], task: Task, portfolio: Sequence[Start], checker: Checker
    ) -> Trial:
        """What the portfolio (or else the fixed starts) leads the robot to, with the person beside it."""
        parameters = {"design": design, **self._beside(task)}
        starts = named_starts(self._robot, portfolio, self._fixed)
        ends = [(name, self._robot.solve(parameters, start)) for name, start in starts]
        return self._trial(task, parameters, ends, checker)

    def solve_beside(
        self,
        design: Sequence[float],
        task: Task,
        portfolio: Sequence[Start],
        neighbour: Neighbour,
        checker: Checker,
    ) -> Trial:
        """What the robot's posture in a similar scene leads to: it is close; and the first starts.

        With the same load the other person's V(X) is all that differs, and no other start is needed.
        """
        parameters = {"design": design, **self._beside(task)}
        known = start_from(self._robot.program, self._forms, neighbour.solution.instants)
        ends = [("neighbour", self._robot.near.solve(parameters, known))]
        if not neighbour.same_load:
            starts = named_starts(self._robot, portfolio, self._fixed)[:STARTS_BESIDE]
            ends += [(name, self._robot.solve(parameters, start)) for name, start in starts]
        return self._trial(task, parameters, ends, checker)

    def followed(
        self, design: Sequence[float], solution: CaseSolution, raw: RawSolution
    ) -> CaseSolution | None:
        """The robot's postures of another design near those of a solution; the person stays."""
        parameters = {"design": design, **self._beside(solution.case.task)}
        raw = self._robot.settled(parameters, self._robot.near.solve(parameters, raw.values))
        if raw.status is not Status.SOLVED:
            return None
        robots = instants_of(
            layout_of(self._robot.program, ROBOT), self._forms[:1], self._setting.scene, raw.values
        )
        pairs = zip(solution.instants, robots, strict=True)
        instants = tuple(old.with_postures(new.postures) for old, new in pairs)
        return replace(solution, instants=instants, raw=raw)

    def finished(self, design: Sequence[float], task: Task, raw: RawSolution, checker: Checker) -> Trial:
        """A solve for this design that was not checked, with the person beside it, checked."""
        return self._trial(task, {"design": design, **self._beside(task)}, [("neighbour", raw)], checker)

    def _beside(self, task: Task) -> Mapping[str, Any]:
        """The robot's parameters beside the design."""
        mass, value = self._setting.scene.payload.mass, self._values[task]
        return {**task.given, "mass": mass, "value": value.coefficients}

    def _trial(
        self,
        task: Task,
        parameters: Mapping[str, Any],
        ends: Sequence[tuple[str, RawSolution]],
        checker: Checker,
    ) -> Trial:
        """The robot's postures with the person's at the internal force that was found."""

        def finish(start: str, robot: RawSolution) -> Candidate:
            value, internal = self._values[task], self._internal_force(robot)
            human = self._human.best(task.heights[0], internal, value)
            both = _joined(robot, human, float(value.cost(internal)))
            if human.status is not Status.SOLVED:
                return Candidate(checked(self.name, start, both, ()), (), (), robot)
            instants = instants_of(self._layout, self._forms, self._setting.scene, both.values)
            residuals = checker.task_residuals(instants, task.heights)
            return Candidate(checked(self.name, start, both, residuals), instants, residuals, robot, human)

        finishing = Finishing(
            lambda raw, last: self._robot.settled(parameters, raw, patient=last),
            lambda raw, least: self._robot.bettered(parameters, raw, least),
            finish,
        )
        return cheapest(self.name, ends, finishing)

    def _internal_force(self, robot: RawSolution) -> float:
        hand = robot.values[self._left_hand]
        force, limit = float(self._force(hand)), self._setting.scene.stance.push
        return float(np.copysign(limit, force)) if abs(force) > limit - AT_LIMIT else force

    def _force(self, left_hand: Array) -> Array:
        """The robot's force on the load along x [N] from its left hand's; the right hand's is the same."""
        return np.asarray(-len(SIDES) * self._setting.scene.robot.sign * left_hand[0])

    def derivative(
        self, design: Sequence[float], solution: CaseSolution, *, exact: bool = True
    ) -> PostureDerivative | NotDifferentiable:
        """How a posture that this pair of programs found moves with the design."""
        value, (robots, humans) = self._values[solution.case.task], self._sensitivities
        start = start_from(robots.program, self._forms, solution.instants)
        found = robots.at({"design": design, **self._beside(solution.case.task)}, start, exact=exact)
        if isinstance(found, NotDifferentiable):
            return found
        robot, hand = found.along("design"), _left_hand(robots.program)
        internal, change = float(self._force(robot.values[hand])), self._force(robot.slopes[hand])
        held = robot.limits.holds(PUSH)
        person = self._person(solution, internal, held=held, exact=exact)
        if isinstance(person, NotDifferentiable):
            return person
        human = person.along("internal_force", change[None, :])
        surprise = -value.slope(internal) * change
        derivative = PostureDerivative(
            layout={**layout_of(robots.program, ROBOT), **layout_of(humans.program, HUMAN)},
            forms=self._forms,
            scene=self._setting.scene,
            times=solution.case.task.times,
            values={**robot.values, **human.values},
            slopes={**robot.slopes, **human.slopes},
            cost=robot.cost - float(value.cost(internal)) + human.cost,
            cost_slope=robot.cost_slope + human.cost_slope + surprise,
            compared=robot.cost,
            limits=robot.limits + human.limits,
        )
        return found_again(derivative, solution)

    def active_limits(self, design: Sequence[float], solution: CaseSolution) -> tuple[ActiveLimit, ...]:
        """Which limits hold a posture that this pair of programs found, and what they cost.

        At the largest internal force its limit costs what it costs the robot, who knows V'(X), and what the
        person's own slope differs from that.
        """
        if solution.raw is None or solution.person is None or solution.attempt is None:
            return ()
        (robots, humans), task = self._limit_slopes, solution.case.task
        value, internal = self._values[task], self._internal_force(solution.raw)
        robot = robots.of({"design": design, **self._beside(task)}, solution.raw)
        human = humans.of(self._human.parameters(task.heights[0], internal), solution.person)
        surprise = float(solution.person.cost_slope[self._human.program.columns["internal_force"]][0])
        surprise -= value.slope(internal)
        for bound, force, _ in [*robot.values()]:
            if bound.name == INTERNAL_FORCE:
                merge(robot, bound, force, surprise * float(np.sign(internal)))
        return priced([robot, human], solution.attempt.cost)

    def _person(
        self, solution: CaseSolution, internal: float, *, held: bool, exact: bool
    ) -> Optimum | NotDifferentiable:
        """The person under an internal force [N]; one that is held at its limit does not move the person."""
        humans, task = self._sensitivities[1], solution.case.task
        parameters = self._human.parameters(task.heights[0], internal)
        if not held:
            start = start_from(humans.program, self._forms, solution.instants)
            return humans.at(parameters, start, exact=exact)
        push = float(np.copysign(self._setting.scene.stance.push, internal))
        raw = self._human.best(task.heights[0], push, self._values[task])
        many = sum(np.size(value) for value in parameters.values())
        still = {name: np.zeros((len(value), many)) for name, value in raw.values.items()}
        columns, limits, unmoved = humans.program.columns, no_limits(many), np.zeros(many)
        return Optimum(raw.values, still, raw.cost, unmoved, limits, columns)


def _left_hand(program: Program) -> str:
    """Name of the variable of the robot's left hand."""
    return layout_of(program, ROBOT)[Slot(0, 0, ROBOT, "left_hand")]


def _joined(robot: RawSolution, human: RawSolution, expected: float) -> RawSolution:
    """Both solves as one: V(X) in the robot's cost gives way to what the person's solve found."""
    reason = robot.reason if human.status is Status.SOLVED else f"the person: {human.reason}"
    return replace(
        robot,
        values={**robot.values, **human.values},
        status=worst_status([robot.status, human.status]),
        reason=reason,
        iterations=robot.iterations + human.iterations,
        seconds=robot.seconds + human.seconds,
        cost=robot.cost - expected + human.cost,
    )


def robot_program(form: Form, setting: Setting, *, switched: bool = False) -> Program:
    """The robot's program, given the design, the load's height and mass, and V's coefficients."""
    scene, mass = any_load(setting.scene)
    design = ca.SX.sym("design", len(setting.space.parameters))
    height, coefficients = ca.SX.sym("height"), ca.SX.sym("value", COEFFICIENTS)
    robot = Embodied(form, setting.space.resized(scene.robot.tree, ca.vertsplit(design)))
    parties = (robot, free_hands_beside(form))
    assembly = assemble(parties, TERMS.values(), CaseSymbols(scene, (height,)), switched=switched)
    load_case = assembly.undisturbed
    internal = force_along_x(scene.robot, load_case.hands[ROBOT]) / scene.stance.push
    value = chebyshev_sum(ca.vertsplit(coefficients), internal)
    return Program(
        name="robot",
        variables=assembly.variables,
        constraints=assembly.constraints,
        cost=total([load_case.effort({ROBOT: setting.weights.robot}), *load_case.regularisation, value]),
        parameters={
            "design": design,
            "height": height,
            "mass": mass,
            "value": coefficients,
            **assembly.given,
        },
        switches=parted(assembly.parted, lambda: robot_program(form, setting, switched=True)),
    )
