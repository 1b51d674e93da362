"""How a lift moves with the design, to first order: its motion is linear in the program's symbols."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from evodesign.nlp.sensitivity import Limit, no_limits
from evodesign.posture.results import AgentPosture, Instant

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class LiftDerivative:
    """A motion made exact, and how it moves with the design.

    Args:
        instants_of: the instants of results from the program's symbols.
        symbols: of the solution.
        slopes: their derivatives with respect to the design's parameters, shape (symbols, parameters).
        cost: the least cost.
        cost_slope: its derivative, one per parameter.
        least_slope: that of the least time [s], likewise; None where nothing asks for it.
    """

    instants_of: Callable[[Array], tuple[Instant, ...]]
    symbols: Array
    slopes: Array
    cost: float
    cost_slope: Array
    least_slope: Array | None = None

    @property
    def compared(self) -> float:
        """The cost by which starts are compared."""
        return self.cost

    @property
    def instants(self) -> tuple[Instant, ...]:
        """Of the motion itself."""
        return self._around[0]

    @property
    def limits(self) -> Sequence[Limit]:
        """None: which limits a motion reaches is not reported."""
        return no_limits(len(self.cost_slope))

    def moved(self, step: Array) -> tuple[Instant, ...]:
        """To first order, the motion of a design that differs by a step, one number per parameter."""
        return self.instants_of(self.symbols + self.slopes @ step)

    @cached_property
    def _around(self) -> tuple[tuple[Instant, ...], ...]:
        """Without a step, then after a unit one along each parameter: torques and speeds are linear in it."""
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
        return self._along(instant, load_case, weights, lambda posture: posture.torques)

    def along_speeds(self, instant: int, weights: Mapping[str, Mapping[str, float]]) -> Array:
        """The same of the speeds of joints."""
        return self._along(instant, 0, weights, lambda posture: posture.speeds)

    def _along(
        self,
        instant: int,
        load_case: int,
        weights: Mapping[str, Mapping[str, float]],
        values: Callable[[AgentPosture], Mapping[str, float]],
    ) -> Array:
        every = [instants[instant] for instants in self._around]
        sums = [
            sum(
                weight * values(load_cases[load_case][agent])[joint]
                for agent, joints in weights.items()
                for joint, weight in joints.items()
            )
            for load_cases in ([each.postures, *each.disturbed.values()] for each in every)
        ]
        return np.array(sums[1:]) - sums[0]
