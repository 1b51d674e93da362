"""Sizes that a demand asks for, where the demand grows with the size.

A stronger actuator is heavier, and what carries it needs more torque. The size wanted is the fixed point of

    s = margin x demand(s)

found by solving again with other sizes until none of them changes by more than a share of itself. With F(s)
the sizes that would meet the demand found for s, or the demand predicted around it, the next sizes are

    log s' = log F(s) - sum_i g_i (log F(s) - log F(s_i)),    g: least squares of  f = sum_i g_i (f - f_i)

over the latest earlier rounds i, at most as many as there are sizes, where f = log F(s) - log s (Anderson's
mixing; of a single size, the secant).

Source: Anderson 1965; Walker and Ni 2011, Eq. 2.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from evodesign.records import Status

TOLERANCE = 1e-4
"""Largest change of a size, as a share of it, that ends the rounds."""

ROUNDS = 20
"""How often the demand is asked for."""

PREDICTIONS, SETTLED = 200, 1e-5
"""How often a prediction is asked for, and the change of a size that ends that."""

LARGEST_SHARE = 1.0
"""Sum of |g_i| from which on earlier rounds say nothing."""

Array = NDArray[np.float64]

Sizes = Mapping[str, float]


@dataclass(frozen=True, slots=True)
class Sizing:
    """What became of the rounds.

    Args:
        status: solved, or the iteration limit.
        reason: a sentence.
        sizes: for which the demand was asked last, by name.
        wanted: margin x demand at these sizes.
        rounds: how often the demand was asked for.
    """

    status: Status
    reason: str
    sizes: Sizes
    wanted: Sizes
    rounds: int

    @property
    def change(self) -> float:
        """The largest difference of a size from the one wanted, as a share of it."""
        return _change(self.sizes, self.wanted)


class SizingRounds:
    """Asks for the demand on sizes until they are their margins times the demand.

    Args:
        start: sizes of the first round.
        margins: how many times the demand each size is.
        bounds: smallest and largest size that there is; a demand beyond them is met by neither.
        rounds: largest number of times that the demand is asked for.
        tolerance: largest change of a size, as a share of it, that ends the rounds.
    Attributes:
        sizes: for which the demand is to be told next.
    """

    def __init__(
        self,
        start: Sizes,
        margins: Sizes,
        bounds: Mapping[str, tuple[float, float]],
        rounds: int = ROUNDS,
        tolerance: float = TOLERANCE,
    ) -> None:
        self.sizes, self._margins, self._bounds = dict(start), margins, bounds
        self._rounds, self._tolerance = rounds, tolerance
        self._wanted, self._round = self.sizes, 0
        self._met: list[tuple[Array, Array]] = []

    def ended_by(
        self, demand: Sizes | None, predict: Callable[[Sizes], Sizes] | None = None
    ) -> Sizing | None:
        """How the rounds end with a demand; None if it is to be told for other sizes.

        Args:
            demand: what is asked of each size, in its unit; None where it cannot be told.
            predict: what the demand would be at other sizes, cheaply; left out, it would be the same.
        """
        self._round += 1
        sizes = self.sizes
        if demand is None:
            reason = f"the demand on the actuators is not known after {self._round} rounds of sizing"
            return self._ended(Status.INFEASIBLE, reason)
        wanted = {n: _inside(self._margins[n] * demand[n], self._bounds[n]) for n in sizes}
        self._wanted, change = wanted, _change(sizes, wanted)
        if change <= self._tolerance:
            return self._ended(Status.SOLVED, "solved")
        if self._round == self._rounds:
            reason = f"actuators still change by {change:.1e} of their size after {self._rounds} rounds"
            return self._ended(Status.ITERATION_LIMIT, reason)
        met = wanted if predict is None else sizes_met(predict, wanted, self._margins, self._bounds)
        self._met.append((np.log([*sizes.values()]), np.log([met[name] for name in sizes])))
        following = zip(sizes, np.exp(_mixed(self._met)).tolist(), strict=True)
        self.sizes = {name: _inside(size, self._bounds[name]) for name, size in following}
        return None

    def _ended(self, status: Status, reason: str) -> Sizing:
        return Sizing(status, reason, self.sizes, self._wanted, self._round)


def sizes_met(
    predict: Callable[[Sizes], Sizes], start: Sizes, margins: Sizes, bounds: Mapping[str, tuple[float, float]]
) -> Sizes:
    """The sizes that are their margins times the predicted demand on them."""
    sizes = start
    for _ in range(PREDICTIONS):
        asked = predict(sizes)
        following = {name: _inside(margins[name] * asked[name], bounds[name]) for name in sizes}
        done = _change(sizes, following) < SETTLED
        sizes = following
        if done:
            break
    return sizes


def _mixed(met: Sequence[tuple[Array, Array]]) -> Array:
    """The logarithms of the next sizes, from those of each round's sizes and of those that would meet it."""
    size, wanted = met[-1]
    if len(met) == 1:
        return wanted
    earlier = met[-1 - len(size) : -1]
    gaps = np.column_stack([(wanted - size) - (w - s) for s, w in earlier])
    moves = np.column_stack([wanted - w for _, w in earlier])
    share = np.linalg.lstsq(gaps, wanted - size, rcond=None)[0]
    return np.asarray(wanted - moves @ share) if np.abs(share).sum() < LARGEST_SHARE else wanted


def _inside(size: float, bounds: tuple[float, float]) -> float:
    return min(max(size, bounds[0]), bounds[1])


def _change(sizes: Sizes, wanted: Sizes) -> float:
    return max((abs(wanted[name] - size) / size for name, size in sizes.items()), default=0.0)
