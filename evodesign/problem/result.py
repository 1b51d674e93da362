"""Everything that was computed of one design."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import msgspec

from evodesign.design.space import DesignSpace
from evodesign.mechanics.scene import Agent, Scene, scene_of
from evodesign.posture.formulations.codesign import JointSettings
from evodesign.posture.formulations.reach import Reach
from evodesign.posture.results import AgentPosture, CaseSolution
from evodesign.records import Case
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
        cases: one solution per undisturbed case of the problem, in its order.
        paper: the paper's tasks and their weights.
    """

    scenes: tuple[Scene, ...]
    space: DesignSpace
    values: Sequence[float]
    tree: Tree
    reach: Reach
    cases: tuple[CaseSolution, ...]
    paper: JointSettings
    people_highest: float | None = None

    @property
    def robot(self) -> Agent:
        """The robot as the file describes it."""
        return self.scenes[0].robot

    def scene_of(self, case: Case) -> Scene:
        """The scene of a case."""
        return scene_of(self.scenes, case.pair)

    def every_case(self) -> Iterator[tuple[Case, Mapping[str, AgentPosture]]]:
        """Every solved case with its postures, each undisturbed one followed by its disturbed ones."""
        for solution in self.cases:
            for instant in solution.instants:
                yield solution.case, instant.postures
                for name, postures in instant.disturbed.items():
                    yield msgspec.structs.replace(solution.case, disturbance=name), postures
