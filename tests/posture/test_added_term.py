"""A new term is one file and one line: it enters every program, the check, derivatives and sentences."""

from __future__ import annotations

from dataclasses import dataclass

import pytest

from evodesign.mechanics.agent import HUMAN, ROBOT
from evodesign.posture.check import AgentModel, Checker, sizes
from evodesign.posture.formulations.base import Setting
from evodesign.posture.formulations.codesign import JointProblem
from evodesign.posture.formulations.person import person_program
from evodesign.posture.formulations.reach import ReachProblem
from evodesign.posture.postures import PostureProblem, Symmetry
from evodesign.posture.results import CaseSolution
from evodesign.posture.solution_derivative import PostureDerivative
from evodesign.posture.symmetry import symmetric_forms
from evodesign.posture.terms.registry import TERMS
from evodesign.problem.build import DesignProblem
from evodesign.records import Hold, Status
from tests.posture.center_of_mass_term import mass_height

HEIGHT, HIGHER = 0.8, 0.02  # [m]
HOLD = Hold(height_m=HEIGHT)
ROWS = {f"{agent}.mass_height" for agent in (ROBOT, HUMAN)}


@dataclass(frozen=True)
class Bench:
    setting: Setting
    design: tuple[float, ...]
    checker: Checker

    def solve(self, problem: PostureProblem) -> CaseSolution:
        return problem.solve(self.design, HOLD, self.checker)

    def too_low(self, solution: CaseSolution) -> float:
        return sizes(self.checker.residuals(solution.instants[0], HEIGHT))["robot.mass_height"]


@pytest.fixture(scope="module")
def bench(problem: DesignProblem) -> Bench:
    scene, space = problem.scene, problem.space
    design = space.unscaled(scene.robot.tree)
    checker = Checker(
        scene,
        AgentModel.of(scene.robot, space.resized(scene.robot.tree, design)),
        AgentModel.of(scene.human, scene.human.tree),
    )
    return Bench(Setting(scene, space, problem.weights, problem.options), design, checker)


@pytest.fixture(scope="module")
def before(bench: Bench) -> CaseSolution:
    """The posture without the term."""
    return bench.solve(PostureProblem(bench.setting, Symmetry.ON))


@pytest.fixture
def lowest(bench: Bench, before: CaseSolution, monkeypatch: pytest.MonkeyPatch) -> float:
    """The term is in the registry, and asks for a little more than the posture without it has."""
    monkeypatch.setitem(TERMS, "mass_height", mass_height(10.0))
    asked = 10.0 - bench.too_low(before) + HIGHER
    monkeypatch.setitem(TERMS, "mass_height", mass_height(asked))
    return asked


@pytest.mark.usefixtures("lowest")
def test_it_enters_every_formulation(problem: DesignProblem, bench: Bench) -> None:
    joint = PostureProblem(bench.setting, Symmetry.ON).landscape(HOLD).seeker.program
    whole = PostureProblem(bench.setting, Symmetry.OFF).landscape(HOLD).seeker.program
    codesign = JointProblem(problem.scene, problem.space, (HOLD,), problem.joint).program
    for program in (joint, whole, codesign):
        assert {c.name for c in program.constraints} >= ROWS
    person = person_program(symmetric_forms(bench.setting.scene)[1], bench.setting.scene, 1.0)
    assert "human.mass_height" in {c.name for c in person.constraints}
    reach = ReachProblem(bench.setting, symmetric=True)
    assert "robot.mass_height" in {c.name for c in reach.program.constraints}


def test_it_holds_in_what_is_solved_and_in_the_derivative(
    bench: Bench, before: CaseSolution, lowest: float
) -> None:
    problem = PostureProblem(bench.setting, Symmetry.ON)
    solution = bench.solve(problem)
    assert solution.solved, solution.reason
    assert bench.too_low(before) == pytest.approx(HIGHER)
    assert bench.too_low(solution) < 1e-6
    assert solution.residuals["robot.mass_height"] == bench.too_low(solution)
    derivative = problem.derivative(bench.design, solution)
    assert isinstance(derivative, PostureDerivative), derivative
    assert {(limit.name, limit.active) for limit in derivative.limits} >= {("robot.mass_height", True)}


def test_it_is_in_the_sentence_of_a_posture_that_fails_the_check(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A program that was built without it, and a check that knows it."""
    problem = PostureProblem(bench.setting, Symmetry.ON)
    problem.landscape(HOLD)
    monkeypatch.setitem(TERMS, "mass_height", mass_height(1.2))
    solution = bench.solve(problem)
    assert solution.status is Status.NUMERICAL_FAILURE or solution.status is Status.INFEASIBLE
    assert "the check found robot.mass_height" in solution.reason


def test_it_narrows_the_reach(bench: Bench, lowest: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Who may not squat so low cannot hold the lowest load."""
    narrowed = ReachProblem(bench.setting, symmetric=True).solve(bench.design)
    monkeypatch.delitem(TERMS, "mass_height")
    free = ReachProblem(bench.setting, symmetric=True).solve(bench.design)
    assert free.lowest is not None
    assert narrowed.lowest is not None
    assert narrowed.lowest > free.lowest + HIGHER
