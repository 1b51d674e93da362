"""Groups of limits, which a setting enforces or only hears of from the check.

Every row, bound, cost and residual of a term belongs to a group. The published code of the paper defines
limits and applies none: a setting like it leaves groups out.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class LimitGroup(StrEnum):
    """What a limit is about; the value is how a file and a sentence call it."""

    ALWAYS = "Eq. 14 a to g"
    """The load level at its height, hands on it, feet on the ground and flat, statics, torque limits."""
    JOINT_LIMITS = "joint limits"
    CONTACT = "contact"
    """Unilateral feet, friction, the centre of pressure within the sole, and any bound of a wrench."""
    STANCE = "stance"
    """Trunk clear of the load, feet apart and not turned, base tilt, internal force."""
    COLLISIONS = "bodies apart"
    """No body in another, the load, the floor or the partner; where a problem asks for it."""
    UPRIGHT = "upright feet"
    """Where joint limits do not hold, a foot can be flat upside down, which Eq. 14 f and g exclude."""


@dataclass(frozen=True, slots=True)
class Enforced:
    """Which limits hold beside Eq. 14 a to g.

    Args:
        joint_limits, contact, stance: the groups of these names.
        lengths: the bounds of the length multipliers; those of densities always hold.
    """

    joint_limits: bool = True
    contact: bool = True
    stance: bool = True
    lengths: bool = True

    def covers(self, group: LimitGroup) -> bool:
        """Whether the limits of a group are enforced."""
        return {
            LimitGroup.ALWAYS: True,
            LimitGroup.JOINT_LIMITS: self.joint_limits,
            LimitGroup.CONTACT: self.contact,
            LimitGroup.STANCE: self.stance,
            LimitGroup.COLLISIONS: True,
            LimitGroup.UPRIGHT: not self.joint_limits,
        }[group]
