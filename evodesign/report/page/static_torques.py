"""What the card of a lift shows beside the log: what its moments would take at rest, and limits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property

from evodesign.evaluation.logged_posture import logged_posture
from evodesign.mechanics.agent import Agent
from evodesign.mechanics.floating_base import ROOT
from evodesign.mechanics.scene import Scene
from evodesign.posture.check import AgentModel
from evodesign.posture.design_checkers import with_hardware
from evodesign.posture.terms.torque import asked
from evodesign.records import CaseDetail, InstantDetail, Lift
from evodesign.tree.model import Tree

Torques = dict[str, dict[str, float]]
"""By agent and joint [N m]."""


class StaticTorques:
    """Joint torques of the postures of lifts, with the wrenches that act there, if nothing moved.

    What a torque has beyond that accelerates the agent's own links and rotors. The load's inertia is in the
    wrenches of the hands.

    Args:
        scenes: every team with every load, all with the same robots.
    """

    def __init__(self, scenes: Sequence[Scene]) -> None:
        self._scenes = scenes

    @cached_property
    def _models(self) -> dict[tuple[str, str], list[AgentModel]]:
        known = {id(agent): _model(agent) for scene in self._scenes for agent in scene.agents}
        return {scene.pair: [known[id(agent)] for agent in scene.agents] for scene in self._scenes}

    def of(
        self, robot: Tree, cases: Sequence[CaseDetail]
    ) -> tuple[tuple[tuple[Torques, ...], ...], dict[str, float]]:
        """Torques at each moment of each case, and the robot's limits [N m].

        Of no moment where the load is held still; nothing at all where no load is lifted.

        Args:
            robot: the design's tree.
            cases: its postures, of the problem's people and loads.
        """
        lifted = [isinstance(case.case.task, Lift) for case in cases]
        if not any(lifted):
            return (), {}
        models = {pair: with_hardware(own, robot) for pair, own in self._models.items()}
        torques = tuple(
            tuple(_static(models[case.case.pair], each) for each in case.instants if moves)
            for case, moves in zip(cases, lifted, strict=True)
        )
        own = self._scenes[0].robot
        return torques, dict(own.torque_limits) if own.limits_torques else {}


def _model(agent: Agent) -> AgentModel:
    """An agent that is not asked for its distances."""
    return AgentModel.of(replace(agent, collisions=None), agent.tree)


def _static(models: Sequence[AgentModel], instant: InstantDetail) -> Torques:
    found: Torques = {}
    for model in models:
        posture = logged_posture(instant.agents[model.agent.name])
        rows = asked(model.agent, posture, model.at(posture), (0.0, 0.0, 0.0))
        found[model.agent.name] = dict(zip(model.agent.joints, rows[ROOT:].tolist(), strict=True))
    return found
