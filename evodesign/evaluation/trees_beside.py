"""The robots of designs that differ from one in a single parameter, for differences of what has no slope."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from evodesign.design.space import Family
from evodesign.tree.model import Tree

STEP = 1e-4
"""Step of differences, as a share of a value: they are good to about one part in 10^8."""


@dataclass(frozen=True, slots=True)
class TreesBeside:
    """Trees at steps along one parameter of a design; each is resized once.

    Args:
        family: of the design.
        values: of the design, as programs are given them.
    """

    family: Family
    values: Sequence[float]
    _known: dict[int, tuple[float, Tree, Tree]] = field(default_factory=dict)

    def along(self, place: int) -> tuple[float, Tree, Tree]:
        """The step, and the trees one step below and above."""
        if place not in self._known:
            given = np.array(self.values)
            step = STEP * (abs(given[place]) or 1.0)
            unit = np.eye(len(given))[place] * step
            below, above = (self.family.resized((given + sign * unit).tolist()) for sign in (-1.0, 1.0))
            self._known[place] = step, below, above
        return self._known[place]
