"""Disturbances: loads that act beside the weights of robot, person and payload.

A disturbance makes the load heavier or lighter, moves its centre of mass, and pushes. The posture stays;
wrenches and joint torques change. All of it is proportional to the disturbance's size: one of size zero is
none.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from evodesign.body.placement import Vector


class PushedAt(StrEnum):
    """What a push meets: the load at its box's centre, or an agent at the last frame of its trunk."""

    LOAD = "load"
    ROBOT = "robot"
    HUMAN = "human"


class OverCases(StrEnum):
    """How efforts of the undisturbed and every disturbed case count together: their mean or the largest."""

    MEAN = "mean"
    WORST = "worst"


@dataclass(frozen=True, slots=True)
class Disturbance:
    """One thing that may happen.

    Args:
        name: what it is called in results.
        mass_share: by how much the load is heavier, as a share of its mass; above -1.
        center_of_mass: shift of the load's centre of mass [m].
        push: force in world axes [N].
        at: what is pushed: the load (`PushedAt.LOAD`), or an agent of a name.
    """

    name: str
    mass_share: float = 0.0
    center_of_mass: Vector = (0.0, 0.0, 0.0)
    push: Vector = (0.0, 0.0, 0.0)
    at: str = PushedAt.LOAD

    @property
    def sideways(self) -> bool:
        """Whether it has a part along y, so that what it leads to is not mirror-symmetric."""
        return bool(self.center_of_mass[1] != 0.0 or self.push[1] != 0.0)

    def push_on(self, place: str) -> Vector:
        """Its force on the load (`PushedAt.LOAD`) or on an agent of a name, in world axes [N]."""
        return self.push if self.at == place else (0.0, 0.0, 0.0)

    def changes_for(self, place: str) -> bool:
        """Whether an agent of a name feels any of it, be it through its hands."""
        changes_load = bool(self.mass_share) or any(self.center_of_mass)
        return changes_load or self.at in {PushedAt.LOAD, place}


@dataclass(frozen=True, slots=True)
class Disturbances:
    """What may happen to a scene.

    Args:
        cases: one disturbance each; the undisturbed case goes with them.
        effort: how the efforts of all cases count together.
    """

    cases: tuple[Disturbance, ...] = ()
    effort: OverCases = OverCases.WORST

    def __bool__(self) -> bool:
        return bool(self.cases)

    @property
    def several(self) -> bool:
        """Whether there is more than one."""
        return len(self.cases) > 1
