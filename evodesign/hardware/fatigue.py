"""Fatigue of a wall whose load comes and goes: from nothing to its most and back, N times.

    S_N = A / sqrt(N) + B                       stress amplitude that breaks it after N cycles about zero
    sigma_a / S_N + sigma_m / S_u = 1 / n       Goodman; amplitude and mean are sigma_a = sigma_m = sigma / 2
    n = 2 / (sigma (1 / S_N + 1 / S_u))

A line through test results has half of them below it: a design curve divides S_N by two, and one for welds by
four (Yahr). Notches, screws and scatter of loads are not reckoned with.

Source: Goodman's line: Shigley, Mechanical Engineering Design; form of S_N: Langer 1962.
"""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class FatigueLine:
    """What amplitude a material bears how often.

    Args:
        falling: A [Pa].
        lasting: B [Pa].
        ultimate: S_u, at which it breaks at once [Pa].
        source: where the figures stand.
    """

    falling: float
    lasting: float
    ultimate: float
    source: str

    def amplitude(self, cycles: float) -> float:
        """S_N [Pa]."""
        return self.falling / math.sqrt(cycles) + self.lasting

    def safety_factor(self, stress: float, cycles: float) -> float:
        """By how much a stress [Pa] that comes and goes may grow; infinite for none."""
        if stress <= 0.0:
            return math.inf
        return 2.0 / (stress * (1.0 / self.amplitude(cycles) + 1.0 / self.ultimate))


ALUMINIUM_6061_T6 = FatigueLine(
    falling=14479e6,
    lasting=96.5e6,
    ultimate=310e6,
    source="Yahr, Fatigue design curves for 6061-T6 aluminum, Oak Ridge National Laboratory: his fit to five "
    "collections of tests, base metal; tensile strength: Callister and Rethwisch, Table B.4",
)
"""Of bars and plates that are not welded."""
