"""Quaternions give their rotation back, also where one of their parts vanishes."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from evodesign.body.placement import matrix_from_rpy, quaternion_wxyz

angle = st.floats(-math.pi, math.pi)
right_angles = [0.0, math.pi / 2.0, math.pi, -math.pi / 2.0]


def rotation_of(w: float, x: float, y: float, z: float) -> np.ndarray:
    """The rotation of p -> q p q*, with the quaternion products written out on the unit vectors."""

    def times(a: tuple[float, ...], b: tuple[float, ...]) -> tuple[float, ...]:
        return (
            a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
            a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
            a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
            a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
        )

    columns = [times(times((w, x, y, z), (0.0, *unit)), (w, -x, -y, -z))[1:] for unit in np.eye(3).tolist()]
    return np.array(columns).T


@given(angle, angle, angle)
def test_quaternion_turns_as_its_matrix(roll: float, pitch: float, yaw: float) -> None:
    matrix = matrix_from_rpy((roll, pitch, yaw))
    quaternion = quaternion_wxyz(matrix)
    assert math.hypot(*quaternion) == pytest.approx(1.0, abs=1e-14)
    assert np.allclose(rotation_of(*quaternion), matrix, rtol=0.0, atol=1e-13)


@pytest.mark.parametrize("roll", right_angles)
@pytest.mark.parametrize("pitch", right_angles)
@pytest.mark.parametrize("yaw", right_angles)
def test_right_angles_lose_nothing(roll: float, pitch: float, yaw: float) -> None:
    matrix = matrix_from_rpy((roll, pitch, yaw))
    assert np.allclose(rotation_of(*quaternion_wxyz(matrix)), matrix, rtol=0.0, atol=1e-15)
