"""How far a search is: what its last doubling gained, and what another one would by experience.

The hypervolume V grows ever more slowly, so that evaluations are counted by doublings: with n evaluations
done,

    last = V(n) / V(n / 2) - 1         expected = USUAL last, between LOW last and HIGH last

How the growth of one doubling and that of the next relate was measured on 84 searches of one problem by
ten algorithms, from 120 to at most 1,920 evaluations each (`python -m benchmarks.growth`): the factors are
the median and the quantiles that eight in ten lie between. It says how much is usually left, and no more: a
search that is stuck cannot know of designs that it never came near. Of a search that grew by more than any of
these nothing is known: it has hardly begun.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import msgspec
import numpy as np

from evodesign.records import Generation

USUAL, LOW, HIGH = 0.79, 0.3, 3.15
"""Growth of a doubling divided by that of the one before: median, and the quantiles 10 % and 90 %."""

MOST = 0.5
"""Largest growth of a doubling that was followed by another one."""


@dataclass(frozen=True, slots=True)
class HypervolumeGrowth:
    """Growth of the hypervolume by doublings.

    Args:
        evaluations: that are done.
        last: share by which the hypervolume grew over the latter half of them.
        expected: share by which it grows with as many again, by experience.
        low: what nine in ten searches exceed.
        high: what one in ten exceeds.
    """

    evaluations: int
    last: float
    expected: float
    low: float
    high: float

    @property
    def sentence(self) -> str:
        """It in words."""
        return (
            f"the latter half of {self.evaluations} evaluations made the hypervolume grow by "
            f"{self.last:.1%}; as many again usually add {self.expected:.1%} ({self.low:.1%} to "
            f"{self.high:.1%} in eight of ten searches)"
        )

    @property
    def json(self) -> dict[str, Any]:
        """It as a JSON object; shares from 0 on."""
        return dict(msgspec.to_builtins(self))


def growth(generations: Sequence[Generation]) -> HypervolumeGrowth | None:
    """How far a search is; None while it has hardly begun, or its hypervolume at half of them is not known.

    Args:
        generations: of a run, in order; those of a later session alone may do.
    """
    return growth_of([(each.evaluations, each.hypervolume) for each in generations])


def growth_of(history: Sequence[tuple[int, float | None]]) -> HypervolumeGrowth | None:
    """The same from numbers of evaluations, each with the hypervolume after it."""
    known = [(count, volume) for count, volume in history if volume is not None]
    if not known or known[-1][0] < 2 * known[0][0]:
        return None
    counts, volumes = np.array(known, dtype=float).T
    before = float(np.interp(np.log(counts[-1] / 2.0), np.log(counts), volumes))
    if before <= 0.0:
        return None
    last = float(volumes[-1]) / before - 1.0
    if last > MOST:
        return None
    return HypervolumeGrowth(int(counts[-1]), last, USUAL * last, LOW * last, HIGH * last)
