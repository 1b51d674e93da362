"""Quantities of pushes on the robot's trunk, simulated under whole-body controllers (docs/control.md).

    push_margin         the largest impulse that is survived, the least of eight directions [N s]
    push_margin_alone   the same of the robot without load and people
    load_tracking       largest distance of the load from its path after the problem's push, any direction [m]
    torque_saturation   largest share of the time after it in which a motor is at its limit [1]
    recovery_seconds    longest time from it until everything is back [s], at most `WATCHED_SECONDS`

Moments are the lowest and highest hold with every person and load, and two of each lift. Simulations take
seconds: they are run for designs alone that keep every other constraint.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

from evodesign.control.gains import Feedback
from evodesign.control.limits import WATCHED_SECONDS
from evodesign.records import Constraint, Objective, WeakestPush

if TYPE_CHECKING:
    from evodesign.quantities.design_result import DesignResult
    from evodesign.simulation.push import PushOutcome
    from evodesign.simulation.push_margin import Margin

MARGIN, ALONE, TRACKING = "push_margin", "push_margin_alone", "load_tracking"
SATURATION, RECOVERY = "torque_saturation", "recovery_seconds"

SIMULATED = (MARGIN, ALONE, TRACKING, SATURATION, RECOVERY)
"""Quantities that take simulations."""


Named = TypeVar("Named", Objective, Constraint)


def unsimulated(quantities: Sequence[Named]) -> tuple[Named, ...]:
    """Those among them that take no simulations."""
    return tuple(each for each in quantities if each.name not in SIMULATED)


@dataclass(frozen=True, slots=True)
class PushSettings:
    """What `[push]` of a problem says.

    Args:
        impulse: of the push after which the load is tracked [N s].
        feedback: of all controllers.
    """

    impulse: float
    feedback: Feedback


@dataclass(frozen=True, slots=True)
class FoundPushes:
    """What simulations say of a design.

    Args:
        margin: the least of all moments and directions; None where nothing asks for it.
        alone: likewise of the robot alone.
        outcomes: of the problem's push in each direction at every moment; none where nothing asks for them.
    """

    margin: Margin | None = None
    alone: Margin | None = None
    outcomes: tuple[PushOutcome, ...] = ()


def weakest_pushes(pushes: FoundPushes | None) -> dict[str, WeakestPush]:
    """Where each push margin is least, by its name."""
    found = {} if pushes is None else {MARGIN: pushes.margin, ALONE: pushes.alone}
    return {
        name: WeakestPush(margin.moment, math.degrees(margin.direction), margin.reason)
        for name, margin in found.items()
        if margin is not None
    }


def push_margin(result: DesignResult) -> float | None:
    """The largest push that robot, people and load survive [N s]; None where none was simulated."""
    return None if result.pushes is None or result.pushes.margin is None else result.pushes.margin.impulse


def push_margin_alone(result: DesignResult) -> float | None:
    """The largest push that the robot survives without load and people [N s], likewise."""
    return None if result.pushes is None or result.pushes.alone is None else result.pushes.alone.impulse


def load_tracking(result: DesignResult) -> float | None:
    """Largest distance of the load from its path after the problem's push [m]."""
    return max((each.load_off for each in _outcomes(result)), default=None)


def torque_saturation(result: DesignResult) -> float | None:
    """Largest share of the time after the problem's push in which a motor is at its limit [1]."""
    return max((each.saturation for each in _outcomes(result)), default=None)


def recovery_seconds(result: DesignResult) -> float | None:
    """Longest time after the problem's push until everything is back, or for which that is awaited [s]."""
    times = [each.recovery for each in _outcomes(result)]
    return max((WATCHED_SECONDS if time is None else time for time in times), default=None)


def _outcomes(result: DesignResult) -> tuple[PushOutcome, ...]:
    return () if result.pushes is None else result.pushes.outcomes
