"""The paper's problem: postures at all heights and the hardware pi as variables of one nonlinear program.

    minimise    W1 sum_k t1_k + W3 sum_k t3_k + W2 t2 + W4 t4 + regularisation
    subject to  every term, for both agents and the load, at every height k

The terms are those of the posture problem, over a robot whose lengths and densities are variables; a genome
(a point of the unit cube) stands for them, so that IPOPT sees numbers of order one. Eq. 14 a to g (load level
at its height, hands on it, feet on the ground and flat) always hold, other groups of limits as `Enforced`
says.

The design is a variable here and not a parameter: there is no landscape over designs and no derivative.

A start is a genome and nothing else: its postures are drawn with a generator seeded by the genome's digits,
so that how a start ends is a property of problem and start alone. Joints begin a random share of the way to
the middle of their ranges, with some spread about it, anew at every height. The named designs of a problem
begin half-way to the middle.

Source: Sartore et al. 2022, Eq. 14.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from evodesign.design.parameter import ParameterKind
from evodesign.design.space import DesignSpace
from evodesign.mechanics.scene import Scene
from evodesign.nlp.method import SolverOptions
from evodesign.nlp.program import Array, Expression, Program, Start, Variable
from evodesign.nlp.solver import RawSolution, Solver
from evodesign.posture.allocation import EffortWeights, shared_scene
from evodesign.posture.assemble import CaseSymbols, LoadCase, assemble
from evodesign.posture.check import AgentModel, Checker, sizes
from evodesign.posture.formulations.base import embodied
from evodesign.posture.limit_groups import Enforced
from evodesign.posture.parting import parted
from evodesign.posture.results import Attempt, CaseSolution, Instant
from evodesign.posture.seeking.candidate import checked
from evodesign.posture.seeking.seeker import Seeker
from evodesign.posture.symmetry import Form, forms_of
from evodesign.posture.terms.base import TORQUE_UNIT, Residual
from evodesign.posture.terms.floating_base import coordinate_ranges
from evodesign.posture.terms.paper_tasks import Tasks, pressure_task
from evodesign.posture.terms.registry import TERMS
from evodesign.posture.terms.torque import effort
from evodesign.posture.warm_start import instants_of, layout_of, start_from
from evodesign.records import Genome, Hold, Status

NAME = "codesign"
"""Of the formulation, in results."""

GENOME = "genome"
"""Name of the variable that holds the design."""

LEAST_LENGTH = 0.1
"""Lower bound of a length multiplier without bounds: with none at all solves end at lengths below zero."""

SHARE = 0.5
"""Of the way from zero to the middle of each joint's range, at which standard postures begin."""

SPREAD = 0.3
"""Standard deviation of a joint about the common share [rad]."""


@dataclass(frozen=True, slots=True)
class JointSettings:
    """What is minimised, and under which limits.

    Args:
        efforts: weights of the agents' torques within t1.
        tasks: t1 to t4 and their weights.
        enforced: which limits hold.
        options: of the solver.
        symmetric: whether postures are mirror-symmetric.
    """

    efforts: EffortWeights
    tasks: Tasks
    enforced: Enforced
    options: SolverOptions
    symmetric: bool


@dataclass(frozen=True, slots=True)
class JointSolution:
    """How one start ended.

    Args:
        design: value of each parameter, of the optimum or of the last iterate.
        cases: a solution per task, all solved or none; residuals are those that the problem enforces.
        violations: what the check found of limits that the problem does not enforce, per case.
        attempt: how the solve ended; its cost is that of Eq. 14 [(10 N m)^2].
    """

    design: tuple[float, ...]
    cases: tuple[CaseSolution, ...]
    violations: tuple[tuple[Residual, ...], ...]
    attempt: Attempt

    @property
    def solved(self) -> bool:
        """Whether solver and check agree on it."""
        return self.attempt.status is Status.SOLVED


class JointProblem:
    """The program of a scene, built once and solved from any number of starts.

    Args:
        scene: agents, load, ground and stance.
        space: design parameters.
        tasks: of the problem.
        settings: costs and limits.
        fixed: a genome that the design is held at; None to optimise it.
    Raises:
        ModelError: symmetric postures of a scene that is not its own mirror image.
    """

    def __init__(
        self,
        scene: Scene,
        space: DesignSpace,
        tasks: Sequence[Hold],
        settings: JointSettings,
        fixed: Genome | None = None,
    ) -> None:
        self._scene = scene
        self._space = space
        self._tasks = tuple(tasks)
        self._enforced = settings.enforced
        self._forms = forms_of(scene, symmetric=settings.symmetric)
        self._human = AgentModel.of(scene.human, scene.human.tree)
        design = _design_variable(space, settings.enforced, fixed)
        self.program = _program(self._forms, scene, space, design, self._tasks, settings)
        self._solver = Solver(self.program, settings.options)

    def solve(self, genome: Genome, *, drawn: bool) -> JointSolution:
        """The local optimum that a start leads to.

        Args:
            genome: the design that it begins with.
            drawn: whether its postures are drawn for the genome, or the standard ones.
        """
        if drawn:
            return self._from("drawn postures", genome, drawn_postures(self.program, self._forms, genome))
        return self._from("standard postures", genome, standard_postures(self.program, self._forms))

    def polish(self, genome: Genome, postures: Sequence[Instant]) -> JointSolution:
        """The local optimum next to known postures, one instant per task."""
        return self._from("polish", genome, start_from(self.program, self._forms, postures))

    def _from(self, name: str, genome: Genome, postures: Start) -> JointSolution:
        start = _inside(self.program, {GENOME: np.array(genome), **postures})
        raw = Seeker(self._solver).settled({}, self._solver.solve({}, start))
        design = _values(self._space, raw.values[GENOME].tolist())
        if raw.status is Status.SOLVED:
            return self._checked(name, design, raw)
        return self._failed(design, checked(NAME, name, raw, ()))

    def _failed(self, design: tuple[float, ...], attempt: Attempt) -> JointSolution:
        reason = f"the joint problem was not solved: {attempt.reason}"
        cases = tuple(
            CaseSolution(self._scene.case(task), attempt.status, reason, attempts=(attempt,))
            for task in self._tasks
        )
        return JointSolution(design, cases, ((),) * len(cases), attempt)

    def _checked(self, name: str, design: tuple[float, ...], raw: RawSolution) -> JointSolution:
        tree = self._space.resized(self._scene.designed_tree, design)
        checker = Checker(
            shared_scene(self._scene, self._space, design),
            AgentModel.of(self._scene.robot, tree),
            self._human,
        )
        layout, tasks = layout_of(self.program), self._tasks
        instants = instants_of(layout, self._forms, self._scene, raw.values, [0.0] * len(tasks))
        found = [checker.residuals(i, task.height_m) for i, task in zip(instants, tasks, strict=True)]
        kept = [tuple(r for r in of if self._enforced.covers(r.group)) for of in found]
        everywhere = [
            replace(residual, name=f"{task}, {residual.name}")
            for task, of in zip(tasks, kept, strict=True)
            for residual in of
        ]
        attempt = checked(NAME, name, raw, everywhere)
        if attempt.status is not Status.SOLVED:
            return self._failed(design, attempt)
        cases = tuple(
            CaseSolution(
                self._scene.case(task), Status.SOLVED, "solved", (instant,), sizes(of), (attempt,), attempt
            )
            for task, instant, of in zip(tasks, instants, kept, strict=True)
        )
        missed = tuple(tuple(r for r in of if not self._enforced.covers(r.group)) for of in found)
        return JointSolution(design, cases, missed, attempt)


def standard_postures(program: Program, forms: Sequence[Form]) -> Start:
    """Joints of every agent at every height half-way to the middle of their ranges, by variable name."""
    return {name: SHARE * middle for name, middle in _middles(program, forms).items()}


def drawn_postures(program: Program, forms: Sequence[Form], genome: Genome) -> Start:
    """Joints of every agent at every height, drawn for a genome, by variable name."""
    digest = hashlib.sha256(np.array(genome).tobytes()).digest()
    rng = np.random.default_rng(int.from_bytes(digest))
    return {
        name: rng.uniform() * middle + SPREAD * rng.standard_normal(len(middle))
        for name, middle in _middles(program, forms).items()
    }


def _middles(program: Program, forms: Sequence[Form]) -> dict[str, np.ndarray]:
    """The middle of every joint's range, by variable name, in the program's order."""
    middles = {form.agent.name: np.mean(coordinate_ranges(form), axis=1) for form in forms}
    return {name: middles[slot.party] for slot, name in layout_of(program).items() if slot.part == "joints"}


def _inside(program: Program, start: Mapping[str, Array]) -> dict[str, Array]:
    """Starting values moved inside the bounds."""
    bounds = {v.name: (v.lower, v.upper) for v in program.variables}
    return {name: np.clip(value, *bounds[name]) for name, value in start.items()}


def _values(space: DesignSpace, genome: Sequence[Expression]) -> tuple[Expression, ...]:
    """Parameter values of a genome of numbers or expressions, also outside the unit cube."""
    return tuple(
        parameter.lower * (parameter.upper / parameter.lower) ** share
        if parameter.logarithmic
        else parameter.lower * (1.0 - share) + parameter.upper * share
        for parameter, share in zip(space.parameters, genome, strict=True)
    )


def _design_variable(space: DesignSpace, enforced: Enforced, fixed: Genome | None) -> Variable:
    if fixed is not None:
        return Variable.column(GENOME, fixed, fixed, fixed, 1.0)
    lower, upper = [0.0] * len(space.parameters), [1.0] * len(space.parameters)
    for index, parameter in enumerate(space.parameters):
        if parameter.kind is ParameterKind.LENGTH and not enforced.lengths:
            lower[index] = (LEAST_LENGTH - parameter.lower) / (parameter.upper - parameter.lower)
            upper[index] = np.inf
    return Variable.column(GENOME, lower, upper, [0.5] * len(lower), 1.0)


def _program(
    forms: tuple[Form, ...],
    scene: Scene,
    space: DesignSpace,
    design: Variable,
    tasks: Sequence[Hold],
    settings: JointSettings,
    *,
    switched: bool = False,
) -> Program:
    given_scene = scene
    values = _values(space, ca.vertsplit(design.value))
    scene = shared_scene(scene, space, values)
    tree = space.resized(scene.designed_tree, values)
    cost = settings.tasks.of_design(space, values, scene.robot, tree)
    case = CaseSymbols(scene, tuple(task.height_m for task in tasks))
    assembly = assemble(
        embodied(forms, space, values), TERMS.values(), case, settings.enforced, switched=switched
    )
    for (load_case,) in assembly.instants:
        for part in _height_costs(load_case, settings):
            cost += part
    variables = (design, *assembly.variables)
    switches = parted(
        assembly.parted,
        lambda: _program(forms, given_scene, space, design, tasks, settings, switched=True),
    )
    return Program("joint", variables, assembly.constraints, cost, assembly.given, switches)


def _height_costs(load_case: LoadCase, settings: JointSettings) -> list[Expression]:
    """Each agent's W1 t1 + W3 t3 + regularisation at one height, then the system's costs."""
    tasks = settings.tasks.weights
    weights = settings.efforts.by_agent(body.agent for body in load_case.bodies.values())
    costs = []
    for position, (name, body) in enumerate(load_case.bodies.items()):
        cost = (
            tasks.torque * weights[name] * effort(body) / TORQUE_UNIT**2 + load_case.posture_costs[position]
        )
        if tasks.center_of_pressure:
            shown = len(body.agent.feet) / len(body.feet)
            cost += tasks.center_of_pressure * shown * pressure_task(body.feet)
        costs.append(cost + load_case.costs[position])
    return [*costs, load_case.posture_costs[-1] + load_case.costs[-1]]
