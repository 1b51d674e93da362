"""The casts of all scenes of a problem, with the robot of one design."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from evodesign.mechanics.scene import HUMAN, ROBOT, Agent, Payload, Scene
from evodesign.records import HeightDetail
from evodesign.report.scene_models import PlacedScene, SceneModels, placed_scene
from evodesign.tree.model import Tree

__all__ = ["SceneSet"]


@dataclass(frozen=True, slots=True)
class SceneSet:
    """Everyone who holds a load with the robot of a design.

    Args:
        casts: every person with every load, all of them with the same robot; at least one.
    """

    models: tuple[SceneModels, ...]

    @classmethod
    def of(cls, scenes: Sequence[Scene], robot_tree: Tree) -> SceneSet:
        """The casts of scenes with the robot of a design."""
        return cls(tuple(SceneModels.of(scene, robot_tree) for scene in scenes))

    @property
    def robot(self) -> Tree:
        """The design's robot."""
        return self.models[0].trees[ROBOT]

    @property
    def people(self) -> tuple[tuple[Agent, Tree], ...]:
        """Each person once, with the tree of numbers, in the problem's order."""
        found = {
            models.agent(HUMAN).label: (models.agent(HUMAN), models.trees[HUMAN]) for models in self.models
        }
        return tuple(found.values())

    @property
    def payloads(self) -> tuple[Payload, ...]:
        """Each load once, in the problem's order."""
        return tuple({models.payload.label: models.payload for models in self.models}.values())

    def models_of(self, detail: HeightDetail) -> SceneModels:
        """Who stands there in a logged case."""
        labels = (detail.human_name, detail.payload_name)
        return next(
            models for models in self.models if (models.agent(HUMAN).label, models.payload.label) == labels
        )

    def placed_scene(self, detail: HeightDetail) -> PlacedScene:
        """The stage of a logged case."""
        return placed_scene(self.models_of(detail), detail)
