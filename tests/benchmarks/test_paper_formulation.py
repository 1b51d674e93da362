"""The paper's formulation in a graph against pinocchio with singular values, and against our own solver."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import casadi as ca
import numpy as np
import pytest

from benchmarks.paper_formulation import measure_ours
from benchmarks.paper_posture import PaperProgram, paper_program
from benchmarks.projected_graph import agent_matrices
from evodesign.evaluation.evaluate import Evaluator
from evodesign.mechanics.agent import HUMAN, ROBOT
from evodesign.mechanics.coupled import CoupledModel
from evodesign.mechanics.projected import contact_wrenches, projected_torques
from evodesign.nlp.solver import RawSolution
from evodesign.posture.precompute.precomputed import Precomputed
from evodesign.posture.results import AgentPosture
from evodesign.posture.terms.base import REGULARISATION, TORQUE_UNIT
from evodesign.problem.build import DesignProblem
from evodesign.records import Status
from tests.mechanics.test_projected import boundless, places_of, postures_of, random_case

HEIGHT = 1.0  # [m]
TORQUE = 1e-4  # [N m]
FORCE = 1e-3  # [N] and [N m]


@pytest.fixture(scope="module")
def paper(problem: DesignProblem) -> PaperProgram:
    return paper_program(problem)


@pytest.fixture(scope="module")
def design(problem: DesignProblem) -> tuple[float, ...]:
    """Larger and denser than the unscaled robot."""
    return problem.space.values((0.45,) * len(problem.space.parameters))


@pytest.fixture(scope="module")
def solved(problem: DesignProblem, design: tuple[float, ...]) -> RawSolution:
    """Our whole program without limits on forces, so that it is free to choose the paper's wrenches."""
    solver, _ = boundless(problem)
    start = solver.start
    for variable in solver.program.variables:
        if variable.name.endswith(".joints"):
            start[variable.name] = (variable.lower + variable.upper) / 4.0
    raw = solver.solve({"design": design, "height": HEIGHT}, start)
    assert raw.status is Status.SOLVED, raw.reason
    return raw


def columns(postures: Mapping[str, AgentPosture]) -> list[np.ndarray]:
    """Base and joints of the robot, then of the person."""
    both = (postures[ROBOT], postures[HUMAN])
    return [np.concatenate([p.base_position, p.base_angles, list(p.joints.values())]) for p in both]


def statics(
    paper: PaperProgram, postures: Sequence[np.ndarray], parameters: Sequence[float]
) -> list[np.ndarray]:
    return [np.array(part).ravel() for part in paper.statics(*postures, parameters)]


def test_the_graphs_matrices_are_pinocchios(problem: DesignProblem, design: tuple[float, ...]) -> None:
    case = random_case(problem, 0)  # another person and load, point grasps
    system, first = case.system(), 0
    for place, agent in enumerate(case.agents):
        symbols = ca.SX.sym("design", len(design))
        q = case.places[agent.name]
        posture = np.concatenate([q.base_position, q.base_angles, list(q.joints.values())])
        function = agent_matrices(agent, case.tree_of(agent), case.scene, symbols)
        mass, bias, coupling = (np.array(ca.DM(part)) for part in function(posture, list(design)))
        last = first + len(mass)
        rows = slice(18 * place, 18 * (place + 1))
        assert np.allclose(mass, system.mass[first:last, first:last], atol=1e-10)
        assert np.allclose(bias.ravel(), system.bias[first:last], atol=1e-9)
        assert np.allclose(coupling, system.coupling[rows, first:last].T, atol=1e-10)
        first = last


def test_at_our_postures_the_graph_is_equations_12_and_13(
    problem: DesignProblem, paper: PaperProgram, design: tuple[float, ...], evaluator: Evaluator
) -> None:
    result = evaluator.solve(design)
    model = CoupledModel(problem.scene, result.tree)
    for height in result.cases:
        assert height.solved, height.reason
        torques, wrenches = statics(paper, columns(height.postures), [*design, height.case.task.height_m])
        system = model.at(places_of(height.postures, height.case.task.height_m))
        expected = projected_torques(system)
        assert np.linalg.norm(expected) > 5.0  # zeros would agree with anything
        assert np.abs(torques - expected).max() < TORQUE
        assert np.abs(wrenches - contact_wrenches(system, expected)).max() < FORCE


def test_our_lifted_torques_are_the_graphs(
    problem: DesignProblem, paper: PaperProgram, design: tuple[float, ...], solved: RawSolution
) -> None:
    postures = postures_of(problem.scene, solved)
    torques, _ = statics(paper, columns(postures), [*design, HEIGHT])
    lifted = np.concatenate([list(postures[name].torques.values()) for name in (ROBOT, HUMAN)])
    assert np.linalg.norm(lifted) > 5.0
    assert np.abs(torques - lifted).max() < TORQUE


def test_at_our_posture_the_papers_program_asks_what_ours_does(
    problem: DesignProblem, paper: PaperProgram, design: tuple[float, ...], solved: RawSolution
) -> None:
    """Torques at equal weights, comfort anew in NumPy, and constraints that our solver has met."""
    program = paper.program
    symbols = [variable.symbol for variable in program.variables]
    rows = [constraint.expression for constraint in program.constraints]
    function = ca.Function("program", [*symbols, program.given], [program.cost, *rows])
    values = [solved.values[variable.name] for variable in program.variables]
    cost, *found = function(*values, [*design, HEIGHT])
    expected = sum(np.sum(solved.values[f"{name}.torques"] ** 2) for name in (ROBOT, HUMAN)) / TORQUE_UNIT**2
    for agent in problem.scene.agents:
        joints = [agent.tree.joint_by_name[name] for name in agent.joints]
        ranges = [min(joint.upper, math.pi) - max(joint.lower, -math.pi) for joint in joints]
        bent = np.sum((solved.values[f"{agent.name}.joints"] / ranges) ** 2)
        expected += REGULARISATION * (bent + np.sum(solved.values[f"{agent.name}.base_angles"] ** 2))
    assert float(cost) == pytest.approx(expected, rel=1e-5)
    names = [constraint.name for constraint in program.constraints]
    assert len(names) == 23
    for constraint, row in zip(program.constraints, found, strict=True):
        if not constraint.name.endswith(("_foot_contact", ".push")):  # which this posture was free to break
            assert constraint.lower - 1e-6 <= float(ca.mmin(row)), constraint.name
            assert float(ca.mmax(row)) <= constraint.upper + 1e-6, constraint.name


def test_figures_count_what_was_solved(
    problem: DesignProblem, known: Precomputed, design: tuple[float, ...]
) -> None:
    figures = measure_ours(problem, known, [design], HEIGHT)
    assert (figures.solved, figures.tried) == (1, 1)
    assert 0.0 < figures.seconds_per_iteration < figures.seconds_per_solved_height
    none = measure_ours(problem, known, [], HEIGHT)
    assert (none.solved, none.tried, none.seconds_per_solved_height) == (0, 0, math.inf)
