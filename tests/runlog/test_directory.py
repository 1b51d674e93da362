"""Names of problems never lead out of the folder of runs."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evodesign.runlog.directory import name_in_path


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("point-grasp", "point-grasp"),
        ("v1.2_b", "v1.2_b"),
        ("../x", "_._x"),
        ("<script>", "_script_"),
        ("größe", "größe"),
        ("a/b\n c", "a_b__c"),
        (".hidden", "_hidden"),
    ],
)
def test_name_in_a_path_keeps_what_is_harmless(name: str, expected: str) -> None:
    assert name_in_path(name) == expected


@given(st.text(min_size=1))
def test_name_is_one_part_of_a_path(name: str) -> None:
    part = name_in_path(name)
    assert Path("runs", f"{part}-1").parent == Path("runs")
    assert not part.startswith(".")
    assert len(part.encode()) <= 200
