"""The numbers that set all gains of a feedback: one natural frequency and one damping ratio."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from evodesign.errors import InputError

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Feedback:
    """Of all joints and tasks of an agent.

    Args:
        frequency: natural frequency w [rad/s].
        damping: ratio z [1]; 1 is critical.
    Raises:
        InputError: a number that is not positive.
    """

    frequency: float = 8.0
    damping: float = 1.0

    def __post_init__(self) -> None:
        """Refuse what is no feedback."""
        for name in ("frequency", "damping"):
            if not 0.0 < getattr(self, name) < np.inf:
                raise InputError("feedback", name, "a positive number", f"{getattr(self, name)}")

    @property
    def rate(self) -> float:
        """2 z w [1/s]."""
        return 2.0 * self.damping * self.frequency

    def acceleration(self, place: Array, velocity: Array) -> Array:
        """w^2 times the missing place plus 2 z w times the missing velocity."""
        return self.frequency**2 * place + self.rate * velocity
