"""Holds of the point-grasp problem's unscaled robot and person, with either grasp, to be simulated."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache

import pytest

from evodesign.mechanics.payload import Grasp
from evodesign.mechanics.scene import Scene
from evodesign.posture.check import AgentModel, Checker
from evodesign.posture.formulations.base import Setting
from evodesign.posture.postures import PostureProblem, Symmetry
from evodesign.posture.results import CaseSolution
from evodesign.problem.build import DesignProblem
from evodesign.records import Hold
from evodesign.simulation.model import SimulatedScene, simulated_scene
from evodesign.tree.model import Tree
from tests.motion.conftest import lifted

__all__ = ["lifted"]

HEIGHT = 1.0


@dataclass(frozen=True)
class Held:
    """A load that is held at `HEIGHT`."""

    scene: Scene
    models: dict[str, AgentModel]
    solution: CaseSolution

    @property
    def trees(self) -> dict[str, Tree]:
        return {name: model.tree for name, model in self.models.items()}

    def simulated(self) -> SimulatedScene:
        return simulated_scene(self.scene, self.trees, self.solution.postures, HEIGHT)


@pytest.fixture(scope="session")
def held_with(problem: DesignProblem) -> Callable[[Grasp], Held]:
    """The hold with a grasp, solved by IPOPT once."""

    @cache
    def found(grasp: Grasp) -> Held:
        scene = replace(problem.scene, payload=replace(problem.scene.payload, grasp=grasp))
        agents = scene.agents
        models = {agent.name: AgentModel.of(agent, agent.tree) for agent in agents}
        setting = Setting(scene, problem.space, problem.weights, problem.options)
        design = problem.space.unscaled(scene.robot.tree)
        checker = Checker(scene, *models.values())
        holds = PostureProblem(setting, Symmetry.ON)
        return Held(scene, models, holds.solve(design, Hold(height_m=HEIGHT), checker))

    return found


@pytest.fixture(scope="session")
def held(held_with: Callable[[Grasp], Held]) -> Held:
    return held_with(Grasp.POINT)
