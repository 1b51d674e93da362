"""Crossover and mutation (pymoo) of genomes that are discrete in some coordinates.

    crossover   a child has either parent's choice: two children exchange theirs with a chance of one half
    mutation    another choice, each other one with the same chance; as often as a continuous one is changed

Source: Deb and Goyal, A combined genetic adaptive search (GeneAS) for engineering design, 1996.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pymoo.operators.crossover.sbx import SBX
from pymoo.operators.mutation.pm import PM

__all__ = ["MixedCrossover", "MixedMutation"]

EXCHANGE = 0.5
"""Chance that two children exchange a choice."""

Array = NDArray[np.float64]


class MixedCrossover(SBX):  # type: ignore[misc]
    """Simulated binary crossover of continuous coordinates, exchange of discrete ones.

    Args:
        counts: of choices by coordinate.
        prob: chance that two parents are crossed at all.
        eta: distribution index.
    """

    def __init__(self, counts: Sequence[int], prob: float, eta: float) -> None:
        super().__init__(prob=prob, eta=eta)
        self._discrete = np.array(counts) > 0

    def _do(
        self, problem: Any, parents: Array, *_: Any, random_state: np.random.Generator, **__: Any
    ) -> Array:
        children: Array = super()._do(problem, parents, random_state=random_state)
        first, second = parents[:, :, self._discrete]
        exchanged = random_state.random(first.shape) < EXCHANGE
        children[0][:, self._discrete] = np.where(exchanged, second, first)
        children[1][:, self._discrete] = np.where(exchanged, first, second)
        return children


class MixedMutation(PM):  # type: ignore[misc]
    """Polynomial mutation of continuous coordinates, another choice for discrete ones.

    Args:
        counts: of choices by coordinate.
        eta: distribution index.
    """

    def __init__(self, counts: Sequence[int], eta: float) -> None:
        super().__init__(eta=eta)
        self._counts = np.array(counts)

    def _do(
        self, problem: Any, points: Array, *_: Any, random_state: np.random.Generator, **__: Any
    ) -> Array:
        mutated: Array = super()._do(problem, points, random_state=random_state)
        discrete = self._counts > 0
        parts, before = self._counts[discrete], points[:, discrete]
        further = random_state.integers(1, np.maximum(parts, 2), size=before.shape)
        changed = (
            random_state.random(before.shape) < self.get_prob_var(problem, size=len(points))[:, np.newaxis]
        )
        after = (np.floor(before * parts) + changed * further) % parts
        mutated[:, discrete] = (after + 0.5) / parts
        return mutated
