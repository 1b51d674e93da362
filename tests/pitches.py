"""Pitch angles [rad], of which many are upright or nearly so."""

import math

from hypothesis import strategies as st

upright = st.sampled_from([-math.pi / 2, math.pi / 2])
nearly_upright = st.builds(
    lambda pitch, side, exponent: pitch + side * 10.0**exponent,
    upright,
    st.sampled_from([-1.0, 1.0]),
    st.floats(-17.0, -2.0),
)
pitches = st.floats(-1.5, 1.5) | upright | nearly_upright
