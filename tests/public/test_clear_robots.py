"""A public humanoid with meshes, of which nothing is said but that its bodies keep clear of each other."""

from __future__ import annotations

from pathlib import Path

import pytest

from benchmarks.clear_robots import measured
from tests.robots import HUMANOIDS

pytestmark = pytest.mark.needs_robots

DEEPEST = 0.003
"""Of an overlap [m]."""


@pytest.mark.slow
def test_a_robot_with_meshes_holds_the_load_without_overlap(tmp_path: Path) -> None:
    found = measured(HUMANOIDS["g1"], tmp_path, fixed_starts=True)
    assert found["solved"]
    assert found["nearest"]["distance_m"] > -DEEPEST
    assert 0 < found["with_rows"]["robot"] < found["checked"]["robot"]
