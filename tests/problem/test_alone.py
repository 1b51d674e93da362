"""A robot that holds the load alone: a problem file without [human]."""

from __future__ import annotations

import json
import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from evodesign.control.gains import Feedback
from evodesign.errors import InputError
from evodesign.evaluation.clearance import solved_distances
from evodesign.evaluation.evaluate import Evaluator
from evodesign.evaluation.evaluation_json import evaluation_json
from evodesign.evaluation.simulations import simulated_holds
from evodesign.mechanics.agent import Role
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.shipped import SHIPPED
from evodesign.problem.source import source_of
from evodesign.quantities.design_result import DesignResult
from evodesign.report.figures.design import write_design_figures
from evodesign.report.page.bodies import bodies
from evodesign.report.replay.layout import layout_text
from evodesign.report.scene_models import SceneSet

G = 9.81


def tables(**changes: Any) -> dict[str, Any]:
    found = tomllib.loads((SHIPPED / "robot_alone.toml").read_text(encoding="utf-8"))
    found.pop("collisions", None)
    found["payload"].pop("robot_grasps_m")
    found["solver"] = {"start_portfolio": False, "compile": False, "method": "ipopt"}
    return {**found, **changes}


def built(**changes: Any) -> DesignProblem:
    return build_problem(source_of(tables(**changes)))


@pytest.fixture(scope="module")
def alone() -> DesignProblem:
    problem = built()
    return replace(problem, options=replace(problem.options, compiled=False))


@pytest.fixture(scope="module")
def result(alone: DesignProblem) -> DesignResult:
    return Evaluator(alone).solve(alone.space.unscaled(alone.scene.robot.tree))


def test_nobody_is_beside_the_robot(alone: DesignProblem) -> None:
    assert [agent.role for scene in alone.scenes for agent in scene.agents] == [Role.ROBOT]
    assert alone.scene.pair == ("", "")
    assert not alone.person_reaches
    width = alone.scene.payload.size[1]
    hands = {
        hand.side: alone.scene.payload.grasp_point(alone.scene.robot, hand)
        for hand in alone.scene.robot.hands
    }
    assert hands == {"left": (0.0, width / 2.0, 0.0), "right": (0.0, -width / 2.0, 0.0)}


def test_grasps_of_the_file_go_before_the_middles_of_the_sides() -> None:
    grasps = {"left": [0.02, 0.1, 0.0], "right": [0.02, -0.1, 0.0]}
    payload = {**tables()["payload"], "robot_grasps_m": grasps}
    scene = built(payload=payload).scene
    assert [scene.payload.grasp_point(scene.robot, hand) for hand in scene.robot.hands] == [
        (0.02, 0.1, 0.0),
        (0.02, -0.1, 0.0),
    ]


def test_the_robot_carries_all_of_the_load_and_its_feet_carry_both(
    alone: DesignProblem, result: DesignResult
) -> None:
    assert all(solution.solved for solution in result.cases), [each.reason for each in result.cases]
    weight = alone.scene.payload.mass * G
    for solution in result.cases:
        (posture,) = solution.postures.values()
        up = sum(float(posture.wrenches[hand.name][2]) for hand in alone.scene.robot.hands)
        assert -up == pytest.approx(weight, abs=1e-4)
        feet = sum(float(posture.wrenches[foot.name][2]) for foot in alone.scene.robot.feet)
        assert feet == pytest.approx(weight + G * float(result.tree.mass), abs=1e-3)


def test_what_is_told_of_it_names_no_person(alone: DesignProblem, result: DesignResult) -> None:
    evaluator = Evaluator(alone)
    assessment = evaluator.assessment(result.values, result)
    assert {*assessment.objectives} == {"robot_torque", "mass", "reach_height"}
    assert all(case.human_torque_norm is None for case in assessment.cases)
    assert bodies(alone).others == {"": {}}
    assert all("human" not in gap.second for gap in solved_distances(result).values())
    shown = json.dumps(
        evaluation_json(alone, result.values, result, assessment, {}, evaluator.details(result)), default=str
    )
    assert "ergonomics" not in shown
    norms = [posture.torque_norm for solution in result.cases for posture in solution.postures.values()]
    assert assessment.objectives["robot_torque"] == pytest.approx(np.mean(norms))


@pytest.mark.parametrize(
    ("change", "key"),
    [
        ({"task": {"heights_m": [0.8], "robot_share": 0.5}}, "task.robot_share"),
        (
            {"task": {"heights_m": [0.8], "effort_weights": {"robot": 1.0, "human": 2.0}}},
            "task.effort_weights",
        ),
        ({"task": {"lift": [{"from_m": 0.7, "to_m": 0.9, "seconds": 2.0}]}}, "task.lift"),
        ({"search": {"algorithm": "joint-starts"}}, "search.algorithm"),
    ],
)
def test_what_needs_people_is_refused_with_its_key(change: dict[str, Any], key: str) -> None:
    with pytest.raises(
        InputError, match=r"wanted a \[human\] with it, found a robot that holds the load alone"
    ) as error:
        built(**change)
    assert error.value.key == key


@pytest.mark.parametrize(
    "name", ["human_torque", "worst_human_effort", "back_compression", "shared_reach_height"]
)
def test_quantities_of_people_are_refused(name: str) -> None:
    objectives = {"minimise": ["robot_torque", name]}
    with pytest.raises(InputError, match=rf"wanted a \[human\] for '{name}', found a robot alone"):
        built(objectives=objectives)


@pytest.mark.slow
def test_its_posture_is_drawn_exported_and_simulated(
    alone: DesignProblem, result: DesignResult, tmp_path: Path
) -> None:
    """The simulator's robot stands with the planned torques and holds the load where it is."""
    details = Evaluator(alone).details(result)
    cast = SceneSet.of(alone.scenes, result.tree)
    assert cast.people == ()
    stage = cast.placed_scene(details[0])
    assert {wrench.agent for wrench in stage.wrenches} == {"robot"}
    layout = json.loads(layout_text(cast, details))
    assert layout["layout"]["second"] == "Plot!robot"
    assert all(path.stat().st_size > 1000 for path in write_design_figures("alone", cast, details, tmp_path))
    (held,) = simulated_holds(alone.scenes, result.tree, details[:1], 1.0, Feedback())
    assert not held.outcome.agents["robot"].fell
    assert held.outcome.drift < 1e-3


def test_a_push_on_nobody_is_refused() -> None:
    with pytest.raises(InputError, match="wanted one of load, robot, found 'human'") as error:
        built(disturbance=[{"push_n": [5.0, 0.0, 0.0], "at": "human"}])
    assert error.value.key == "disturbance[0].at"
