"""Everything that was computed of one design."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from evodesign.design.space import DesignSpace
from evodesign.mechanics.scene import Agent, Scene
from evodesign.posture.formulations.codesign import JointSettings
from evodesign.posture.formulations.reach import Reach
from evodesign.posture.results import HeightSolution
from evodesign.tree.model import Tree

__all__ = ["DesignResult"]


@dataclass(frozen=True, slots=True)
class DesignResult:
    """Everything that was computed of one design.

    Args:
        scenes: every person with every load.
        space: design parameters.
        values: one number per design parameter.
        tree: the robot of the design.
        reach: interval of load heights that it can hold, whatever the load.
        people_highest: highest load that all of the people can hold [m]; None where that was not asked for.
        heights: one solution per scene and required height.
        paper: the paper's tasks and their weights.
    """

    scenes: tuple[Scene, ...]
    space: DesignSpace
    values: Sequence[float]
    tree: Tree
    reach: Reach
    heights: tuple[HeightSolution, ...]
    paper: JointSettings
    people_highest: float | None = None

    @property
    def robot(self) -> Agent:
        """The robot as the file describes it."""
        return self.scenes[0].robot
