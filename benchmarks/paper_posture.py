"""The posture problem as the paper states it: torques and wrenches are functions of the posture.

    minimise    w_r |tau_r|^2 + w_h |tau_h|^2 + regularisation     over bases and joints
    with        tau = (N B)^+ N h  and  f by Eq. 13                in the graph (`projected_graph`)

Bounds, starts, and the constraints of hands, feet, stance, ground and push are the very ones of our whole
posture program; the regularisation is ours without its terms in wrenches. The difference: our program chooses
the wrenches and ties torques to them by equalities.

Source: Sartore et al. 2022, Eq. 14 with pi fixed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from benchmarks.projected_graph import DAMPING, Statics, agent_matrices, projected_statics
from evodesign.mechanics.agent import SIDES, Agent
from evodesign.mechanics.scene import Scene
from evodesign.nlp.method import SolverOptions
from evodesign.nlp.program import ConstraintBlock, Program, Variable
from evodesign.nlp.solver import RawSolution, Solver
from evodesign.posture.assemble import CaseSymbols, Embodied, assemble, free_hands_beside, total
from evodesign.posture.check import AgentModel, Checker
from evodesign.posture.results import AgentPosture, Instant
from evodesign.posture.seeking.starts import fixed_starts
from evodesign.posture.symmetry import whole
from evodesign.posture.terms.base import TORQUE_UNIT
from evodesign.posture.terms.load import LOAD_UNIT, push_on_load
from evodesign.posture.terms.registry import TERMS
from evodesign.problem.build import DesignProblem
from evodesign.tree.model import Tree

Array = NDArray[np.float64]
Expression = Any

POSTURE = ("base_position", "base_angles", "joints")
STATICS = ("torques", "force", "moment")


@dataclass(frozen=True, slots=True)
class PaperProgram:
    """The paper's program for all designs and heights.

    Args:
        program: over bases and joints; its parameters are a design's values and the height, as ours.
        statics: function from the robot's and the person's posture (base position and angles, then joints)
            and the parameters to torques [N m] and wrenches [N, N m], in the order of `statics.coupled`.
    """

    program: Program
    statics: Any


class PaperPostures:
    """The paper's program, ready to be solved."""

    def __init__(self, problem: DesignProblem, options: SolverOptions) -> None:
        self._scene, self._space = problem.scene, problem.space
        self._human = AgentModel.of(problem.scene.human, problem.scene.human.tree)
        built = paper_program(problem)
        self._statics = built.statics
        self._solver = Solver(built.program, replace(options, compiled=False))
        self._start = fixed_starts(built.program, ["human"])[0]

    def solve(self, values: Sequence[float], height: float) -> RawSolution:
        """What IPOPT finds for a design at a height [m], from the first of our fixed starts."""
        return self._solver.solve({"design": values, "height": height}, self._start)

    def residual(self, raw: RawSolution, values: Sequence[float], height: float) -> float:
        """The largest residual (SI units) that the independent check finds in a solution."""
        agents = self._scene.agents
        own = {a.name: {part: raw.values[f"{a.name}.{part}"] for part in POSTURE} for a in agents}
        columns = [np.concatenate(list(own[agent.name].values())) for agent in agents]
        found = Statics(*[np.array(part).ravel() for part in self._statics(*columns, [*values, height])])
        torques = np.split(found.torques, [len(self._scene.robot.joints)])
        postures = {
            agent.name: _posture(agent, own[agent.name], torques[place], found, place)
            for place, agent in enumerate(agents)
        }
        tree = self._space.resized(self._scene.robot.tree, values)
        return max(
            residual.size
            for residual in Checker(
                self._scene, AgentModel.of(self._scene.robot, tree), self._human
            ).residuals(Instant(0.0, postures), height)
        )


def paper_program(problem: DesignProblem) -> PaperProgram:
    """Build the graph of a problem; a few seconds."""
    scene, space = problem.scene, problem.space
    design, height = ca.SX.sym("design", len(space.parameters)), ca.SX.sym("height")
    robot_tree = space.resized(scene.robot.tree, ca.vertsplit(design))
    robot = _part(scene.robot, robot_tree, scene, design, height)
    human = _part(scene.human, scene.human.tree, scene, design, height)
    names = {"design": ca.MX.sym("design", len(space.parameters)), "height": ca.MX.sym("height")}
    parameters = ca.vertcat(*names.values())
    postures, matrices = [robot.posture, human.posture], [robot.matrices, human.matrices]
    found = projected_statics(scene, matrices, postures, parameters[:-1], DAMPING)
    outputs = [found.torques, found.wrenches]
    statics = ca.Function("statics", [*postures, parameters], outputs)
    return PaperProgram(_program(problem, (robot, human), found, names), statics)


@dataclass(frozen=True, slots=True)
class _Part:
    """An agent in the graph.

    Args:
        variables: base and joints, MX.
        matrices: SX function from posture and design to M, h and Q^T.
        constraints: of our agent block, less statics.
        rows: SX function from posture, feet's wrenches, design and height to each constraint's expression.
        regularisation: SX function from posture to ours under vanishing wrenches.
    """

    variables: tuple[Variable, ...]
    matrices: Any
    constraints: tuple[ConstraintBlock, ...]
    rows: Any
    regularisation: Any

    @property
    def posture(self) -> Expression:
        """Base position and angles, then joints; their units are SI."""
        return ca.vertcat(*[variable.symbol for variable in self.variables])


def _part(agent: Agent, tree: Tree, scene: Scene, design: Expression, height: Expression) -> _Part:
    form = whole(agent)
    parties = (Embodied(form, tree), *free_hands_beside(form, scene))
    assembly = assemble(parties, TERMS.values(), CaseSymbols(scene, (height,)))
    variables = {v.key.part: v for v in assembly.variables if v.key.party == agent.name}
    posture = ca.vertcat(*[variables[name].value for name in POSTURE])
    feet = ca.SX.sym("feet", 12)
    prefix = f"{agent.name}."
    own = [c for c in assembly.constraints if c.name.startswith(prefix)]
    kept = tuple(c for c in own if c.name.removeprefix(prefix) not in STATICS)
    symbols = [variables[f"{side}_foot"] for side in SIDES]
    rows = ca.substitute(
        [c.expression for c in kept],
        [variable.symbol for variable in symbols],
        [part / symbols[0].scale for part in ca.vertsplit(feet, 6)],
    )
    wrenches = [v.symbol for name, v in variables.items() if name.endswith(("_hand", "_foot"))]
    regularisation = ca.substitute(
        [total(assembly.undisturbed.regularisation)],
        wrenches,
        [ca.SX.zeros(symbol.numel()) for symbol in wrenches],
    )
    return _Part(
        variables=tuple(_in_mx(variables[name]) for name in POSTURE),
        matrices=agent_matrices(agent, tree, scene, design),
        constraints=kept,
        rows=ca.Function("rows", [posture, feet, design, height], rows),
        regularisation=ca.Function("regularisation", [posture], regularisation),
    )


def _in_mx(variable: Variable) -> Variable:
    return replace(variable, symbol=ca.MX.sym(variable.name, variable.symbol.numel()))


def _program(
    problem: DesignProblem, parts: tuple[_Part, _Part], statics: Statics, parameters: Mapping[str, Expression]
) -> Program:
    scene, weights = problem.scene, problem.weights
    constraints = []
    for place, part in enumerate(parts):
        rows = part.rows(part.posture, statics.feet(place), *parameters.values())
        pairs = zip(part.constraints, rows, strict=True)
        constraints += [replace(constraint, expression=row) for constraint, row in pairs]
    push = push_on_load(statics.hands(0)) / LOAD_UNIT
    limit = scene.stance.push / LOAD_UNIT
    robot_joints = len(scene.robot.joints)
    effort = weights.robot * ca.sumsqr(statics.torques[:robot_joints])
    effort += weights.human * ca.sumsqr(statics.torques[robot_joints:])
    return Program(
        name="paper",
        variables=(*parts[0].variables, *parts[1].variables),
        constraints=(*constraints, ConstraintBlock("load.push", push, -limit, limit)),
        cost=effort / TORQUE_UNIT**2 + sum(part.regularisation(part.posture) for part in parts),
        parameters=parameters,
    )


def _posture(
    agent: Agent, values: Mapping[str, Array], torques: Array, found: Statics, place: int
) -> AgentPosture:
    feet = np.split(found.feet(place), len(SIDES))
    both = {f"{side}_foot": foot for side, foot in zip(SIDES, feet, strict=True)}
    both.update({f"{side}_hand": hand for side, hand in found.hands(place).items()})
    return whole(agent).expand({**values, "torques": torques, **both})
