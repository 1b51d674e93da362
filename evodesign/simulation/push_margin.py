"""The largest push that is survived, in each of eight directions or in the weakest of them.

Bisection between an impulse that is survived and one that is not. For the weakest direction alone every other
one is only tried at the least margin so far, and bisected where it fails there. Where everything is its own
mirror image, one of each two mirrored directions is pushed.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from evodesign.simulation.push import Push, PushTest

DIRECTIONS = tuple(math.radians(each) for each in (90.0, 270.0, 0.0, 135.0, 225.0, 180.0, 45.0, 315.0))
"""Of pushes, from forwards to the left [rad]: the weaker ones of most robots first."""

RESOLUTION = 0.02
"""Of a margin, relative."""

NEAR = 0.2
"""A direction that is weaker than the weakest so far mostly is so by less than this share."""

SMALLEST = 0.1
"""An impulse [N s]: who does not survive it has no margin."""

FIRST, FASTEST = 0.2, 3.2
"""Impulses per mass [m/s] that are tried first and at most."""


@dataclass(frozen=True, slots=True)
class Margin:
    """The largest push that is survived, to within `RESOLUTION`.

    Args:
        moment: name of the moment of the plan.
        direction: from forwards to the left [rad].
        impulse: that is survived [N s].
        reason: why a slightly larger one is not; empty where the largest that was tried is survived.
        trials: simulations that it took.
    """

    moment: str
    direction: float
    impulse: float
    reason: str
    trials: int


def margin_in(
    tests: PushTest,
    moment: str,
    push: Push,
    mass: float,
    most: float = math.inf,
) -> Margin:
    """The margin in one direction.

    Args:
        tests: of one moment.
        moment: its name.
        push: of any impulse: who is pushed, where to and for how long.
        mass: of the agent [kg].
        most: an impulse of which no more is asked [N s].
    """
    reason, trials = "", 0

    def fails(impulse: float) -> bool:
        nonlocal reason, trials
        outcome, trials = tests.pushed(replace(push, impulse=impulse)), trials + 1
        reason = outcome.reason or reason
        return not outcome.survived

    low, high = 0.0, min(FIRST * mass, most) if math.isinf(most) else most
    while not fails(high):
        low = high
        if high >= min(most, FASTEST * mass):
            return Margin(moment, push.direction, high, "", trials)
        high = min(2.0 * high, most, FASTEST * mass)
    step = 0.5 if math.isinf(most) else NEAR
    while high - low > max(RESOLUTION * high, SMALLEST):
        middle = (low + high) / 2.0 if low > 0.0 else (1.0 - step) * high
        if fails(middle):
            high, step = middle, min(2.0 * step, 0.5)
        else:
            low = middle
    return Margin(moment, push.direction, low, reason, trials)


def different_directions(test: PushTest, directions: Sequence[float] = ()) -> dict[float, float]:
    """Of each direction, or of all, the one whose push does the same: itself or its mirror image."""
    kept: dict[float, float] = {}
    for direction in directions or DIRECTIONS:
        mirrored = (each for each in kept.values() if math.isclose(each + direction, math.tau))
        kept[direction] = next(mirrored, direction) if test.is_symmetric else direction
    return kept


def margins(
    tests: Mapping[str, PushTest], agent: str, mass: float, directions: Sequence[float] = ()
) -> tuple[Margin, ...]:
    """The margin in every direction at every moment; arguments as `margin_in`."""
    found = []
    for name, test in tests.items():
        same = different_directions(test, directions)
        own = {
            each: margin_in(test, name, Push(0.0, each, agent), mass) for each in dict.fromkeys(same.values())
        }
        found += [replace(own[like], direction=direction) for direction, like in same.items()]
    return tuple(found)


def least_margin(
    tests: Mapping[str, PushTest], agent: str, mass: float, directions: Sequence[float] = ()
) -> Margin | None:
    """The smallest of them, without finding the others; None without moments."""
    least, trials = None, 0
    for name, test in tests.items():
        for direction in dict.fromkeys(different_directions(test, directions).values()):
            most = math.inf if least is None else least.impulse
            found = margin_in(test, name, Push(0.0, direction, agent), mass, most)
            trials += found.trials
            if least is None or found.impulse < most:
                least = found
            if least.impulse <= 0.0:
                break
    return (
        None if least is None else Margin(least.moment, least.direction, least.impulse, least.reason, trials)
    )
