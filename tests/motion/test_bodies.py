"""Lifts in which bodies keep clear of each other: rows against differences, motions against coal."""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import msgspec
import numpy as np
import pytest
from numpy.typing import NDArray

from evodesign.collision.scene_bodies import SceneBodies
from evodesign.motion import lifting
from evodesign.motion.instant import KnotBlocks
from evodesign.motion.lift_bodies import LiftSolve, PartedLift
from evodesign.motion.lift_program import LiftProgram
from evodesign.motion.lifting import LiftProblem
from evodesign.motion.solution import LiftSolution
from evodesign.nlp.blocks import Block
from evodesign.posture.check import AgentModel
from evodesign.posture.symmetry import symmetric_forms
from evodesign.posture.terms.collisions import NUMBERS, directed
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.records import Status
from tests.motion.lifted import LIFT, Lifted

pytestmark = pytest.mark.slow

LOW = msgspec.structs.replace(LIFT, from_m=0.7, to_m=1.2)
PAIRS = [
    *(["LeftHand", "LeftUpperLeg"], ["RightHand", "RightUpperLeg"]),
    *(["LeftForeArm", "LeftUpperLeg"], ["RightForeArm", "RightUpperLeg"]),
    *(["LeftFoot", "RightFoot"], ["l_foot_front", "r_foot_front"], ["l_hip_3", "r_hip_3"]),
]
FOLDED = [["l_shoulder_1", "l_upper_arm"], ["r_shoulder_1", "r_upper_arm"]]
"""In each other in the holds that these lifts begin from."""


def keeping_clear(problem: DesignProblem, lifted: Lifted, pairs: list[list[str]]) -> Lifted:
    """Lifts of the same, in which nothing overlaps and some pairs have rows, from holds that may overlap."""
    source = problem.source
    table = f"[collisions]\npart = {pairs}\nignore = {FOLDED}\n\n[objectives]".replace("'", '"')
    text = source.text.replace("[objectives]", table)
    scene = build_problem(msgspec.structs.replace(source, text=text)).scene
    setting = replace(lifted.setting, scene=scene)
    robot, human = (AgentModel.of(agent, agent.tree) for agent in scene.agents)
    lifts = LiftProblem(setting, symmetric=True)
    return replace(lifted, setting=setting, robot=robot, human=human, lifts=lifts)


@pytest.fixture(scope="module")
def clear(problem: DesignProblem, lifted: Lifted) -> Lifted:
    return keeping_clear(problem, lifted, PAIRS)


@pytest.fixture(scope="module")
def holds(lifted: Lifted) -> list:
    return [lifted.hold(height) for height in (LOW.from_m, LOW.to_m)]


@pytest.fixture(scope="module")
def apart(clear: Lifted, holds: list) -> LiftSolution:
    return clear.lifts.solve(clear.design, LOW, holds, clear.robot, clear.human)


def deepest(lifted: Lifted, solution: LiftSolution) -> float:
    """By how much bodies overlap at most at 200 moments [m], by coal."""
    course, models = solution.course, {"robot": lifted.robot, "human": lifted.human}
    assert course is not None
    solids = {name: model.solid for name, model in models.items() if model.solid is not None}
    bodies = SceneBodies(solids, lifted.setting.scene.payload.size)
    found = [0.0]
    for instant in course.instants(np.linspace(0.0, course.lift.seconds, 200)):
        poses = {n: (m.agent.turn, m.at(instant.postures[n]).poses) for n, m in models.items()}
        assert instant.height is not None
        found += [-gap.distance for gap in bodies.near(poses, instant.height)]
    return max(found)


def test_overlaps_that_no_row_parts_are_refused_by_name(
    problem: DesignProblem, lifted: Lifted, holds: list, monkeypatch: pytest.MonkeyPatch
) -> None:
    """At once: more knots, which are tried before, part nothing."""
    monkeypatch.setattr(lifting, "REFINEMENTS", 0)
    without = keeping_clear(problem, lifted, [])
    found = without.lifts.solve(without.design, LOW, holds, without.robot, without.human)
    assert found.status is Status.NUMERICAL_FAILURE
    assert "overlap" in found.reason
    assert "Hand and human" in found.reason
    assert "UpperLeg apart" in found.reason


def test_bodies_of_a_lift_keep_clear_where_they_overlapped(clear: Lifted, apart: LiftSolution) -> None:
    assert apart.solved, apart.reason
    assert apart.start is not None
    assert apart.start.parts_bodies
    assert deepest(clear, apart) < 1e-3
    assert apart.checked is not None
    assert apart.checked.knots["overlap"] == 0.0


def test_a_lift_without_overlaps_is_solved_without_the_rows(clear: Lifted, solution: LiftSolution) -> None:
    """To the same cost as where bodies may overlap, in as many iterations."""
    found = clear.lifts.solve(
        clear.design, LIFT, [clear.hold(h) for h in (LIFT.from_m, LIFT.to_m)], clear.robot, clear.human
    )
    assert found.solved
    free = [each for each in solution.attempts if each.start.startswith("hold")]
    for before, after in zip(free, found.attempts, strict=False):
        assert after.cost == pytest.approx(before.cost, rel=1e-6)


def test_more_knots_take_over_the_directions(clear: Lifted, apart: LiftSolution) -> None:
    assert apart.course is not None
    assert apart.start is not None
    finer = msgspec.structs.replace(apart.lift, knots=2 * apart.lift.knots)
    program = LiftProgram(_blocks(clear), finer.knots, clear.setting.options)
    refined = program.refined(finer, apart.course, apart.start)
    on, before = (each.directions[:, ::NUMBERS] for each in (refined, apart.start))
    assert on.shape[0] == 2 * finer.knots - 1
    assert on[[0, -1]] == pytest.approx(before[[0, -1]])
    assert on.mean(axis=0) == pytest.approx(before.mean(axis=0), abs=0.1)


def _blocks(lifted: Lifted) -> KnotBlocks:
    return KnotBlocks(symmetric_forms(lifted.setting.scene), lifted.setting)


@pytest.mark.parametrize("which", ["knot", "between"])
def test_derivatives_of_rows_are_differences_of_rows(clear: Lifted, which: str) -> None:
    parted = _blocks(clear).parted
    assert parted is not None
    block: Block = getattr(parted, which)
    meetings = sum(len(directed(form)) for form in parted.forms)
    assert parted.directions == NUMBERS * meetings
    values = ca.Function("values", block.arguments, [block.rows])
    first = ca.Function("first", block.arguments, [ca.jacobian(block.rows, block.symbols)])
    rng = np.random.default_rng(3)
    at = rng.uniform(-0.2, 0.2, block.symbols.numel())
    own = rng.standard_normal(block.own.numel())
    shared = np.r_[clear.design, 0.2, 5.0, 1.0]
    exact = np.array(first(at, own, shared))
    last = parted.meetings[which == "between"].rows
    assert len(last) >= meetings
    assert np.abs(exact[last]).sum(axis=1).min() > 0.1

    def ahead(step: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.array(values(at + step, own, shared)).ravel()

    for column in range(len(at)):
        step = 1e-6 * np.eye(len(at))[column]
        difference = (ahead(step) - ahead(-step)) / 2e-6
        assert exact[:, column] == pytest.approx(difference, abs=1e-5, rel=1e-5)


def test_the_cost_of_a_lift_that_rows_hold_moves_as_its_gradient_says(clear: Lifted, holds: list) -> None:
    mass, design = clear.setting.scene.payload.mass, np.array(clear.design)
    program = LiftProgram(_blocks(clear), LOW.knots, replace(clear.setting.options, tolerance=1e-10))
    start = program.followed(LOW, holds[0].postures, 0, clear.design)
    first = LiftSolve(start, *program.solve(LOW, start, clear.design, mass))
    found = PartedLift(program, LOW, clear.design, mass).settled(first)
    assert found.solved
    assert found.ending.cost > first.ending.cost
    near = replace(found.start, symbols=found.ending.symbols)

    def cost(values: NDArray[np.float64]) -> float:
        return program.solve(LOW, near, values, mass)[0].cost

    here = program.solve(LOW, near, design, mass)[0]  # of the optimum that neighbours are solved from
    assert here.cost == pytest.approx(found.ending.cost, rel=1e-3)

    def slope(place: int, share: float) -> float | None:
        """Where both neighbours are of the same optimum: another one is 1e-5 cheaper."""
        step = share * design[place] * np.eye(len(design))[place]
        above, below = cost(design + step), cost(design - step)
        bend = abs(above + below - 2.0 * here.cost)
        return (above - below) / (2.0 * step[place]) if bend < 1e-6 * here.cost else None

    for place in (1, 10):  # a length and a density
        slopes = [slope(place, share) for share in (3e-4, 1e-4, 3e-5)]
        found_slopes = [each for each in slopes if each is not None]
        assert len(found_slopes) >= 2
        assert found_slopes == pytest.approx([here.cost_slope[place]] * len(found_slopes), rel=1e-3)
