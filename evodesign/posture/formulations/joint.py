"""Robot and person in one program: how they stand with the load at one height, at the least effort.

    minimise    w_r |tau_r|^2 + w_h |tau_h|^2 + regularisation
    subject to  every term, for both agents and the load

for any design (a parameter of one program built once).

Source: Sartore et al. 2022, Eq. 14 with pi fixed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any

import casadi as ca

from evodesign.mechanics.scene import HUMAN, ROBOT
from evodesign.nlp.optimality import NotDifferentiable
from evodesign.nlp.program import Program, Start
from evodesign.nlp.sensitivity import SolutionSensitivity
from evodesign.nlp.solver import RawSolution, Solver
from evodesign.nlp.solver_cache import SolverCache
from evodesign.nlp.start_portfolio import NEAR, Landscape
from evodesign.posture.allocation import shared_scene, shared_weights
from evodesign.posture.assemble import CaseSymbols, Embodied, assemble, total
from evodesign.posture.candidate import Candidate, Trial, cheapest, checked
from evodesign.posture.check import Checker
from evodesign.posture.formulations.base import Setting, program_key
from evodesign.posture.load_cases import aggregated, with_worst
from evodesign.posture.results import HeightSolution, Instant, Neighbour
from evodesign.posture.solution_derivative import PostureDerivative, found_again, known_instant
from evodesign.posture.starts import STARTS_BESIDE, fixed_starts, named_starts
from evodesign.posture.symmetry import Form
from evodesign.posture.terms.load import any_load
from evodesign.posture.terms.registry import TERMS
from evodesign.posture.warm_start import filled, instant_of, layout_of, start_from

__all__ = ["JointPostures", "posture_program"]


class JointPostures:
    """A posture program over the given forms of both agents.

    Args:
        name: of the formulation.
        forms: whole agents, or their halves.
        setting: of the problem.
        solvers: of other scenes.
    """

    def __init__(self, name: str, forms: tuple[Form, Form], setting: Setting, solvers: SolverCache) -> None:
        self.name = name
        self._forms, self._setting, self._solvers = forms, setting, solvers

    @cached_property
    def _solver(self) -> Solver:
        key = program_key(self.name, self._setting, self._forms)
        return self._solvers.solver(key, self._program, self._setting.options)

    @cached_property
    def _fixed(self) -> tuple[Start, ...]:
        return fixed_starts(self._solver.program)

    @cached_property
    def _sensitivity(self) -> SolutionSensitivity:
        return SolutionSensitivity(self._program(), self._setting.options)

    def _program(self) -> Program:
        return posture_program(self._forms, self._setting)

    def landscape(self, height: float) -> Landscape:
        """The program's cost at a height [m]."""
        return Landscape(self._solver, self._beside(height), self._fixed, *NEAR)

    def solve(
        self, design: Sequence[float], height: float, portfolio: Sequence[Start], checker: Checker
    ) -> Trial:
        """What the portfolio leads to, or the fixed starts if none of it fits."""
        return self._trial(design, height, named_starts(self._solver, portfolio, self._fixed), checker)

    def solve_beside(
        self,
        design: Sequence[float],
        height: float,
        portfolio: Sequence[Start],
        neighbour: Neighbour,
        checker: Checker,
    ) -> Trial:
        """What the solution in a similar scene leads to, and the first starts of the portfolio."""
        known = self._start(known_instant(neighbour.solution))
        others = named_starts(self._solver, portfolio, self._fixed)[:STARTS_BESIDE]
        return self._trial(design, height, [("neighbour", known), *others], checker)

    def polish(self, design: Sequence[float], height: float, known: Instant, checker: Checker) -> Trial:
        """What known whole postures lead to."""
        return self._trial(design, height, [("polish", self._start(known))], checker)

    def derivative(
        self, design: Sequence[float], solution: HeightSolution
    ) -> PostureDerivative | NotDifferentiable:
        """How a posture that this program found moves with the design."""
        program = self._sensitivity.program
        start = start_from(program, self._forms, [known_instant(solution)])
        parameters = {"design": design, **self._beside(solution.height)}
        found = self._sensitivity.at(parameters, with_worst(start, program, parameters))
        if isinstance(found, NotDifferentiable):
            return found
        own = found.along("design")
        derivative = PostureDerivative(
            layout=layout_of(program),
            forms=self._forms,
            scene=self._setting.scene,
            values=own.values,
            slopes=own.slopes,
            cost=own.cost,
            cost_slope=own.cost_slope,
            compared=own.cost,
            limits=own.limits,
        )
        return found_again(derivative, solution)

    def _start(self, known: Instant) -> Start:
        return start_from(self._solver.program, self._forms, [known])

    def _beside(self, height: float) -> Mapping[str, Any]:
        """The parameters beside the design."""
        return {"height": height, "mass": self._setting.scene.payload.mass}

    def _trial(
        self, design: Sequence[float], height: float, starts: Sequence[tuple[str, Start]], checker: Checker
    ) -> Trial:
        parameters, program = {"design": design, **self._beside(height)}, self._solver.program
        ends = [(name, self._solver.solve(parameters, filled(start, program))) for name, start in starts]

        def finish(start: str, raw: RawSolution) -> Candidate:
            instant = instant_of(layout_of(program), self._forms, self._setting.scene, raw.values)
            residuals = checker.residuals(instant, height)
            return Candidate(checked(self.name, start, raw, residuals), (instant,), residuals)

        return cheapest(self.name, ends, finish)


def posture_program(forms: tuple[Form, Form], setting: Setting) -> Program:
    """The program over both agents; its parameters are the design, and the load's height and mass."""
    space = setting.space
    scene, mass = any_load(setting.scene)
    design, height = ca.SX.sym("design", len(space.parameters)), ca.SX.sym("height")
    values = ca.vertsplit(design)
    scene, weights = shared_scene(scene, space, values), shared_weights(setting.weights, space, values)
    by_agent = {ROBOT: weights.robot, HUMAN: weights.human}
    robot = Embodied(forms[0], space.resized(scene.robot.tree, values))
    human = Embodied(forms[1], scene.human.tree)
    assembly = assemble((robot, human), TERMS.values(), CaseSymbols(scene, (height,)))
    load_case = assembly.undisturbed
    program = Program(
        name="posture",
        variables=assembly.variables,
        constraints=assembly.constraints,
        cost=total([load_case.effort(by_agent), *load_case.regularisation]),
        parameters={"design": design, "height": height, "mass": mass},
    )
    if not scene.disturbances:
        return program
    costs = [total([each.effort(by_agent), *each.costs]) for each in assembly.instants[0]]
    posture = replace(program, cost=total(load_case.posture_costs))
    return aggregated(posture, scene.disturbances.effort, costs)
