"""What the card of a lift shows beside the log: the torques that its moments would take at rest."""

from __future__ import annotations

from collections.abc import Sequence

from evodesign.mechanics.floating_base import ROOT
from evodesign.mechanics.scene import Scene
from evodesign.posture.check import AgentModel
from evodesign.posture.terms.torque import asked
from evodesign.problem.logged_posture import logged_posture
from evodesign.records import CaseDetail, InstantDetail, Lift
from evodesign.tree.model import Tree

__all__ = ["RestingTorques"]

Torques = dict[str, dict[str, float]]
"""By agent and joint [N m]."""


class RestingTorques:
    """Joint torques of the postures of lifts, with the wrenches that act there, if nothing moved.

    What a torque has beyond that accelerates the agent's own links and rotors. The load's inertia is in the
    wrenches of the hands.

    Args:
        scenes: every person with every load, all with the same robot.
    """

    def __init__(self, scenes: Sequence[Scene]) -> None:
        robot = scenes[0].robot
        self._robot = AgentModel.of(robot, robot.tree)
        self._people = {scene.pair: AgentModel.of(scene.human, scene.human.tree) for scene in scenes}

    def of(self, robot: Tree, cases: Sequence[CaseDetail]) -> tuple[tuple[Torques, ...], ...]:
        """Torques at each moment of each case; of none where the load is held still.

        Args:
            robot: the design's tree.
            cases: its postures, of the problem's people and loads.
        """
        if not any(isinstance(case.case.task, Lift) for case in cases):
            return ()
        own = self._robot.resized(robot)
        return tuple(
            tuple(_resting((own, self._people[case.case.pair]), instant) for instant in case.instants)
            if isinstance(case.case.task, Lift)
            else ()
            for case in cases
        )

    def limits(self, robot: Tree) -> dict[str, float]:
        """Largest torques of a design's joints that have a limit [N m]."""
        agent = self._robot.resized(robot).agent
        return dict(agent.torque_limits) if agent.limits_torques else {}


def _resting(models: Sequence[AgentModel], instant: InstantDetail) -> Torques:
    found: Torques = {}
    for model in models:
        posture = logged_posture(instant.agents[model.agent.name])
        rows = asked(model.agent, posture, model.at(posture), (0.0, 0.0, 0.0))
        found[model.agent.name] = dict(zip(model.agent.joints, rows[ROOT:].tolist(), strict=True))
    return found
