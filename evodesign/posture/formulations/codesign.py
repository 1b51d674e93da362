"""The paper's problem: postures at all heights and the hardware pi as variables of one nonlinear program.

    minimise    W1 sum_k t1_k + W3 sum_k t3_k + W2 t2 + W4 t4 + comfort
    subject to  the constraints of both agents and of the load, at every height k

The blocks are those of the posture problem, over a robot whose lengths and densities are variables; a genome
(a point of the unit cube) stands for them, so that IPOPT sees numbers of order one. Eq. 14 a to g (load level
at its height, hands on it, feet on the ground and flat) always hold, physical limits as `Enforced` says.

Without joint limits a foot can be flat upside down, which Eq. 14 f and g (e_3 . z = 1) exclude; an inequality
does so then. Where the limits of contact are not enforced the small cost on wrenches is left out too, so that
torques are exactly those of Eq. 12.

Source: Sartore et al. 2022, Eq. 14; DESIGN 3 (joint baseline).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np

from evodesign.design.space import DesignSpace, ParameterKind
from evodesign.mechanics.scene import HUMAN, ROBOT, SIDES, Scene
from evodesign.nlp.program import Constraint, IpoptOptions, Program, RawSolution, Solver, Variable
from evodesign.posture.allocation import EffortWeights, shared_scene
from evodesign.posture.candidate import checked
from evodesign.posture.check import AgentModel, Checker
from evodesign.posture.formulations.codesign_start import drawn_postures, standard_postures
from evodesign.posture.limit_groups import Enforced
from evodesign.posture.results import AgentPosture, Attempt, CaseSolution, Instant
from evodesign.posture.symmetry import Form, symmetric_forms, whole
from evodesign.posture.terms.agent import AgentBlock, agent_block
from evodesign.posture.terms.load import load_constraints
from evodesign.posture.terms.paper_tasks import Tasks, pressure_task
from evodesign.posture.terms.torque import TORQUE_UNIT
from evodesign.records import Genome, Status, Task

__all__ = ["JointProblem", "JointSettings", "JointSolution"]

Array = Any
Expression = Any

GENOME = "genome"
"""Name of the variable that holds the design."""

LEAST_LENGTH = 0.1
"""Lower bound of a length multiplier without bounds: with none at all solves end at lengths below zero."""


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
    options: IpoptOptions
    symmetric: bool


@dataclass(frozen=True, slots=True)
class JointSolution:
    """How one start ended.

    Args:
        design: value of each parameter, of the optimum or of the last iterate.
        cases: a solution per task, all solved or none; residuals are those that the problem enforces.
        violations: what the check found of limits that the problem does not enforce, per case, by name.
        attempt: how the solve ended; its cost is that of Eq. 14 [(10 N m)^2].
    """

    design: tuple[float, ...]
    cases: tuple[CaseSolution, ...]
    violations: tuple[Mapping[str, float], ...]
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
        tasks: Sequence[Task],
        settings: JointSettings,
        fixed: Genome | None = None,
    ) -> None:
        self._scene = scene
        self._space = space
        self._tasks = tuple(tasks)
        self._enforced = settings.enforced
        both = (whole(scene.robot), whole(scene.human))
        self._forms = symmetric_forms(scene) if settings.symmetric else both
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
        count = len(self._tasks)
        postures = (
            drawn_postures(self._forms, count, genome) if drawn else standard_postures(self._forms, count)
        )
        name = "joint: drawn postures" if drawn else "joint: standard postures"
        return self._from(name, {GENOME: np.array(genome), **postures})

    def polish(self, genome: Genome, postures: Sequence[Mapping[str, AgentPosture]]) -> JointSolution:
        """The local optimum next to known postures, one pair per height."""
        rows = {v.name: v.symbol.numel() for v in self.program.variables}
        start = {GENOME: np.array(genome)}
        for index, agents in enumerate(postures):
            prefix = _prefix(index)
            own = {
                name.removeprefix(prefix): count for name, count in rows.items() if name.startswith(prefix)
            }
            for form in self._forms:
                values = form.start(agents[form.agent.name], own)
                start |= {f"{prefix}{name}": value for name, value in values.items()}
        return self._from("joint: polish", start)

    def _from(self, name: str, start: Mapping[str, Array]) -> JointSolution:
        raw = self._solver.solve([], _inside(self.program, start))
        design = _values(self._space, raw.values[GENOME].tolist())
        if raw.status is Status.SOLVED:
            return self._checked(name, design, raw)
        return self._failed(design, checked(name, raw, {}))

    def _failed(self, design: tuple[float, ...], attempt: Attempt) -> JointSolution:
        reason = f"the joint problem was not solved: {attempt.reason}"
        cases = tuple(
            CaseSolution(self._scene.case(task), attempt.status, reason, attempts=(attempt,))
            for task in self._tasks
        )
        return JointSolution(design, cases, ({},) * len(cases), attempt)

    def _checked(self, name: str, design: tuple[float, ...], raw: RawSolution) -> JointSolution:
        tree = self._space.resized(self._scene.robot.tree, design)
        checker = Checker(shared_scene(self._scene, self._space, design), tree, self._human)
        postures = [self._postures(raw, index) for index in range(len(self._tasks))]
        found = [checker.residuals(p, t.height_m) for p, t in zip(postures, self._tasks, strict=True)]
        kept = [self._enforced.kept(residuals) for residuals in found]
        everywhere = {
            f"{task}, {n}": x for task, of in zip(self._tasks, kept, strict=True) for n, x in of.items()
        }
        attempt = checked(name, raw, everywhere)
        if attempt.status is not Status.SOLVED:
            return self._failed(design, attempt)
        cases = tuple(
            CaseSolution(
                self._scene.case(task), Status.SOLVED, "solved", (Instant(0.0, p),), of, (attempt,), name
            )
            for task, p, of in zip(self._tasks, postures, kept, strict=True)
        )
        missed = tuple(self._enforced.missed(residuals) for residuals in found)
        return JointSolution(design, cases, missed, attempt)

    def _postures(self, raw: RawSolution, index: int) -> dict[str, AgentPosture]:
        return {f.agent.name: f.expand(raw.of(f"{_prefix(index)}{f.agent.name}")) for f in self._forms}


def _prefix(index: int) -> str:
    """What begins the names of variables and constraints of the posture at the height of an index."""
    return f"height_{index}."


def _inside(program: Program, start: Mapping[str, Array]) -> dict[str, Array]:
    """Starting values moved inside the bounds."""
    bounds = {v.name: (v.lower, v.upper) for v in program.variables}
    return {name: np.clip(value, *bounds[name]) for name, value in start.items()}


def _values(space: DesignSpace, genome: Sequence[Expression]) -> tuple[Expression, ...]:
    """Parameter values of a genome of numbers or expressions, also outside the unit cube."""
    return tuple(
        parameter.lower * (1.0 - share) + parameter.upper * share
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
    forms: tuple[Form, Form],
    scene: Scene,
    space: DesignSpace,
    design: Variable,
    tasks: Sequence[Task],
    settings: JointSettings,
) -> Program:
    values = _values(space, ca.vertsplit(design.value))
    scene = shared_scene(scene, space, values)
    tree = space.resized(scene.robot.tree, values)
    cost = settings.tasks.of_design(space, values, scene.robot, tree)
    variables, constraints = [design], list[Constraint]()
    for index, task in enumerate(tasks):
        robot = agent_block(forms[0], tree, scene, task.height_m)
        human = agent_block(forms[1], scene.human.tree, scene, task.height_m)
        hands = {ROBOT: robot.hand_wrenches, HUMAN: human.hand_wrenches}
        load = load_constraints(scene, hands, symmetric=forms[0].mirror is not None)
        rows = _asked((*robot.constraints, *human.constraints, *load), (robot, human), settings.enforced)
        constraints += [replace(c, name=_prefix(index) + c.name) for c in rows]
        for block, weight in ((robot, settings.efforts.robot), (human, settings.efforts.human)):
            own = [settings.enforced.variable(variable) for variable in block.variables]
            variables += [replace(v, name=_prefix(index) + v.name) for v in own]
            cost += _height_cost(block, weight, settings)
    return Program("joint", tuple(variables), tuple(constraints), cost, ca.SX.zeros(0))


def _asked(every: Sequence[Constraint], blocks: Sequence[AgentBlock], enforced: Enforced) -> list[Constraint]:
    """The constraints that are enforced, and upright feet where joint limits do not see to them."""
    rows = [constraint for constraint in every if enforced.covers(constraint.name)]
    if not enforced.joint_limits:
        upright = [z for block in blocks for z in block.stand.uprights.values()]
        rows.append(Constraint("feet.upright", ca.vertcat(*upright), 0.0, np.inf))
    return rows


def _height_cost(block: AgentBlock, weight: float, settings: JointSettings) -> Expression:
    """An agent's W1 t1 + W3 t3 + comfort at one height."""
    weights = settings.tasks.weights
    cost = weights.torque * weight * block.effort / TORQUE_UNIT**2 + block.stand.comfort
    if weights.center_of_pressure:
        feet = {v.name: v.value for v in block.variables if v.name.endswith("_foot")}
        cost += weights.center_of_pressure * len(SIDES) / len(feet) * pressure_task(feet)
    return cost + block.bearing.comfort if settings.enforced.contact else cost
