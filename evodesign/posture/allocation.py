"""How robot and person divide the work: the weights of their efforts, and the robot's share of the load.

Both are fixed by the problem or chosen by the design, as allocations among its parameters. With the
allocation effort_ratio e = log10(w_r / w_h) and w_r + w_h = 2,

    w_r = 2 / (1 + 10^-e)        w_h = 2 / (1 + 10^e)
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from evodesign.body.placement import Scalar
from evodesign.design.parameter import EFFORT_RATIO, ROBOT_SHARE
from evodesign.design.space import DesignSpace
from evodesign.mechanics.agent import Agent, Role
from evodesign.mechanics.scene import Scene


@dataclass(frozen=True, slots=True)
class EffortWeights:
    """Weights w_r and w_h of the agents' squared torques; numbers or expressions."""

    robot: float = 1.0
    human: float = 1.0

    @classmethod
    def of_ratio(cls, exponent: Scalar) -> EffortWeights:
        """The weights of a ratio w_r / w_h = 10^exponent, which add up to 2."""
        return cls(2.0 / (1.0 + 10.0**-exponent), 2.0 / (1.0 + 10.0**exponent))

    def by_agent(self, agents: Iterable[Agent]) -> dict[str, Scalar]:
        """The weight of each agent's effort, by name."""
        return {each.name: self.robot if each.role is Role.ROBOT else self.human for each in agents}


def shared_scene(scene: Scene, space: DesignSpace, values: Sequence[Scalar]) -> Scene:
    """The scene with the share of the load that a design chooses, if it does.

    Args:
        scene: of the problem.
        space: design parameters.
        values: one number or expression per parameter.
    """
    share = space.allocations(values).get(ROBOT_SHARE)
    return scene if share is None else replace(scene, robot_share=share)


def shared_weights(weights: EffortWeights, space: DesignSpace, values: Sequence[Scalar]) -> EffortWeights:
    """The weights of the efforts that a design chooses, or else the problem's.

    Args:
        weights: of the problem.
        space: design parameters.
        values: one number or expression per parameter.
    """
    exponent = space.allocations(values).get(EFFORT_RATIO)
    return weights if exponent is None else EffortWeights.of_ratio(exponent)
