"""The robots of designs that differ from one in a single parameter, for differences of what has no slope."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from evodesign.design.space import Family
from evodesign.tree.model import Tree

STEP = 1e-4
"""Step of differences, as a share of a value."""


@dataclass(frozen=True, slots=True)
class TreesBeside:
    """Trees at steps along one parameter of a design; each is resized once.

    Args:
        family: of the design.
        values: of the design, as programs are given them.
        tree: of the design.
    """

    family: Family
    values: Sequence[float]
    tree: Tree
    _known: dict[int, tuple[float, tuple[Tree, ...]]] = field(default_factory=dict)

    def along(self, place: int) -> tuple[float, tuple[Tree, ...]]:
        """The step, and the trees at -2, -1, 0, 1 and 2 steps."""
        if place not in self._known:
            given = np.array(self.values)
            step = STEP * (abs(given[place]) or 1.0)
            unit = np.eye(len(given))[place] * step
            resized = [self.family.resized((given + count * unit).tolist()) for count in (-2, -1, 1, 2)]
            self._known[place] = step, (*resized[:2], self.tree, *resized[2:])
        return self._known[place]
