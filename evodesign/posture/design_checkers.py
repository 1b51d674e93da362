"""The check of any design of a problem: of its build, and of its postures."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import lru_cache

from evodesign.collision.zero_posture import built_in_slack
from evodesign.design.space import DesignSpace
from evodesign.mechanics.scene import Scene
from evodesign.posture.check import AgentModel, Checker
from evodesign.tree.model import Tree

AT_HAND = 64
"""Designs whose check is kept: more than starts are learned from."""


def can_be_built(scene: Scene, space: DesignSpace) -> Callable[[Sequence[float]], bool]:
    """Whether the build of a design leaves bodies apart: a function of what programs are given of it."""
    family = space.family(scene.designed_tree)

    def apart(design: Sequence[float]) -> bool:
        tree = family.without_actuators(design)
        found = (built_in_slack(tree, robot.collisions) for robot in scene.designed[:1])
        return all(slack is None or slack[0] >= 0.0 for slack in found)

    return apart


def with_hardware(models: Iterable[AgentModel], tree: Tree) -> tuple[AgentModel, ...]:
    """Those of agents, with a design's tree for the robots that designs change."""
    return tuple(model.resized(tree) if model.agent.designed else model for model in models)


class DesignCheckers:
    """The check of any design; those of the latest ones are at hand.

    Args:
        scene: agents and load.
        space: of the designs.
    """

    def __init__(self, scene: Scene, space: DesignSpace) -> None:
        self._scene, self._family = scene, space.family(scene.designed_tree)
        self._models = [AgentModel.of(agent, agent.tree) for agent in scene.agents]
        self._of = lru_cache(AT_HAND)(self._made)

    def of(self, design: Sequence[float]) -> Checker:
        """That of a design."""
        return self._of(tuple(design))

    def _made(self, design: tuple[float, ...]) -> Checker:
        return Checker(self._scene, *with_hardware(self._models, self._family.resized(design)))
