"""The largest push that is survived, in each of eight directions or in the weakest of them.

A ladder of impulses leads to the lowest rung on which any push is lost; between it and the rung below, the
least margin is bisected. For the weakest direction alone, all others are first pushed on that rung: who
survives it is no weaker and is pushed no more. Where everything is its own mirror image, one of each two
mirrored directions is pushed.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from evodesign.simulation.push import SURVIVING, Push, PushTest

DIRECTIONS = tuple(math.radians(each) for each in (90.0, 270.0, 0.0, 135.0, 225.0, 180.0, 45.0, 315.0))
"""Of pushes, from forwards to the left [rad]: the weaker ones of most robots first."""

RESOLUTION = 0.02
"""Of a margin, relative."""

SMALLEST = 0.1
"""An impulse [N s]: who does not survive it has no margin."""

FIRST, FASTEST = 0.4, 3.2
"""Impulses per mass [m/s] of the rung that is tried first and of what is tried at most."""

RUNG = 1.32
"""Between two rungs of the ladder: four bisections from `RESOLUTION`."""


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


class _Bracket:
    """What is known of the pushes in one direction at one moment.

    Attributes:
        low: largest impulse that was survived [N s].
        high: smallest that was not [N s].
        reason: why.
        trials: simulations that it took.
    """

    def __init__(self, test: PushTest, moment: str, push: Push) -> None:
        self.moment, self.direction, self._test, self._push = moment, push.direction, test, push
        self.low, self.high, self.reason, self.trials = 0.0, math.inf, "", 0

    def survives(self, impulse: float) -> bool:
        """Whether a push is survived; simulated if no smaller or larger one says so."""
        if self.low < impulse < self.high:
            outcome = self._test.pushed(replace(self._push, impulse=impulse), awaited=SURVIVING)
            self.trials += 1
            if outcome.survived:
                self.low = impulse
            else:
                self.high, self.reason = impulse, outcome.reason
        return impulse <= self.low


def _least(brackets: Sequence[_Bracket], mass: float) -> Margin:
    """The smallest margin of some pushes on an agent of a mass [kg]."""

    def rung(number: int) -> float:
        impulse = FIRST * mass * RUNG**number
        return min(impulse, FASTEST * mass) if impulse > SMALLEST else 0.0

    number = 0
    while rung(number) < FASTEST * mass and brackets[0].survives(rung(number)):
        number += 1
    for each in brackets:
        if not each.survives(rung(number)):
            while not each.survives(rung(number - 1)):
                number -= 1
    low, high = rung(number - 1), rung(number)
    weaker = [each for each in brackets if each.low < high]
    while weaker and high - low > max(RESOLUTION * high, SMALLEST):
        middle = (low + high) / 2.0
        lost = next((each for each in weaker if not each.survives(middle)), None)
        low, high = (middle, high) if lost is None else (low, middle)
        weaker = sorted((each for each in weaker if each.low < high), key=lambda each: each.high)
    trials = sum(each.trials for each in brackets)
    if not weaker:
        return Margin(brackets[0].moment, brackets[0].direction, high, "", trials)
    return Margin(weaker[0].moment, weaker[0].direction, low, weaker[0].reason, trials)


def margin_in(test: PushTest, moment: str, push: Push, mass: float) -> Margin:
    """The margin in one direction.

    Args:
        test: of one moment.
        moment: its name.
        push: of any impulse: who is pushed, where to and for how long.
        mass: of the agent [kg].
    """
    return _least([_Bracket(test, moment, push)], mass)


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
    brackets = [
        _Bracket(test, name, Push(0.0, direction, agent))
        for name, test in tests.items()
        for direction in dict.fromkeys(different_directions(test, directions).values())
    ]
    return _least(brackets, mass) if brackets else None
