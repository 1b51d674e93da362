"""The posture problem: how robot and person stand with the load at one height, straining least.

    minimise    w_r |tau_r|^2 + w_h |tau_h|^2 + comfort
    subject to  the constraints of both agents and of the load

for any design (a parameter of one program built once). It is solved from the problem's seeds (from two fixed
starts where there are none) and the best result that the independent check accepts is kept: the answer
depends on problem and design alone.

A scene that is its own mirror image is solved for symmetric postures: half the variables and far fewer local
minima. Where the person's value function is known, robot and person are even solved one after the other
(`split`). The full program, started from the symmetric solution, is the polish, and the refuge when no
symmetric posture is found.

Source: Sartore et al. 2022, Eq. 14 with pi fixed; DESIGN 3.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from enum import StrEnum
from functools import cached_property, partial

import casadi as ca

from evodesign.design.space import DesignSpace
from evodesign.mechanics.scene import HUMAN, ROBOT, Scene
from evodesign.nlp.program import IpoptOptions, Program, RawSolution, Start
from evodesign.nlp.solver_cache import SolverCache, program_key
from evodesign.nlp.start_portfolio import NEAR, Landscape
from evodesign.posture.allocation import EffortWeights, shared_scene, shared_weights
from evodesign.posture.candidate import Candidate, Trial, case_solution, cheapest, checked
from evodesign.posture.check import Checker
from evodesign.posture.formulations.decoupled import DecoupledPostures
from evodesign.posture.load_cases import aggregated, cases_of, filled, postures_in_cases, with_cases
from evodesign.posture.precompute.precomputed import NOTHING_PRECOMPUTED, Precomputed
from evodesign.posture.results import AgentPosture, CaseSolution, Neighbour
from evodesign.posture.starts import SEEDS_BESIDE, fixed_starts, named_starts
from evodesign.posture.symmetry import Form, symmetric_forms, whole
from evodesign.posture.terms.agent import AgentBlock, agent_block
from evodesign.posture.terms.load import any_load, load_constraints
from evodesign.posture.terms.torque import TORQUE_UNIT
from evodesign.posture.warm_start import start_from
from evodesign.records import Task

__all__ = ["SYMMETRIC", "PostureProblem", "Symmetry", "posture_program"]

SYMMETRIC = "symmetric"
"""Name in results of the symmetric program over both agents."""


class Symmetry(StrEnum):
    """Which postures are looked for."""

    ON = "on"
    OFF = "off"
    POLISH = "polish"


class PostureProblem:
    """One posture program for all designs and tasks of a scene.

    Args:
        scene: agents, load, ground and stance.
        space: design parameters.
        weights: of the agents' efforts.
        options: of the solver.
        symmetry: which postures are looked for.
        known: seeds, and the person's part at the tasks where it is known.
        shelf: of solvers, if other scenes have programs in common with this one.
    Raises:
        ModelError: symmetric postures of a scene that is not its own mirror image; it says what differs.
    """

    def __init__(
        self,
        scene: Scene,
        space: DesignSpace,
        weights: EffortWeights,
        options: IpoptOptions,
        symmetry: Symmetry,
        known: Precomputed = NOTHING_PRECOMPUTED,
        solvers: SolverCache | None = None,
    ) -> None:
        self._solvers = solvers or SolverCache()
        self._symmetry = symmetry
        self._ingredients = (scene, space, weights, options)
        self._known = known
        self._decoupled_tasks = known.values_of(scene)
        if symmetry is not Symmetry.OFF:
            space.check_mirror(scene.robot.tree)
            self._forms = symmetric_forms(scene)
            if self._decoupled_tasks:
                both = (weights.robot, weights.human)
                self._decoupled = DecoupledPostures(
                    self._forms, scene, space, both, options, self._decoupled_tasks, self._solvers
                )

    def solve(
        self,
        values: Sequence[float],
        task: Task,
        checker: Checker,
        neighbour: Neighbour | None = None,
    ) -> CaseSolution:
        """The best checked posture of a design at one task.

        Args:
            values: one number per design parameter.
            task: of the problem.
            checker: the independent check, made for this design.
            neighbour: what the same design led to in a similar scene; fewer starts do beside it.
        """
        trials: list[Trial] = []
        for trial in self._trials(values, task, checker, neighbour):
            trials.append(trial)
            if trial.best is not None:
                break
        best = trials[-1].best
        if self._symmetry is Symmetry.POLISH and best is not None:
            trials.append(self._full.polish(values, task, best.postures, checker))
        return case_solution(self._ingredients[0].case(task), trials)

    def _trials(
        self, values: Sequence[float], task: Task, checker: Checker, neighbour: Neighbour | None
    ) -> Iterator[Trial]:
        """What each program leads to, in turn."""
        for program, seeds in self._programs(task):
            if neighbour is not None:
                yield program.from_neighbour(values, task, seeds, neighbour, checker)
            yield program.trial(values, task, seeds, checker)

    def landscape(self, task: Task) -> Landscape:
        """The cost at a task of the program that is solved first, of which seeds are made."""
        program, _ = next(self._programs(task))
        return program.landscape(task)

    def _programs(self, task: Task) -> Iterator[tuple[DecoupledPostures | _Postures, tuple[Start, ...]]]:
        """The programs to be solved in turn until one succeeds, with their seeds; a refuge has none."""
        seeds = self._known.seeds(task)
        if self._symmetry is Symmetry.OFF:
            yield self._full, seeds
            return
        if task in self._decoupled_tasks:
            yield self._decoupled, seeds
            yield self._half, ()
        else:
            yield self._half, seeds
        yield self._full, ()

    @cached_property
    def _half(self) -> _Postures:
        """The symmetric program over both agents, built when it is first needed."""
        return _Postures(SYMMETRIC, self._forms, *self._ingredients_of(refuge=bool(self._decoupled_tasks)))

    @cached_property
    def _full(self) -> _Postures:
        """The full program, built when it is first needed."""
        scene = self._ingredients[0]
        ingredients = self._ingredients_of(refuge=self._symmetry is Symmetry.ON)
        return _Postures("whole", (whole(scene.robot), whole(scene.human)), *ingredients)

    def _ingredients_of(
        self, *, refuge: bool
    ) -> tuple[Scene, DesignSpace, EffortWeights, IpoptOptions, SolverCache]:
        """What a program is made of; one that is seldom solved is not worth compiling."""
        scene, space, weights, options = self._ingredients
        options = replace(options, compiled=options.compiled and not refuge)
        return scene, space, weights, options, self._solvers


class _Postures:
    """A posture program over the given forms of both agents."""

    def __init__(
        self,
        name: str,
        forms: tuple[Form, Form],
        scene: Scene,
        space: DesignSpace,
        weights: EffortWeights,
        options: IpoptOptions,
        solvers: SolverCache,
    ) -> None:
        self._name = name
        self._forms = forms
        self._scene, self._mass = scene, scene.payload.mass
        key = (name, program_key(scene, *(form.agent for form in forms)))
        self._solver = solvers.solver(key, lambda: posture_program(forms, scene, space, weights), options)
        self._fixed = fixed_starts(self._solver)

    def landscape(self, task: Task) -> Landscape:
        """The program's cost at a task."""
        return Landscape(self._solver, (task.height_m, self._mass), self._fixed, *NEAR)

    def trial(self, values: Sequence[float], task: Task, seeds: Sequence[Start], checker: Checker) -> Trial:
        """What the seeds lead to, or the fixed starts if there are none."""
        starts = named_starts(self._name, self._solver, seeds, self._fixed)
        ends = [(name, self._solve(values, task, start)) for name, start in starts]
        return cheapest(ends, partial(self._candidate, task, checker))

    def from_neighbour(
        self,
        values: Sequence[float],
        task: Task,
        seeds: Sequence[Start],
        neighbour: Neighbour,
        checker: Checker,
    ) -> Trial:
        """What the solution in a similar scene leads to, and the worthiest seeds."""
        alike = neighbour.solution
        known = start_from(self._forms, self._solver.program, alike.postures, alike.disturbed)
        starts = [
            (f"{self._name}: neighbour", known),
            *named_starts(self._name, self._solver, seeds, self._fixed)[:SEEDS_BESIDE],
        ]
        ends = [(name, self._solve(values, task, start)) for name, start in starts]
        return cheapest(ends, partial(self._candidate, task, checker))

    def polish(
        self, values: Sequence[float], task: Task, postures: Mapping[str, AgentPosture], checker: Checker
    ) -> Trial:
        """What known whole postures lead to."""
        start = start_from(self._forms, self._solver.program, postures)
        end = self._solve(values, task, start)
        return cheapest([(f"{self._name}: polish", end)], partial(self._candidate, task, checker))

    def _solve(self, values: Sequence[float], task: Task, start: Start) -> RawSolution:
        return self._solver.solve([*values, task.height_m, self._mass], filled(start, self._solver.program))

    def _candidate(self, task: Task, checker: Checker, start: str, raw: RawSolution) -> Candidate:
        postures = {form.agent.name: form.expand(raw.of(form.agent.name)) for form in self._forms}
        disturbed = postures_in_cases(self._scene, self._forms, raw.values)
        residuals = checker.residuals(postures, task.height_m, disturbed)
        return Candidate(checked(start, raw, residuals), postures, residuals, disturbed)


def posture_program(
    forms: tuple[Form, Form], scene: Scene, space: DesignSpace, weights: EffortWeights
) -> Program:
    """The program over both agents; its parameters are the design's, then the load's height and mass."""
    scene, mass = any_load(scene)
    design = ca.SX.sym("design", len(space.parameters))
    height = ca.SX.sym("height")
    values = ca.vertsplit(design)
    scene, weights = shared_scene(scene, space, values), shared_weights(weights, space, values)
    tree = space.resized(scene.robot.tree, values)
    robot = agent_block(forms[0], tree, scene, height)
    human = agent_block(forms[1], scene.human.tree, scene, height)
    hands = {ROBOT: robot.hand_wrenches, HUMAN: human.hand_wrenches}
    load = load_constraints(scene, hands, symmetric=forms[0].mirror is not None)
    effort = weights.robot * robot.effort + weights.human * human.effort
    program = Program(
        name="posture",
        variables=(*robot.variables, *human.variables),
        constraints=(*robot.constraints, *human.constraints, *load),
        cost=effort / TORQUE_UNIT**2 + robot.comfort + human.comfort,
        parameters=ca.vertcat(design, height, mass),
    )
    return _disturbed(program, scene, weights, robot, human) if scene.disturbances else program


def _disturbed(
    program: Program, scene: Scene, weights: EffortWeights, robot: AgentBlock, human: AgentBlock
) -> Program:
    """The program with a case for each of the scene's disturbances beside the undisturbed one."""
    cases = cases_of(scene, robot.stand, human.stand)
    pairs = [(robot.bearing, human.bearing)]
    pairs += [(case.bearings[ROBOT], case.bearings[HUMAN]) for case in cases]
    costs = [
        (weights.robot * one.effort + weights.human * other.effort) / TORQUE_UNIT**2
        + one.comfort
        + other.comfort
        for one, other in pairs
    ]
    still = replace(program, cost=robot.stand.comfort + human.stand.comfort)
    return aggregated(with_cases(still, cases), scene.disturbances.effort, costs)
