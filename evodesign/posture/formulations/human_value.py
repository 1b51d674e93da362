"""The person's part of a posture, which does not depend on the robot.

With point grasps and a symmetric scene the load's balance leaves one number between robot and person, the
internal force X. So the person's least cost at a height is a function V(X) that is found once, and robots are
then solved alone:

    min over both  =  min over robot and X of  w_r |tau_r|^2 + regularisation_r + V(X)

V is the lower envelope of many starts at Chebyshev nodes of [-push, push], as a polynomial through them; its
error is measured half-way between the nodes.

Source: Chebyshev interpolation: Trefethen, Approximation Theory and Approximation Practice, ch. 2.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

import casadi as ca
import msgspec
import numpy as np
from numpy.polynomial import Chebyshev
from numpy.polynomial.chebyshev import chebder, chebval

from evodesign.mechanics.scene import HUMAN, ROBOT, Scene
from evodesign.nlp.method import SolverOptions
from evodesign.nlp.program import Array, ConstraintBlock, Program
from evodesign.nlp.solver import RawSolution, Solver, SolverCache
from evodesign.posture.assemble import CaseSymbols, Embodied, assemble, free_hands_beside, total
from evodesign.posture.check import TOLERANCE, AgentModel, near_bodies
from evodesign.posture.formulations.base import program_key
from evodesign.posture.measured_starts import measured_starts
from evodesign.posture.parting import parted
from evodesign.posture.starts import person_starts
from evodesign.posture.symmetry import Form
from evodesign.posture.terms.base import TORQUE_UNIT
from evodesign.posture.terms.load import any_load, force_along_x
from evodesign.posture.terms.measured_posture import any_person, person_parameters
from evodesign.posture.terms.registry import TERMS
from evodesign.posture.warm_start import instants_of, layout_of
from evodesign.records import Status

DEGREE = 8
COEFFICIENTS = DEGREE + 1
PUSH_UNIT = 10.0  # [N] per unit of the row that fixes the push
NODES_TRIED = 4
"""Of the optima at other pushes, how many are tried as starts."""

LARGEST_ERROR = 0.02
"""Largest error of V between nodes that is accepted, in the cost's unit."""

COST_UNIT = TORQUE_UNIT**2
"""One unit of V, and of every posture's cost [N^2 m^2]."""


IN_FILES = {"push": "push_n"}
"""Names of fields with their units, as a value function is kept."""


class HumanValue(msgspec.Struct, frozen=True, forbid_unknown_fields=True, rename=IN_FILES):
    """The person's least cost V(X) at one height of the load.

    Args:
        push: largest |X| [N].
        coefficients: of V in Chebyshev polynomials of X / push.
        starts: the person's optimum at each node, as starting values, with its X [N].
        error: largest difference from the envelope half-way between nodes, in the cost's unit.
    """

    push: float
    coefficients: tuple[float, ...]
    starts: tuple[tuple[float, Mapping[str, Array]], ...]
    error: float

    def cost(self, push: Any) -> Any:
        """V at a push X [N], a number or an expression."""
        return chebyshev_sum(self.coefficients, push / self.push)

    def slope(self, push: float) -> float:
        """Derivative of V at a push X [N]."""
        return float(chebval(push / self.push, chebder(self.coefficients))) / self.push

    def nearest(self, push: float) -> list[Mapping[str, Array]]:
        """Starting values, those from the node nearest to a push [N] first."""
        return [start for _, start in sorted(self.starts, key=lambda start: abs(start[0] - push))]


def chebyshev_sum(coefficients: Sequence[Any], x: Any) -> Any:
    """The sum of c_k T_k(x) by Clenshaw's recurrence, over numbers or expressions."""
    later: Any = 0.0
    latest: Any = 0.0
    for coefficient in reversed(coefficients[1:]):
        later, latest = latest, 2.0 * x * latest - later + coefficient
    return x * latest - later + coefficients[0]


class HumanProblem:
    """The person's posture program, for the scene's load at any height and under any push."""

    def __init__(
        self,
        form: Form,
        scene: Scene,
        weight: float,
        options: SolverOptions,
        solvers: SolverCache | None = None,
    ) -> None:
        self._form, self._scene = form, scene
        self._push = scene.stance.push
        self._mass = scene.payload.mass
        key = program_key("person", scene, form, weight)
        self.solver = (solvers or SolverCache()).solver(
            key, lambda: human_program(form, scene, weight), options
        )
        self._pushed_to_the_end: dict[tuple[float, float], RawSolution] = {}

    @property
    def program(self) -> Program:
        """What is solved."""
        return self.solver.program

    def parameters(self, height: float, push: float) -> Mapping[str, Any]:
        """The program's, for a height [m] and a push [N]."""
        given = {"height": height, "mass": self._mass, "internal_force": push}
        return {**given, **person_parameters(self._scene)}

    def solve(self, height: float, push: float, start: Mapping[str, Array]) -> RawSolution:
        """The person's posture at a height [m] under a push [N], from one start."""
        return self._settled(self.solver, height, push, start)

    def _settled(self, solver: Solver, height: float, push: float, start: Mapping[str, Array]) -> RawSolution:
        parameters = self.parameters(height, push)
        return self.solver.settled(parameters, solver.solve(parameters, start))

    def best(self, height: float, push: float, value: HumanValue) -> RawSolution:
        """The person's posture at a height [m] under a push [N], about as good as V promises.

        Mostly the agents push as far as they may, and every design asks for the same: that is solved once.
        """
        if abs(push) < self._push:
            return self._best_from_nodes(height, push, value)
        if (height, push) not in self._pushed_to_the_end:
            self._pushed_to_the_end[height, push] = self._best_from_nodes(height, push, value)
        return self._pushed_to_the_end[height, push]

    def _best_from_nodes(self, height: float, push: float, value: HumanValue) -> RawSolution:
        """From the nearest node, close to the solution; if that fails or is dearer than V, from the next."""
        nearest = value.nearest(push)[:NODES_TRIED]
        ends: list[RawSolution] = []
        for solver, start in [(self.solver.near, nearest[0]), *((self.solver, start) for start in nearest)]:
            ends.append(self._settled(solver, height, push, start))
            if ends[-1].status is Status.SOLVED and ends[-1].cost <= value.cost(push) + LARGEST_ERROR:
                return ends[-1]
        return min(ends, key=lambda end: (end.status is not Status.SOLVED, end.cost))

    def value(self, height: float) -> HumanValue | None:
        """V at a height [m]; None when the person cannot hold the load there or V is too rough to fit.

        Where bodies are kept apart, postures in which the check finds any that overlap do not count.
        """
        nodes = self._push * np.cos(np.pi * (np.arange(COEFFICIENTS) + 0.5) / COEFFICIENTS)
        between = (nodes[1:] + nodes[:-1]) / 2.0
        best: dict[float, RawSolution] = {}
        for push in (*nodes.tolist(), *between.tolist()):
            solution = self.best_of_many(height, push)
            if solution is None:
                return None
            best[push] = solution
        found = self._fitted(nodes, between, best)
        if found.error > LARGEST_ERROR:  # mostly because some pushes met only worse optima than others
            found = self._fitted(nodes, between, self._from_others(height, best))
        return found if found.error <= LARGEST_ERROR else None

    def _fitted(self, nodes: Array, between: Array, best: Mapping[float, RawSolution]) -> HumanValue:
        """V through its nodes, with its error between them."""
        costs = {push: solution.cost for push, solution in best.items()}
        fit = Chebyshev.fit(nodes, [costs[float(x)] for x in nodes], DEGREE, domain=[-self._push, self._push])
        error = max(abs(float(fit(x)) - costs[float(x)]) for x in between)
        starts = tuple((push, dict(best[push].values)) for push in sorted(best))
        return HumanValue(self._push, tuple(fit.coef.tolist()), starts, error)

    def _from_others(self, height: float, best: Mapping[float, RawSolution]) -> dict[float, RawSolution]:
        """The best at each push, where the cheapest of all pushes may lead as well."""
        cheapest = sorted(best.values(), key=lambda solution: solution.cost)[:NODES_TRIED]
        found = {}
        for push, own in best.items():
            ends = [own, *(self.solve(height, push, other.values) for other in cheapest)]
            found[push] = self._cheapest(height, ends) or own
        return found

    def best_of_many(self, height: float, push: float) -> RawSolution | None:
        """The person's posture at a height [m] under a push [N], from many starts, always the same.

        A measured posture has few optima, near its mean: three starts do.
        """
        measured = measured_starts(self.program, self._form, self._scene, (height,))
        starts = measured or person_starts(self.program)
        return self._cheapest(height, [self.solve(height, push, each) for each in starts])

    def _cheapest(self, height: float, ends: Sequence[RawSolution]) -> RawSolution | None:
        """Of the solves that succeeded and keep the person's bodies clear."""
        solved = sorted((end for end in ends if end.status is Status.SOLVED), key=lambda end: end.cost)
        return next((end for end in solved if self._keeps_clear(height, end)), None)

    def _keeps_clear(self, height: float, raw: RawSolution) -> bool:
        layout = layout_of(self.program, HUMAN)
        (instant,) = instants_of(layout, (self._form,), self._scene.undisturbed, raw.values)
        near = near_bodies((self._person,), instant.postures, self._scene.payload.size, height)
        return all(gap.distance >= -TOLERANCE for gap in near)

    @cached_property
    def _person(self) -> AgentModel:
        return AgentModel.of(self._form.agent, self._form.agent.tree)


def human_program(form: Form, scene: Scene, weight: float, *, switched: bool = False) -> Program:
    """The person's program; its parameters are the load's height and mass, the internal force, and who."""
    given_scene = scene
    scene, mass = any_load(scene)
    scene, person = any_person(scene)
    height, internal = ca.SX.sym("height"), ca.SX.sym("internal_force")
    parties = (Embodied(form, form.agent.tree), free_hands_beside(form))
    assembly = assemble(parties, TERMS.values(), CaseSymbols(scene, (height,)), switched=switched)
    load_case = assembly.undisturbed
    given = (force_along_x(scene.robot, load_case.hands[ROBOT]) - internal) / PUSH_UNIT
    return Program(
        name="human",
        variables=assembly.variables,
        constraints=(*assembly.constraints, ConstraintBlock("load.given_internal_force", given, 0.0, 0.0)),
        cost=total([load_case.effort({HUMAN: weight}), *load_case.regularisation]),
        parameters={
            "height": height,
            "mass": mass,
            "internal_force": internal,
            **person,
            **assembly.given,
        },
        switches=parted(assembly.parted, lambda: human_program(form, given_scene, weight, switched=True)),
    )
