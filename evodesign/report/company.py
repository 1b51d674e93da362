"""The casts of all scenes of a problem, with the robot of one design."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from evodesign.records import HeightDetail
from evodesign.report.stage import Cast, Stage, stage_of
from evodesign.statics.scene import HUMAN, ROBOT, Agent, Payload, Scene
from evodesign.tree.model import Tree

__all__ = ["Company"]


@dataclass(frozen=True, slots=True)
class Company:
    """Everyone who holds a load with the robot of a design.

    Args:
        casts: every person with every load, all of them with the same robot; at least one.
    """

    casts: tuple[Cast, ...]

    @classmethod
    def of(cls, scenes: Sequence[Scene], robot_tree: Tree) -> Company:
        """The casts of scenes with the robot of a design."""
        return cls(tuple(Cast.of(scene, robot_tree) for scene in scenes))

    @property
    def robot(self) -> Tree:
        """The design's robot."""
        return self.casts[0].trees[ROBOT]

    @property
    def people(self) -> tuple[tuple[Agent, Tree], ...]:
        """Each person once, with the tree of numbers, in the problem's order."""
        found = {cast.agent(HUMAN).label: (cast.agent(HUMAN), cast.trees[HUMAN]) for cast in self.casts}
        return tuple(found.values())

    @property
    def payloads(self) -> tuple[Payload, ...]:
        """Each load once, in the problem's order."""
        return tuple({cast.payload.label: cast.payload for cast in self.casts}.values())

    def cast_of(self, detail: HeightDetail) -> Cast:
        """Who stands there in a logged case."""
        labels = (detail.human_name, detail.payload_name)
        return next(cast for cast in self.casts if (cast.agent(HUMAN).label, cast.payload.label) == labels)

    def stage_of(self, detail: HeightDetail) -> Stage:
        """The stage of a logged case."""
        return stage_of(self.cast_of(detail), detail)
