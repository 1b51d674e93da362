"""The check of any design of a problem: of its build, and of its postures."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from evodesign.collision.zero_posture import built_in_slack
from evodesign.design.space import DesignSpace
from evodesign.mechanics.scene import Agent, Scene
from evodesign.posture.check import AgentModel, Checker


def can_be_built(robot: Agent, space: DesignSpace) -> Callable[[Sequence[float]], bool]:
    """Whether the build of a design leaves bodies apart: a function of what programs are given of it."""
    family = space.family(robot.tree)

    def apart(design: Sequence[float]) -> bool:
        slack = built_in_slack(family.without_actuators(design), robot.collisions)
        return slack is None or slack[0] >= 0.0

    return apart


class DesignCheckers:
    """The check of any design; that of the latest one is at hand.

    Args:
        scene: robot, person and load.
        space: of the designs.
    """

    def __init__(self, scene: Scene, space: DesignSpace) -> None:
        self._scene, self._family = scene, space.family(scene.robot.tree)
        self._robot, self._human = (AgentModel.of(agent, agent.tree) for agent in (scene.robot, scene.human))
        self._latest: tuple[tuple[float, ...], Checker] | None = None

    def of(self, design: Sequence[float]) -> Checker:
        """That of a design."""
        if self._latest is None or self._latest[0] != tuple(design):
            robot = self._robot.resized(self._family.resized(design))
            self._latest = tuple(design), Checker(self._scene, robot, self._human)
        return self._latest[1]
