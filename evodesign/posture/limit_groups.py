"""Which physical limits a joint problem enforces, and which it only hears of from the check.

The published code of the paper defines limits and applies none; this says, by the names that constraints and
the check's residuals share, what such a setting leaves out.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from evodesign.nlp.program import Variable

__all__ = ["Enforced"]

STANCE = ("feet_apart", "feet_stagger", "foot_yaw", "feet_yaw", "trunk_clear", "base_tilt", "push")
"""Last words of the names of stance constraints, and of their residuals in the check."""


@dataclass(frozen=True, slots=True)
class Enforced:
    """Which limits hold beside Eq. 14 a to g.

    Args:
        joint_limits: of both agents' joints.
        contact: unilateral feet, friction, the centre of pressure within the sole, and any bound of a wrench.
        stance: trunk clear of the load, feet apart and not turned, base tilt, push between the agents.
        lengths: the bounds of the length multipliers; those of densities always hold.
    """

    joint_limits: bool = True
    contact: bool = True
    stance: bool = True
    lengths: bool = True

    def covers(self, name: str) -> bool:
        """Whether a constraint, or a residual of the check, is enforced."""
        word = name.rsplit(".", 1)[1]
        if word.endswith(("foot_contact", "hand_moment")):
            return self.contact
        if word == "joint_limits":
            return self.joint_limits
        return self.stance or not word.endswith(STANCE)

    def variable(self, variable: Variable) -> Variable:
        """A posture's variable, without the bounds that are not enforced."""
        word = variable.name.rsplit(".", 1)[1]
        bounded = {"joints": self.joint_limits, "base_angles": self.stance}
        if bounded.get(word, self.contact or not word.endswith(("_hand", "_foot"))):
            return variable
        held = variable.lower == variable.upper  # what a symmetric posture does not have
        return replace(
            variable,
            lower=np.where(held, variable.lower, -np.inf),
            upper=np.where(held, variable.upper, np.inf),
        )

    def missed(self, residuals: Mapping[str, float]) -> dict[str, float]:
        """The residuals of limits that are not enforced."""
        return {name: size for name, size in residuals.items() if not self.covers(name)}

    def kept(self, residuals: Mapping[str, float]) -> dict[str, float]:
        """The residuals of limits that are enforced, and of everything that always holds."""
        return {name: size for name, size in residuals.items() if self.covers(name)}
