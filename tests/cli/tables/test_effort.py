"""The table of backs, holding times and posture scores: whole at any width, honest about what is unknown."""

from __future__ import annotations

from dataclasses import replace
from io import StringIO

import pytest
from rich.console import Console

from evodesign.cli.tables.people import effort_table
from evodesign.human.back import ACTION_LIMIT
from evodesign.human.endurance import endurance
from evodesign.quantities.ergonomics import Ergonomics, ergonomics
from evodesign.records import Case, Hold
from tests.quantities.test_ergonomics import PERSON, posture


def printed(asked: Ergonomics, width: int = 110, person: str = "") -> str:
    out = StringIO()
    case = Case(person=person, task=Hold(height_m=0.8))
    Console(file=out, width=width).print(effort_table([(case, asked)]))
    return out.getvalue()


def cells(text: str) -> list[str]:
    (row,) = [line.split("│")[1:-1] for line in text.splitlines() if line.startswith("│ 0.8 m")]
    return [cell.strip() for cell in row]


@pytest.mark.parametrize("width", [80, 110])
def test_the_table_fits_and_names_the_limit(width: int) -> None:
    text = printed(ergonomics(PERSON, posture({})), width)
    assert max(map(len, text.splitlines())) <= width
    assert "3.4 kN" in text


def test_who_bends_more_than_the_limit_allows_is_marked() -> None:
    asked = ergonomics(PERSON, posture({}))
    heavy = replace(asked, back=replace(asked.back, moment=200.0))
    assert heavy.back.compression > ACTION_LIMIT > asked.back.compression
    assert cells(printed(heavy))[1].endswith("!")
    assert "!" not in cells(printed(asked))[1]


def test_a_time_beyond_what_was_measured_says_so() -> None:
    """One newton metre everywhere: the joint that tires first works at less than a tenth of its strength."""
    asked = ergonomics(PERSON, posture({}))
    assert asked.endurance.joint.share < 0.10
    assert cells(printed(asked))[4].startswith("> ")
    tired = endurance({"jLeftShoulder_rotz": -40.0}, PERSON.strengths)
    assert not cells(printed(replace(asked, endurance=tired)))[4].startswith(">")


def test_of_several_people_the_hardest_cases_of_each_are_shown() -> None:
    asked = ergonomics(PERSON, posture({}))
    heavy = replace(asked, back=replace(asked.back, moment=200.0))
    cases = [
        (Case(person=name, task=Hold(height_m=height)), heavy if height == 1.0 else asked)
        for name in ("short", "tall")
        for height in (0.8, 1.0, 1.2)
    ]
    out = StringIO()
    Console(file=out, width=110).print(effort_table(cases))
    text = out.getvalue()
    assert "each person's hardest postures" in text
    assert "short, 1 m" in text
    assert "tall, 1 m" in text
    assert "1.2 m" not in text


def test_what_is_not_known_is_a_dash() -> None:
    bare = replace(ergonomics(PERSON, posture({})), back=None, endurance=None, rula=None, reba=None)
    found = cells(printed(bare))
    assert found[1:3] == ["-", "-"]
    assert found[4:] == ["-"] * 4
