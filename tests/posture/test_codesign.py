"""The joint problem: the same optimum as posture by posture, the paper's torques, and every task felt."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import casadi as ca
import numpy as np
import pytest

from evodesign.design.parameter import ParameterKind
from evodesign.evaluation.baseline import broken_limits, torque_difference
from evodesign.mechanics.projected import center_of_pressure
from evodesign.nlp.method import SolverOptions
from evodesign.posture.allocation import EffortWeights
from evodesign.posture.check import AgentModel, Checker
from evodesign.posture.formulations.base import Setting
from evodesign.posture.formulations.codesign import (
    JointProblem,
    JointSettings,
    JointSolution,
    drawn_postures,
    standard_postures,
)
from evodesign.posture.limit_groups import Enforced
from evodesign.posture.postures import PostureProblem, Symmetry
from evodesign.posture.symmetry import symmetric_forms
from evodesign.posture.terms.paper_tasks import Tasks, TaskWeights, density_task, mass_height_task
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.source import read_source
from evodesign.records import Hold, Status

ONE = Hold(height_m=1.0)
OPTIONS = SolverOptions(iterations=1000, seconds=600.0)
LIMITS = Enforced()
NO_LIMITS = Enforced(joint_limits=False, contact=False, stance=False, lengths=False)
PUBLISHED_HUMAN = {0.8: 192.4, 1.0: 141.6, 1.2: 120.6, 1.5: 113.1}


@pytest.fixture(scope="module")
def paper(repository: Path) -> DesignProblem:
    return build_problem(read_source(repository / "problems" / "sartore2022.toml"))


@pytest.fixture(scope="module")
def published(repository: Path) -> DesignProblem:
    return build_problem(read_source(repository / "problems" / "sartore2022_as_published.toml"))


def settings(weights: TaskWeights, enforced: Enforced = LIMITS, *, symmetric: bool = True) -> JointSettings:
    tasks = Tasks(weights, (1405.0, 4000.0))
    return JointSettings(EffortWeights(), tasks, enforced, OPTIONS, symmetric)


@pytest.mark.parametrize("symmetry", [Symmetry.ON, Symmetry.OFF])
@pytest.mark.parametrize("design", [0, pytest.param(1, marks=pytest.mark.slow)])
def test_with_the_design_held_the_joint_optimum_is_that_of_the_postures(
    paper: DesignProblem, symmetry: Symmetry, design: int
) -> None:
    """Bounds of the design equal, started from the postures' optima: the costs add up, the torques agree."""
    tasks, genome = (Hold(height_m=0.8), ONE), paper.start[design]
    scene, space = paper.scene, paper.space
    values = space.values(genome)
    checker = Checker(
        scene,
        AgentModel.of(scene.robot, space.resized(scene.robot.tree, values)),
        AgentModel.of(scene.human, scene.human.tree),
    )
    postures = PostureProblem(Setting(scene, space, EffortWeights(), OPTIONS), symmetry)
    alone = [postures.solve(values, task, checker) for task in tasks]
    cost = sum(min(a.cost for a in one.attempts if a.status is Status.SOLVED) for one in alone)
    chosen = settings(TaskWeights(), symmetric=symmetry is Symmetry.ON)
    chosen = replace(chosen, options=replace(OPTIONS, near=True))  # to stay with the optimum it begins at
    joint = JointProblem(scene, space, tasks, chosen, fixed=genome)
    together = joint.polish(genome, [one.instants[0] for one in alone])
    assert together.solved
    assert together.design == pytest.approx(values, rel=1e-9)
    assert together.attempt.cost == pytest.approx(cost, rel=1e-5)
    for one, other in zip(together.cases, alone, strict=True):
        for agent in one.postures:
            norm = other.postures[agent].torque_norm
            assert one.postures[agent].torque_norm == pytest.approx(norm, rel=1e-5, abs=1e-4)


def test_freed_the_design_costs_less_than_held(paper: DesignProblem) -> None:
    """And the optimum of all costs more at any neighbour of its design."""
    chosen, scene, tasks = settings(TaskWeights()), paper.scene, (ONE,)
    free = JointProblem(scene, paper.space, tasks, chosen).solve(paper.start[1], drawn=False)
    held = JointProblem(scene, paper.space, tasks, chosen, fixed=paper.start[1])
    start = held.solve(paper.start[1], drawn=False)
    assert free.solved
    assert start.solved
    assert free.attempt.cost < 0.9 * start.attempt.cost
    best = np.array(paper.space.genome(free.design))
    rng = np.random.default_rng(3)
    for _ in range(3):
        near = tuple(np.clip(best + 0.02 * rng.standard_normal(len(best)), 0.0, 1.0).tolist())
        beside = JointProblem(scene, paper.space, tasks, chosen, fixed=near)
        found = beside.polish(near, [free.cases[0].instants[0]])
        assert found.attempt.cost >= free.attempt.cost - 1e-7


@pytest.fixture(scope="module")
def as_published(published: DesignProblem) -> JointSolution:
    problem = JointProblem(published.scene, published.space, published.tasks, published.joint)
    return problem.solve(published.joint_start[0], drawn=False)


def test_the_published_setting_gives_the_papers_torques(
    published: DesignProblem, as_published: JointSolution
) -> None:
    assert as_published.solved, as_published.attempt.reason
    assert torque_difference(published, as_published) < 1e-5


def test_the_published_setting_shows_its_weakness(as_published: JointSolution) -> None:
    """Human torque far below the table, and limits broken: a joint's range and a foot's contact."""
    for height in as_published.cases:
        assert height.postures["human"].torque_norm < 0.1 * PUBLISHED_HUMAN[height.case.task.height_m]
    worst: dict[str, float] = {}
    for residual in (residual for found in as_published.violations for residual in found):
        worst[residual.name] = max(worst.get(residual.name, 0.0), residual.size)
    assert max(worst["robot.joint_limits"], worst["human.joint_limits"]) > 0.05  # [rad]
    assert max(worst["robot.foot_contact"], worst["human.foot_contact"]) > 10.0  # [N]
    assert "joint limits" in broken_limits([as_published])
    missed = {residual.name for found in as_published.violations for residual in found}
    assert not any("feet_flat" in name for name in missed)


def test_a_foot_is_never_flat_upside_down(as_published: JointSolution) -> None:
    """The check would find a difference of two between the sole's z and the world's."""
    for height in as_published.cases:
        assert height.residuals["robot.feet_flat"] < 1e-5
        assert height.residuals["human.feet_flat"] < 1e-5


def test_without_limits_equation_14_remains(paper: DesignProblem) -> None:
    """Hands, flat feet, the statics of both agents and of the load; nothing else."""
    joint = JointProblem(
        paper.scene, paper.space, (ONE,), settings(TaskWeights(), NO_LIMITS, symmetric=False)
    )
    names = {constraint.name for constraint in joint.program.constraints}
    sides = [f"{side}_{what}" for side in ("left", "right") for what in ("hand_on_load", "foot_flat")]
    words = [*sides, "torques", "force", "moment"]
    own = {f"{agent}.{word}" for agent in ("robot", "human") for word in words}
    assert names == own | {"load.balance", "feet.upright"}
    bounds = {variable.name: variable for variable in joint.program.variables}
    assert np.isinf(bounds["robot.joints"].upper).all()
    assert np.isinf(bounds["human.left_foot"].upper).all()
    lengths = [p.kind is ParameterKind.LENGTH for p in paper.space.parameters]
    assert (np.isinf(joint.program.variables[0].upper) == lengths).all()


def test_with_limits_every_residual_of_the_check_is_enforced(
    paper: DesignProblem, as_published: JointSolution
) -> None:
    names = set(as_published.cases[0].residuals)
    missed = {residual.name: residual for residual in as_published.violations[0]}
    assert not names & set(missed)
    assert all(LIMITS.covers(residual.group) for residual in missed.values())
    assert {name.rsplit(".", 1)[1] for name in names} == {
        "torque",
        "force_balance",
        "moment_balance",
        "hands_on_load",
        "feet_on_ground",
        "feet_flat",
        "grasp",
    }


def test_densities_go_where_they_are_preferred(paper: DesignProblem) -> None:
    chosen = settings(TaskWeights(density=1.0))
    found = JointProblem(paper.scene, paper.space, (ONE,), chosen).solve(paper.start[0], drawn=False)
    assert found.solved
    for parameter, value in zip(paper.space.parameters, found.design, strict=True):
        if parameter.kind is ParameterKind.DENSITY:
            assert min(abs(value - 1405.0), abs(value - 4000.0)) < 5.0


def test_pressure_goes_to_the_middle_of_the_soles(paper: DesignProblem) -> None:
    """t3, computed from the wrenches by other code, falls by nine tenths when it is asked for."""

    def distance(weight: float) -> float:
        chosen = settings(TaskWeights(center_of_pressure=weight))
        joint = JointProblem(paper.scene, paper.space, (ONE,), chosen, fixed=paper.start[1])
        solution = joint.solve(paper.start[1], drawn=False)
        assert solution.solved
        feet = [w for p in solution.cases[0].postures.values() for n, w in p.wrenches.items() if "foot" in n]
        return float(sum(np.square(center_of_pressure(wrench)).sum() for wrench in feet))

    assert distance(1e4) < 0.1 * distance(0.0)


def test_a_higher_centre_of_mass_is_bought_with_torque(paper: DesignProblem) -> None:
    heights = {}
    for weight in (0.0, 10.0):
        chosen = settings(TaskWeights(mass_height=weight))
        found = JointProblem(paper.scene, paper.space, (ONE,), chosen).solve(paper.start[1], drawn=False)
        tree = paper.space.resized(paper.scene.robot.tree, found.design)
        heights[weight] = float(mass_height_task(paper.scene.robot, tree)) ** -0.5
    assert heights[10.0] > heights[0.0] + 0.02


def test_the_density_task_is_a_sum_of_products(paper: DesignProblem) -> None:
    """Against the formula as printed, up to the smoothing at zero."""
    rng = np.random.default_rng(1)
    values = paper.space.values(tuple(rng.uniform(size=len(paper.space.parameters)).tolist()))
    preferred = (1405.0, 4000.0)
    densities = [
        value
        for parameter, value in zip(paper.space.parameters, values, strict=True)
        if parameter.kind is ParameterKind.DENSITY
    ]
    printed = sum(np.prod([abs(value - rho) / 1000.0 for rho in preferred]) for value in densities)
    found = float(density_task(paper.space, values, preferred))
    assert found == pytest.approx(printed, abs=8 * 0.01 * 3.0)
    assert found <= printed
    exact = [1405.0 if p.kind is ParameterKind.DENSITY else 1.0 for p in paper.space.parameters]
    assert float(density_task(paper.space, exact, preferred)) == 0.0


def test_tasks_of_expressions_are_those_of_numbers(paper: DesignProblem) -> None:
    values = paper.space.values(paper.start[1])
    symbols = ca.SX.sym("design", len(values))
    tasks = Tasks(TaskWeights(density=0.3, mass_height=0.7), (1405.0, 4000.0))
    tree = paper.scene.robot.tree
    written = [
        tasks.of_design(paper.space, pi, paper.scene.robot, paper.space.resized(tree, pi))
        for pi in (ca.vertsplit(symbols), values)
    ]
    evaluated = ca.Function("tasks", [symbols], [written[0]])(values)
    assert float(evaluated) == pytest.approx(float(written[1]), rel=1e-12)


def test_a_start_that_fails_says_why(paper: DesignProblem) -> None:
    chosen = replace(settings(TaskWeights()), options=replace(OPTIONS, iterations=3))
    found = JointProblem(paper.scene, paper.space, (ONE,), chosen).solve(paper.start[1], drawn=True)
    assert not found.solved
    assert found.attempt.status is Status.ITERATION_LIMIT
    assert found.cases[0].status is Status.ITERATION_LIMIT
    assert "Maximum_Iterations_Exceeded" in found.cases[0].reason


def test_starts_are_drawn_from_the_genome_alone(paper: DesignProblem) -> None:
    forms = symmetric_forms(paper.scene)
    program = JointProblem(
        paper.scene, paper.space, (Hold(height_m=0.8), Hold(height_m=1.0)), settings(TaskWeights())
    ).program
    first, again = (drawn_postures(program, forms, paper.start[1]) for _ in range(2))
    other = drawn_postures(program, forms, paper.start[0])
    assert first.keys() == again.keys() == standard_postures(program, forms).keys()
    for name, value in first.items():
        assert np.array_equal(value, again[name])
        assert not np.allclose(value, other[name])
    assert not np.allclose(first["instant_0.robot.joints"], first["instant_1.robot.joints"])
