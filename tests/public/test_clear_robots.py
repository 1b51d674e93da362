"""Public humanoids with meshes, of which nothing is said but that their bodies keep clear of each other."""

from __future__ import annotations

from pathlib import Path

import pytest

from benchmarks.clear_robots import ROBOTS, measured

pytestmark = pytest.mark.needs_robots

DEEPEST = 0.003
"""Of an overlap [m]."""


@pytest.mark.slow
@pytest.mark.parametrize("name", ["gr1"])
def test_a_robot_with_meshes_holds_the_load_without_overlap(name: str, tmp_path: Path) -> None:
    found = measured(ROBOTS[name], tmp_path, fixed_starts=True)
    assert found["solved"]
    assert found["nearest"]["distance_m"] > -DEEPEST
    assert 0 < found["with_rows"]["robot"] < found["checked"]["robot"]
