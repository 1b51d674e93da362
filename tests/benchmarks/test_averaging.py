"""Averaging a robot with its mirror image explains all that its torques differ by."""

from __future__ import annotations

import pytest

from benchmarks.averaging import measured


@pytest.mark.slow
@pytest.mark.needs_robots
@pytest.mark.parametrize("name", ["g1"])
def test_whole_postures_of_averaged_and_original_robot_have_equal_torques(name: str) -> None:
    rows = [*measured(name)]
    assert len(rows) == 3
    for row in rows:
        assert 0.0 < row["missed_n_m"] < 0.05
        assert abs(row["averaged_n_m"] - row["as_it_is_n_m"]) < row["missed_n_m"]
