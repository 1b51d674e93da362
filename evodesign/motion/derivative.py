"""How a lift moves with the design, to first order: its motion is linear in the program's symbols."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from evodesign.nlp.sensitivity import Limit, no_limits
from evodesign.posture.results import Instant

__all__ = ["LiftDerivative"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class LiftDerivative:
    """A motion, and how it moves with the design.

    Args:
        instants_of: the instants of results from the program's symbols.
        symbols: of the solution.
        slopes: their derivatives with respect to the design's parameters, shape (symbols, parameters).
        cost: the least cost.
        cost_slope: its derivative, one per parameter.
    """

    instants_of: Callable[[Array], tuple[Instant, ...]]
    symbols: Array
    slopes: Array
    cost: float
    cost_slope: Array

    @property
    def compared(self) -> float:
        """The cost by which starts are compared."""
        return self.cost

    @property
    def limits(self) -> Sequence[Limit]:
        """None: which limits a motion reaches is not reported."""
        return no_limits(len(self.cost_slope))

    def moved(self, step: Array) -> tuple[Instant, ...]:
        """To first order, the motion of a design that differs by a step, one number per parameter."""
        return self.instants_of(self.symbols + self.slopes @ step)

    @cached_property
    def _around(self) -> tuple[tuple[Instant, ...], ...]:
        """Without a step, then after a unit step along each parameter: torques are linear in the step."""
        steps = np.vstack([np.zeros(len(self.cost_slope)), np.eye(len(self.cost_slope))])
        return tuple(self.moved(step) for step in steps)

    def along_torques(
        self, instant: int, load_case: int, weights: Mapping[str, Mapping[str, float]]
    ) -> Array:
        """The gradient of a weighted sum of torques, one per parameter.

        Args:
            instant: its number.
            load_case: zero for the undisturbed one, else one more than the disturbance's number.
            weights: by agent and joint.
        """
        every = [instants[instant] for instants in self._around]
        sums = [
            sum(
                weight * load_cases[load_case][agent].torques[joint]
                for agent, joints in weights.items()
                for joint, weight in joints.items()
            )
            for load_cases in ([each.postures, *each.disturbed.values()] for each in every)
        ]
        return np.array(sums[1:]) - sums[0]
