"""The table of what postures ask of people: whole at any width, and honest about what is not known."""

from __future__ import annotations

from dataclasses import replace
from io import StringIO

import pytest
from rich.console import Console

from evodesign.analysis.cases import case_name
from evodesign.cli.person_table import person_table
from evodesign.problem.ergonomics import ergonomics
from evodesign.records import HeightDetail
from tests.problem.test_ergonomics import PERSON, posture

REACHING = {"jLeftShoulder_rotz": -1.57, "jRightShoulder_rotz": 1.57}


def printed(width: int) -> str:
    unrated = replace(PERSON, strengths={})
    cases = [
        ("[bold]female P95, 15 kg, 0.8 m", ergonomics(PERSON, posture({}))),
        ("far", ergonomics(unrated, posture(REACHING))),
    ]
    out = StringIO()
    Console(file=out, width=width).print(person_table(cases))
    return out.getvalue()


@pytest.mark.parametrize("width", [80, 110])
def test_the_table_fits_and_cuts_nothing_off(width: int) -> None:
    text = printed(width)
    assert max(map(len, text.splitlines())) <= width
    assert "…" not in text
    assert "[bold]" in text.replace("\n", "")


def test_what_is_not_known_or_not_recommended_is_a_dash() -> None:
    (row,) = [line.split("│")[1:-1] for line in printed(110).splitlines() if line.startswith("│ far")]
    cells = [cell.strip() for cell in row]
    assert cells[1:3] == ["-", "-"]
    assert cells[-2:] == ["0.0", "-"]


def test_a_case_is_named_by_who_and_what_only_where_there_are_several() -> None:
    assert case_name(HeightDetail(height_m=1.0, agents={})) == "1 m"
    several = HeightDetail(height_m=0.8, agents={}, human_name="male P5", payload_name="10 kg")
    assert case_name(several) == "male P5, 10 kg, 0.8 m"
