"""Loads of every kind: offset centres of mass, own grasp points, rigid grasps."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from evodesign.errors import InputError
from evodesign.mechanics.agent import HUMAN, ROBOT, SIDES
from evodesign.mechanics.balance import GRAVITY
from evodesign.mechanics.payload import Grasp, Payload
from evodesign.posture.check import AgentModel, Checker
from evodesign.posture.formulations.base import Setting
from evodesign.posture.postures import PostureProblem, Symmetry
from evodesign.posture.results import CaseSolution
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.records import Hold, Status

BOX = (0.5, 0.5, 0.025)


def solve(problem: DesignProblem, payload: Payload, height: float = 1.0) -> CaseSolution:
    scene = replace(problem.scene, payload=payload)
    values = problem.space.unscaled(scene.robot.tree)
    posture = PostureProblem(Setting(scene, problem.space, problem.weights, problem.options), Symmetry.ON)
    tree = problem.space.resized(scene.robot.tree, values)
    checker = Checker(scene, AgentModel.of(scene.robot, tree), AgentModel.of(scene.human, scene.human.tree))
    return posture.solve(values, Hold(height_m=height), checker)


def carried(solution: CaseSolution, agent: str) -> float:
    """Part of the load's weight that an agent carries [N]."""
    return -float(sum(solution.postures[agent].wrenches[f"{side}_hand"][2] for side in SIDES))


@pytest.mark.parametrize("offset", [-0.1, 0.05])
def test_load_leans_on_whom_it_is_nearer_to(offset: float, problem: DesignProblem) -> None:
    """Lever rule of a beam on two supports half a metre apart (level grasps, no push to speak of)."""
    stance = replace(problem.scene.stance, push=0.0)
    flat = replace(problem, scenes=(replace(problem.scene, stance=stance),))
    solution = solve(flat, Payload(BOX, 5.0, center_of_mass=(offset, 0.0, 0.0)))
    assert solution.status is Status.SOLVED, solution.reason
    weight = 5.0 * GRAVITY
    assert carried(solution, HUMAN) == pytest.approx(weight * (0.25 + offset) / 0.5, abs=1e-4)
    assert carried(solution, ROBOT) == pytest.approx(weight * (0.25 - offset) / 0.5, abs=1e-4)


def test_rigid_grasps_share_the_load_freely(problem: DesignProblem) -> None:
    point, rigid = (solve(problem, Payload(BOX, 5.0, grasp=grasp)) for grasp in Grasp)
    assert rigid.status is Status.SOLVED
    assert max(rigid.residuals.values()) < 1e-5
    assert carried(point, ROBOT) == pytest.approx(2.5 * GRAVITY, abs=1e-4)
    assert carried(rigid, ROBOT) + carried(rigid, HUMAN) == pytest.approx(5.0 * GRAVITY, abs=1e-4)
    moments = [
        rigid.postures[agent].wrenches[f"{side}_hand"][3:] for agent in (ROBOT, HUMAN) for side in SIDES
    ]
    assert np.abs(moments).max() > 0.01
    costs = [min(a.cost for a in s.attempts if a.status is Status.SOLVED) for s in (point, rigid)]
    assert costs[1] < costs[0] + 1e-6, "more freedom cannot cost more"


def test_own_grasp_points_are_met(problem: DesignProblem) -> None:
    points = {
        (ROBOT, "left_hand"): (-0.25, 0.15, 0.025),
        (ROBOT, "right_hand"): (-0.25, -0.15, 0.025),
        (HUMAN, "left_hand"): (0.25, -0.22, 0.0),
        (HUMAN, "right_hand"): (0.25, 0.22, 0.0),
    }
    payload = Payload(BOX, 5.0, grasp_points=points)
    scene = problem.scene
    assert payload.grasp_point(scene.robot, scene.robot.hands[0]) == (-0.25, 0.15, 0.025)
    assert payload.grasp_point(scene.human, scene.human.hands[0]) == (-0.25, 0.22, 0.0)
    solution = solve(problem, payload)
    assert solution.status is Status.SOLVED
    assert solution.residuals["robot.hands_on_load"] < 1e-6
    assert solution.residuals["human.hands_on_load"] < 1e-6


def test_inertia_is_that_of_a_uniform_box_of_its_mass() -> None:
    inertia = Payload((0.6, 0.4, 0.2), 12.0, center_of_mass=(0.1, 0.0, 0.0)).inertia
    assert inertia.mass == 12.0
    assert inertia.center == (0.1, 0.0, 0.0)
    diagonal = [inertia.about_center[i][i] for i in range(3)]
    assert diagonal == pytest.approx(
        [12 / 12 * (0.16 + 0.04), 12 / 12 * (0.36 + 0.04), 12 / 12 * (0.36 + 0.16)]
    )


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("center_of_mass_m = [0.3, 0.0, 0.0]", r"center_of_mass_m\[0\]: wanted a point in the box"),
        ('grasp = "glue"', "payload.grasp"),
        (
            "robot_grasps_m = { left = [0.0, 0.1, 0.0] }",
            "robot_grasps_m: wanted a point for each hand: left, right, found left",
        ),
    ],
)
def test_impossible_loads_are_refused(line: str, words: str, problem: DesignProblem) -> None:
    text = problem.source.text.replace('grasp = "point"', line, 1)
    source = type(problem.source)(path="p.toml", text=text, files=problem.source.files)
    with pytest.raises(InputError, match=words):
        build_problem(source)
