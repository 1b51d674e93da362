"""Sizes that a demand asks for, where the demand grows with the size.

A stronger actuator is heavier, and what carries it needs more torque. The size wanted is the fixed point of

    s = margin x demand(s)

found by solving again with the last sizes until none of them changes by more than a share of itself. From the
third round on each size follows the secant through its last two demands, which are nearly linear in it:

    s' = s + (w - s) / (1 - r),    r = (w - w_before) / (s - s_before),    w = margin x demand(s)

unless somebody can predict the demand at other sizes.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from evodesign.records import Status

__all__ = ["ROUNDS", "TOLERANCE", "Sizing", "sized"]

TOLERANCE = 1e-4
"""Largest change of a size, as a share of it, that ends the rounds."""

ROUNDS = 4
"""How often the demand is asked for."""

PREDICTIONS, SETTLED = 200, 1e-9
"""How often a prediction is asked for, and the change of a size that ends that."""

LARGEST_SLOPE = 0.5
"""Largest slope of the secant at which it is followed; beyond, the next size is the one wanted."""

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


def sized(
    demand: Callable[[Sizes], Sizes | None],
    start: Sizes,
    margins: Sizes,
    bounds: Mapping[str, tuple[float, float]],
    predict: Callable[[Sizes], Sizes] | None = None,
    rounds: int = ROUNDS,
    tolerance: float = TOLERANCE,
) -> Sizing:
    """The sizes that are their margins times the demand on them.

    Args:
        demand: what is asked of each size, in its unit, given all sizes; None where it cannot be told.
        start: sizes of the first round.
        margins: how many times the demand each size is.
        bounds: smallest and largest size that there is; a demand beyond them is met by neither.
        predict: what the demand would be at other sizes than those it was asked for last, cheaply; the next
            sizes are then those that meet it. Left out, sizes follow secants.
        rounds: largest number of times that the demand is asked for.
        tolerance: largest change of a size, as a share of it, that ends the rounds.
    """
    sizes: Sizes = dict(start)
    before: Mapping[str, tuple[float, float]] = {}
    wanted = sizes
    for number in range(1, rounds + 1):
        asked = demand(sizes)
        if asked is None:
            reason = f"the demand on the actuators is not known after {number} rounds of sizing"
            return Sizing(Status.INFEASIBLE, reason, sizes, wanted, number)
        wanted = {name: _inside(margins[name] * asked[name], bounds[name]) for name in sizes}
        if _change(sizes, wanted) <= tolerance:
            return Sizing(Status.SOLVED, "solved", sizes, wanted, number)
        if number < rounds:
            here = {name: (sizes[name], wanted[name]) for name in sizes}
            if predict is None:
                following = {name: _following(here[name], before.get(name)) for name in sizes}
                sizes = {name: _inside(size, bounds[name]) for name, size in following.items()}
            else:
                sizes = _settled(predict, wanted, margins, bounds)
            before = here
    change = _change(sizes, wanted)
    reason = f"actuators still change by {change:.1e} of their size after {rounds} rounds"
    return Sizing(Status.ITERATION_LIMIT, reason, sizes, wanted, rounds)


def _settled(
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


def _following(here: tuple[float, float], before: tuple[float, float] | None) -> float:
    """The next size from the last one and what it wanted, and the same of the round before."""
    size, wanted = here
    if before is None or size == before[0]:
        return wanted
    slope = (wanted - before[1]) / (size - before[0])
    return wanted if abs(slope) > LARGEST_SLOPE else size + (wanted - size) / (1.0 - slope)


def _inside(size: float, bounds: tuple[float, float]) -> float:
    return min(max(size, bounds[0]), bounds[1])


def _change(sizes: Sizes, wanted: Sizes) -> float:
    return max((abs(wanted[name] - size) / size for name, size in sizes.items()), default=0.0)
