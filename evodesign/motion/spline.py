"""Uniform cubic splines at rest at both ends, as linear images of their coefficients.

With K knots a step apart, K coefficients c_1 .. c_K of B-splines say the whole motion; the ones beyond the
ends mirror those within (c_0 = c_2), so that the speed vanishes at both ends. At a knot

    x = (c_0 + 4 c_1 + c_2) / 6    dx/dt = (c_2 - c_0) / (2 step)    d2x/dt2 = (c_0 - 2 c_1 + c_2) / step^2

Everywhere the spline is a weighted mean of four coefficients, so bounds of coefficients are bounds of it.

Source: de Boor, A Practical Guide to Splines (2001), ch. IX to XI.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

Array = NDArray[np.float64]
DEGREE = 3


@dataclass(frozen=True, slots=True)
class RestingSpline:
    """Splines of so many knots.

    Args:
        knots: at least 4.
    """

    knots: int

    def image(self, places: Array, derivative: int = 0) -> Array:
        """Matrix from coefficients to values at places, or to derivatives with respect to the place.

        Args:
            places: counted in steps, from 0 to knots - 1, shape (n,).
            derivative: its order, 0 to 2.
        Returns:
            Shape (n, knots).
        """
        count = self.knots + 2
        ticks = np.arange(-DEGREE, count + 1.0)
        basis = scipy.interpolate.BSpline(ticks, np.eye(count), DEGREE)
        inside = np.clip(places, 0.0, np.nextafter(self.knots - 1.0, 0.0))
        return np.asarray(basis(inside, derivative) @ self._mirrored)

    @property
    def _mirrored(self) -> Array:
        """All coefficients from those that are free."""
        free = np.eye(self.knots)
        return np.vstack([free[1], free, free[-2]])

    def through(self, values: Array) -> Array:
        """Coefficients of the spline that has some values at the knots, shape (knots, ...)."""
        return np.asarray(np.linalg.solve(self.image(np.arange(float(self.knots))), values))
