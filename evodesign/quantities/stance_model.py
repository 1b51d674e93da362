"""The robot that stands alone: what a problem's standing postures ask of the actuators of any design."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from evodesign.mechanics.agent import Agent
from evodesign.mechanics.floating_base import FloatingBody
from evodesign.mechanics.link_beams import Safety
from evodesign.mechanics.stance_beams import impact, stance_safety
from evodesign.mechanics.stance_case import StanceCase, StanceTorques
from evodesign.mechanics.stance_torques import stance_torques
from evodesign.tree.equip import actuators_of
from evodesign.tree.model import Tree


class StanceModel:
    """The robot in the problem's standing postures, whatever its design; results of one design are kept.

    Args:
        cases: of the problem.
        body: the robot with all joints that move or are driven, of any design.
        latest: the tree of a design, and the body with it.
    """

    def __init__(
        self,
        cases: tuple[StanceCase, ...],
        body: FloatingBody,
        latest: tuple[Tree, FloatingBody] | None = None,
    ) -> None:
        self.cases, self.body = cases, body
        self._latest = latest
        self._known: tuple[Tree, list[tuple[StanceCase, StanceTorques]]] | None = None

    @classmethod
    def of(cls, cases: tuple[StanceCase, ...], agent: Agent, driven: Sequence[str]) -> StanceModel:
        """Of a robot some of whose joints are driven, by name; they count whether they move in the lift."""
        joints = (*agent.joints, *(name for name in driven if name not in agent.joints))
        return cls(cases, FloatingBody.of_tree(agent.tree, joints, np.eye(3)))

    def torques(self, tree: Tree) -> list[tuple[StanceCase, StanceTorques]]:
        """What became of each case with the tree of a design."""
        if self._known is None or self._known[0] is not tree:
            known = self._latest
            body = known[1] if known is not None and known[0] is tree else self.body.resized(tree)
            self._known = tree, [(case, stance_torques(body, case)) for case in self.cases]
        return self._known[1]

    def needed(self, tree: Tree) -> list[Mapping[str, float]] | str:
        """Factor x |tau| [N m] of each case by joint, which peak torques must be; or why one cannot be."""
        found = self.torques(tree)
        for _, each in found:
            if each.reason:
                return each.reason
        return [
            {joint: case.factor * abs(torque) for joint, torque in each.torques.items()}
            for case, each in found
        ]

    def safety(self, tree: Tree) -> Iterator[tuple[str, dict[str, Safety]]]:
        """What each case is called, and the safety of each link that is a beam, by link."""
        for case, found in self.torques(tree):
            falls = case.dropped and not found.reason
            times = f", {impact(tree, case, found)[0]:.3g} times its load" if falls else ""
            yield f"{case.name}{times}", stance_safety(tree, case, found)

    def shares(self, tree: Tree) -> list[float] | None:
        """The largest of these over peak torque, of each case; None where the robot cannot stand."""
        needed, actuators = self.needed(tree), actuators_of(tree)
        if isinstance(needed, str):
            return None
        return [
            float(
                max(
                    (asked[joint] / actuators[joint].peak for joint in actuators if joint in asked), default=0
                )
            )
            for asked in needed
        ]
