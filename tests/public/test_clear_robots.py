"""Public humanoids with meshes, of which nothing is said but that their bodies keep clear of each other."""

from __future__ import annotations

from pathlib import Path

import pytest

from benchmarks.clear_robots import ROBOTS, measured
from evodesign.posture.precompute import meetings

pytestmark = pytest.mark.needs_robots

DEEPEST = 0.003
"""Of an overlap [m]."""


@pytest.mark.slow
@pytest.mark.parametrize("name", ["gr1"])
def test_a_robot_with_meshes_holds_the_load_without_overlap(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Pairs are looked for in a seventh of the usual designs, and nothing is compiled, for time."""
    for number in ("DESIGNS", "AT_CORNERS", "AT_REACH", "FEWEST"):
        usual = getattr(meetings, number)
        monkeypatch.setattr(meetings, number, max(usual // 7, 1))
    monkeypatch.setenv("CC", "/nowhere/cc")
    found = measured(ROBOTS[name], tmp_path, fixed_starts=True)
    assert found["solved"]
    assert found["nearest"]["distance_m"] > -DEEPEST
    assert 0 < found["with_rows"]["robot"] < found["checked"]["robot"]
