"""Allocation parameters: numbers by which a design chooses how robot and person share the load.

    robot_share     part of the load's weight that the robot carries, 0 to 1
    effort_ratio    log10(w_r / w_h), where w_r + w_h = 2 weigh the agents' squared torques

So a front can span from "the robot carries" to "the person carries". An allocation parameter
belongs to no link.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

__all__ = ["ALLOCATIONS", "EFFORT_RATIO", "ROBOT_SHARE", "Allocation"]

ROBOT_SHARE, EFFORT_RATIO = "robot_share", "effort_ratio"


@dataclass(frozen=True, slots=True)
class Allocation:
    """The range of an allocation parameter.

    Args:
        usual: its value in the unscaled robot.
        lowest, highest: between which it means something.
    """

    usual: float
    lowest: float
    highest: float

    @property
    def wanted(self) -> str:
        """Its range in words."""
        return f"a number from {self.lowest:g} to {self.highest:g}"

    def means(self, value: float) -> bool:
        """Whether a value means something."""
        return self.lowest <= value <= self.highest


ALLOCATIONS: Mapping[str, Allocation] = {
    ROBOT_SHARE: Allocation(usual=0.5, lowest=0.0, highest=1.0),
    EFFORT_RATIO: Allocation(usual=0.0, lowest=-6.0, highest=6.0),
}
