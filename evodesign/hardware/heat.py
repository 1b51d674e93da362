"""How warm an actuator's winding gets in a shift: a load is held, time and again, and let go of between.

The winding is one body that gives its heat to the air,

    tau_w dT/dt = q (1 + a (T - 20 deg C)) - (T - T_air),    q = (|tau| / rated)^2 c

where copper's resistance grows with its temperature. What the rated torque, held for ever in air of 25
degrees, leads to is the winding's limit; that defines c = (T_limit - 25) / (1 + a (T_limit - 20)), so no
resistance need be known. The equation is linear in T while a torque stays: T tends to

    T_q = (T_air + q (1 - 20 a)) / (1 - q a)    as    exp(-(1 - q a) t / tau_w)

A shift begins at the air's temperature. From the end of a hold to that of the next one T' = A T + B, so after
n holds T_n = T* + A^(n-1) (T_1 - T*), T* = B / (1 - A): the warmest moment of the shift.

Left out: what a motor loses without torque, the housing as a second body, and friction in the gear, which
helps to hold.

Source: a body of one heat capacity; a = 0.00393 per kelvin at 20 degrees, of annealed copper (IEC 60028).
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass
from functools import lru_cache

import scipy

COPPER, COPPER_AT = 0.00393, 20.0
"""Growth of copper's resistance [1/K], and at which temperature [deg C]."""

RATED_AIR = 25.0
"""Temperature of the air [deg C] in which an actuator holds its rated torque for ever."""

BURNT = 1000.0
"""Temperature [deg C] at which copper is about to melt: nothing is told to be warmer."""

STEP = 1e-20
"""Of a complex step: rounding does not limit it."""


@dataclass(frozen=True, slots=True)
class Duty:
    """The rhythm in which a robot holds its load.

    Args:
        holds_per_hour: how often.
        hold: how long each time [s].
        shift: how long it goes on so [h].
        air: temperature [deg C].
        limit: of windings [deg C], to which the rated torque leads in the end.
        time_constant: of windings [s].
    """

    holds_per_hour: float
    hold: float
    shift: float
    air: float
    limit: float
    time_constant: float

    @property
    def derating(self) -> float:
        """Of the rated torque, what windings bear in this duty, at most all of it."""
        return _derating(self)

    def temperature(self, share: float) -> float:
        """The warmest moment of a winding [deg C].

        Args:
            share: of the rated torque that is held.
        """
        return min(self._temperature(complex(share)).real, BURNT)

    def slope(self, share: float) -> float:
        """Its derivative by the share; 0 where it is not told any more (`BURNT`)."""
        found = self._temperature(complex(share, STEP))
        return found.imag / STEP if found.real < BURNT else 0.0

    def _temperature(self, share: complex) -> complex:
        # no torque, no heat: q is even in the share, and so is its complex step
        unit = (self.limit - RATED_AIR) / (1.0 + COPPER * (self.limit - COPPER_AT))
        q, air = share * share * unit, self.air
        rate = (1.0 - q * COPPER) / self.time_constant
        towards = (air + q * (1.0 - COPPER * COPPER_AT)) / (1.0 - q * COPPER)
        warmed = cmath.exp(-rate * self.hold)
        cooled = math.exp((self.hold - 3600.0 / self.holds_per_hour) / self.time_constant)
        after = towards + warmed * (air - towards)
        kept = warmed * cooled
        always = (towards * (1.0 - warmed) + warmed * air * (1.0 - cooled)) / (1.0 - kept)
        count = max(1.0, math.floor(self.shift * self.holds_per_hour))
        power = (count - 1.0) * cmath.log(kept)
        if power.real > math.log(BURNT):
            return complex(math.inf)
        return always + cmath.exp(power) * (after - always)


@lru_cache(maxsize=64)
def _derating(duty: Duty) -> float:
    if duty.temperature(1.0) <= duty.limit:
        return 1.0
    return float(scipy.optimize.brentq(lambda share: duty.temperature(share) - duty.limit, 0.0, 1.0))
