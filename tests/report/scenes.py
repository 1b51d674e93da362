"""Random postures of the point-grasp problem's robot and person, without solving anything."""

from __future__ import annotations

import json
from typing import Any

import msgspec
import numpy as np

from evodesign.mechanics.agent import Agent
from evodesign.mechanics.scene import Scene
from evodesign.problem.build import DesignProblem
from evodesign.records import AgentDetail, CaseDetail, CaseOutcome, Detail, Hold, InstantDetail
from evodesign.report.scene_models import PlacedScene, SceneModels, SceneSet, placed_scene


def random_values(problem: DesignProblem, seed: int) -> tuple[float, ...]:
    rng = np.random.default_rng(seed)
    return problem.space.values(tuple(rng.uniform(size=len(problem.space.parameters)).tolist()))


def random_company(problem: DesignProblem, seed: int) -> SceneSet:
    return SceneSet.of(
        problem.scenes, problem.space.resized(problem.scene.robot.tree, random_values(problem, seed))
    )


def random_cast(problem: DesignProblem, seed: int) -> SceneModels:
    return random_company(problem, seed).models[0]


def random_detail(problem: DesignProblem, seed: int, heights: tuple[float, ...] = (0.8, 1.0, 1.2)) -> Detail:
    rng = np.random.default_rng(seed)
    shown = tuple(
        CaseDetail(case=scene.case(Hold(height_m=height)), instants=(random_instant(scene, rng),))
        for scene in problem.scenes
        for height in heights
    )
    return Detail(evaluation=0, cases=shown)


def random_instant(scene: Scene, rng: np.random.Generator) -> InstantDetail:
    agents = {agent.name: random_posture(agent, rng) for agent in scene.agents}
    return InstantDetail(time_s=0.0, agents=agents)


def random_posture(agent: Agent, rng: np.random.Generator) -> AgentDetail:
    def numbers(scale: float, count: int) -> tuple[float, ...]:
        return tuple((scale * rng.normal(size=count)).tolist())

    return AgentDetail(
        base_position_m=numbers(1.0, 3),
        base_rpy_rad=numbers(0.5, 3),
        joints_rad=dict(zip(agent.joints, numbers(0.8, len(agent.joints)), strict=True)),
        torques_n_m=dict(zip(agent.joints, numbers(10.0, len(agent.joints)), strict=True)),
        wrenches={
            **{foot.name: (*numbers(10.0, 2), 300.0, *numbers(10.0, 3)) for foot in agent.feet},
            **{hand.name: numbers(10.0, 6) for hand in agent.hands},
        },
    )


def hold_json(record: CaseDetail | CaseOutcome) -> dict[str, Any]:
    """A record of a load held still, without names and disturbances, as other programs are told."""
    told = json.loads(msgspec.json.encode(record))
    (instant,) = told.pop("instants", [{"time_s": 0.0}])
    assert told.pop("case") == {"task": {"kind": "hold", "height_m": record.case.task.height_m}}
    assert instant.pop("time_s") == 0.0
    return {"height_m": record.case.task.height_m} | told | instant


def random_stages(problem: DesignProblem, seed: int) -> list[PlacedScene]:
    models = random_cast(problem, seed)
    return [placed_scene(models, detail) for detail in random_detail(problem, seed).cases]
