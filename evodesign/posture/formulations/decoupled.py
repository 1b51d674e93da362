"""Robot and person solved one after the other, joined by the push between them.

Where `HumanValue` knows the person's least cost V(X) at a height, the robot alone is solved against it,

    minimise  w_r |tau_r|^2 + comfort_r + V(X)

and then the person at the push X that was found. The programs are half as large again, local minima are a
third as many, and the person's many starts are paid for once.

Source: DESIGN 3.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial

import casadi as ca
import numpy as np

from evodesign.design.space import DesignSpace
from evodesign.mechanics.scene import HUMAN, ROBOT, Scene
from evodesign.nlp.program import IpoptOptions, Program, RawSolution, Start
from evodesign.nlp.solver_cache import SolverCache, program_key
from evodesign.nlp.start_portfolio import NEAR, Landscape
from evodesign.posture.candidate import Candidate, Trial, cheapest, checked
from evodesign.posture.check import Checker
from evodesign.posture.formulations.human_value import TERMS, HumanProblem, HumanValue, chebyshev_sum
from evodesign.posture.results import Neighbour
from evodesign.posture.starts import SEEDS_BESIDE, fixed_starts, named_starts
from evodesign.posture.symmetry import Form
from evodesign.posture.terms.agent import agent_block
from evodesign.posture.terms.grasp import free_hands
from evodesign.posture.terms.load import any_load, load_constraints, push_of
from evodesign.posture.terms.torque import TORQUE_UNIT
from evodesign.posture.warm_start import start_from
from evodesign.records import Status, Task, worst_status

__all__ = ["DECOUPLED", "DecoupledPostures", "robot_program"]

DECOUPLED = "split"
"""The program's name in results."""

AT_LIMIT = 1e-6
"""How little below its limit a push [N] counts as being there; IPOPT ends a little before it."""


class DecoupledPostures:
    """The robot's program against the person's value function, for the tasks that have one."""

    def __init__(
        self,
        forms: tuple[Form, Form],
        scene: Scene,
        space: DesignSpace,
        weights: tuple[float, float],
        options: IpoptOptions,
        values: Mapping[Task, HumanValue],
        solvers: SolverCache,
    ) -> None:
        self._forms = forms
        self._scene = scene
        self._values = values
        self._robot = solvers.solver(
            (DECOUPLED, program_key(scene)),
            lambda: robot_program(forms[0], scene, space, weights[0]),
            options,
        )
        self._human = HumanProblem(forms[1], scene, weights[1], options, solvers)
        self._fixed = fixed_starts(self._robot)

    def landscape(self, task: Task) -> Landscape:
        """The robot's cost at a task, with V(X)."""
        return Landscape(self._robot, self._beside(task), self._fixed, *NEAR)

    def trial(self, values: Sequence[float], task: Task, seeds: Sequence[Start], checker: Checker) -> Trial:
        """What the seeds (or else the fixed starts) lead the robot to, with the person beside it."""
        parameters = [*values, *self._beside(task)]
        starts = named_starts(DECOUPLED, self._robot, seeds, self._fixed)
        ends = [(name, self._robot.solve(parameters, start)) for name, start in starts]
        return cheapest(ends, partial(self._candidate, task, checker))

    def from_neighbour(
        self,
        values: Sequence[float],
        task: Task,
        seeds: Sequence[Start],
        neighbour: Neighbour,
        checker: Checker,
    ) -> Trial:
        """What the robot's posture in a similar scene leads to: it is close; and the worthiest seeds.

        With the same load the other person's V(X) is all that differs, and no seed is needed.
        """
        parameters = [*values, *self._beside(task)]
        known = start_from(self._forms, self._robot.program, neighbour.solution.postures)
        ends = [(f"{DECOUPLED}: neighbour", self._robot.near.solve(parameters, known))]
        if not neighbour.same_load:
            starts = named_starts(DECOUPLED, self._robot, seeds, self._fixed)[:SEEDS_BESIDE]
            ends += [(name, self._robot.solve(parameters, start)) for name, start in starts]
        return cheapest(ends, partial(self._candidate, task, checker))

    def _beside(self, task: Task) -> tuple[float, ...]:
        """The robot's parameters beside the design's."""
        return (task.height_m, self._scene.payload.mass, *self._values[task].coefficients)

    def _candidate(self, task: Task, checker: Checker, start: str, robot: RawSolution) -> Candidate:
        """The robot's posture with the person's at the push that was found."""
        value = self._values[task]
        push = self._push(robot)
        human = self._human.best(task.height_m, push, value)
        both = _joined(robot, human, float(value.cost(push)))
        if human.status is not Status.SOLVED:
            return Candidate(checked(start, both, {}), {}, {})
        solutions = ((self._forms[0], robot), (self._forms[1], human))
        postures = {form.agent.name: form.expand(raw.of(form.agent.name)) for form, raw in solutions}
        residuals = checker.residuals(postures, task.height_m)
        return Candidate(checked(start, both, residuals), postures, residuals)

    def _push(self, robot: RawSolution) -> float:
        posture = self._forms[0].expand(robot.of(ROBOT))
        push = float(push_of(self._scene.robot, {s: ca.DM(w) for s, w in posture.hand_wrenches.items()}))
        limit = self._scene.stance.push
        return float(np.copysign(limit, push)) if abs(push) > limit - AT_LIMIT else push


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


def robot_program(form: Form, scene: Scene, space: DesignSpace, weight: float) -> Program:
    """The robot's program; its parameters are the design's, the load's height and mass, V's coefficients."""
    scene, mass = any_load(scene)
    design = ca.SX.sym("design", len(space.parameters))
    height, coefficients = ca.SX.sym("height"), ca.SX.sym("value", TERMS)
    tree = space.resized(scene.robot.tree, ca.vertsplit(design))
    robot = agent_block(form, tree, scene, height)
    human = free_hands(form, scene)
    hands = {ROBOT: robot.hand_wrenches, HUMAN: human.wrenches}
    push = push_of(scene.robot, robot.hand_wrenches) / scene.stance.push
    value = chebyshev_sum(ca.vertsplit(coefficients), push)
    return Program(
        name="robot",
        variables=(*robot.variables, *human.variables),
        constraints=(*robot.constraints, *load_constraints(scene, hands, symmetric=True)),
        cost=weight * robot.effort / TORQUE_UNIT**2 + robot.comfort + value,
        parameters=ca.vertcat(design, height, mass, coefficients),
    )
