"""The robot of one posture beside the person of another: which pair promises most, and what becomes of it."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from evodesign.mechanics.agent import HUMAN, ROBOT
from evodesign.nlp.program import Program, Start
from evodesign.nlp.solver import RawSolution
from evodesign.posture.allocation import EffortWeights
from evodesign.posture.check import AgentModel, Checker
from evodesign.posture.formulations.base import Setting
from evodesign.posture.postures import PostureProblem, Symmetry
from evodesign.posture.precompute.precomputed import Precomputed
from evodesign.posture.results import AgentPosture, CaseSolution, Instant
from evodesign.posture.seeking.budget import BUDGET
from evodesign.posture.seeking.exchange import Exchange, other_ways
from evodesign.posture.seeking.start_portfolio import Coverage, StartPortfolio
from evodesign.posture.symmetry import symmetric_forms
from evodesign.posture.warm_start import instants_of, layout_of
from evodesign.problem.build import DesignProblem
from evodesign.records import Case, Hold, Status

WEIGHTS = EffortWeights(0.4, 1.6)


@pytest.fixture(scope="module")
def program(problem: DesignProblem) -> Program:
    setting = Setting(problem.scene, problem.space, problem.weights, problem.options)
    return PostureProblem(setting, Symmetry.ON).landscape(Hold(height_m=1.0)).seeker.program


def drawn(program: Program, rng: np.random.Generator) -> dict[str, np.ndarray]:
    """Any values, those of torques between 0 and 10 times a size that differs much from one to another."""
    return {
        v.name: rng.uniform(0.0, 10.0, len(v.start)) * rng.uniform(0.1, 3.0)
        if "torques" in v.name
        else v.start
        for v in program.variables
    }


def test_the_pair_of_least_effort_is_found(problem: DesignProblem, program: Program) -> None:
    """Against the torques of whole postures, pair by pair."""
    forms, rng, told = symmetric_forms(problem.scene), np.random.default_rng(5), []
    exchange = Exchange(program, forms)
    for _ in range(40):
        postures = [drawn(program, rng) for _ in range(4)]
        whole = [
            instants_of(layout_of(program), forms, problem.scene, values)[0].postures for values in postures
        ]
        efforts = {
            (one, two): WEIGHTS.robot * whole[one][ROBOT].torque_norm ** 2
            + WEIGHTS.human * whole[two][HUMAN].torque_norm ** 2
            for one, two in product(range(4), repeat=2)
        }
        best = min(efforts, key=lambda pair: efforts[pair])
        own = min(efforts[place, place] for place in range(4))
        found = exchange.best(postures, WEIGHTS)
        assert found == (best if efforts[best] < BUDGET.exchange * own else None)
        told.append(found)
    assert None in told
    assert len(set(told)) > 5


def test_nothing_is_exchanged_of_one_posture_or_none(problem: DesignProblem, program: Program) -> None:
    exchange = Exchange(program, symmetric_forms(problem.scene))
    assert exchange.best([], WEIGHTS) is None
    assert exchange.best([drawn(program, np.random.default_rng(0))], WEIGHTS) is None


@pytest.mark.slow
def test_a_better_pair_than_any_start_leads_to_is_found(problem: DesignProblem) -> None:
    """Of two starts each has one agent of the best posture known, beside the other agent of a bad one."""
    scene, space, task = problem.scene, problem.space, Hold(height_m=1.0)
    setting = Setting(scene, space, problem.weights, problem.options)
    design = space.unscaled(scene.robot.tree)
    landscape = PostureProblem(setting, Symmetry.ON).landscape(task)
    rng = np.random.default_rng(1)
    ends = [landscape.solve(design, landscape.free_start(rng)) for _ in range(30)]
    solved = sorted((end for end in ends if end.status is Status.SOLVED), key=lambda end: end.cost)
    good = solved[0]
    bad = next(
        end for end in solved if all(effort(end, who) > 4.0 * effort(good, who) for who in (ROBOT, HUMAN))
    )
    starts = [of_both(one, other) for one, other in ((good, bad), (bad, good))]
    known = {Case(person="", payload="", task=task): StartPortfolio(tuple(starts), Coverage(0, 0, 0.0))}
    robot = AgentModel.of(scene.robot, space.resized(scene.robot.tree, design))
    checker = Checker(scene, robot, AgentModel.of(scene.human, scene.human.tree))
    found = PostureProblem(setting, Symmetry.ON, Precomputed(postures=known)).solve(design, task, checker)
    assert [attempt.start for attempt in found.attempts] == [
        "start 1",
        "start 2",
        "start 1, person of start 2",
    ]
    assert found.attempt is found.attempts[-1]
    assert found.attempt.cost == pytest.approx(good.cost, rel=1e-6)
    assert min(attempt.cost for attempt in found.attempts[:2]) > 2.0 * good.cost


def effort(end: RawSolution, who: str) -> float:
    return float(np.sum(np.square(end.values[f"{who}.torques"])))


def of_both(one: RawSolution, other: RawSolution) -> Start:
    """The robot of one beside the person of another."""
    return {**one.values, **{name: value for name, value in other.values.items() if name.startswith(HUMAN)}}


def standing(robot: float, person: float) -> CaseSolution:
    """A posture of two agents with one joint each."""
    agents = {ROBOT: robot, HUMAN: person}
    postures = {
        name: AgentPosture(np.zeros(3), np.zeros(3), {"knee": angle}, {}, {})
        for name, angle in agents.items()
    }
    case = Case(task=Hold(height_m=1.0))
    return CaseSolution(case, Status.SOLVED, "", (Instant(0.0, postures),))


def test_each_other_way_of_the_robot_is_given_once() -> None:
    own, little, far = standing(0.0, 1.0), 0.9 * BUDGET.other_way, 1.1 * BUDGET.other_way
    others = [standing(q, 5.0) for q in (0.0, little, far, far + little, 2.1 * far, -far)]
    assert other_ways(own, others, [ROBOT]) == [others[2], others[4], others[5]]


def test_people_alone_have_no_other_way() -> None:
    assert other_ways(standing(0.0, 1.0), [standing(3.0, 5.0)], []) == []
