"""The table of what postures ask of people: whole at any width, and honest about what is not known."""

from __future__ import annotations

from dataclasses import replace
from io import StringIO

import pytest
from rich.console import Console

from evodesign.cli.tables.people import hardest_cases, people_table
from evodesign.quantities.ergonomics import ergonomics
from evodesign.records import Case, Hold
from tests.quantities.test_ergonomics import PERSON, posture

REACHING = {"jLeftShoulder_rotz": -1.57, "jRightShoulder_rotz": 1.57}


def printed(width: int) -> str:
    unrated = replace(PERSON, strengths={})
    cases = [
        (
            Case(person="[bold]female P95", payload="15 kg", task=Hold(height_m=0.8)),
            ergonomics(PERSON, posture({})),
        ),
        (Case(person="far", task=Hold(height_m=0.8)), ergonomics(unrated, posture(REACHING))),
    ]
    out = StringIO()
    Console(file=out, width=width).print(people_table(cases))
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


def test_of_several_people_only_the_hardest_cases_of_each_are_shown() -> None:
    def case(person: str, height: float) -> Case:
        return Case(person=person, payload="5 kg", task=Hold(height_m=height))

    quiet, far = ergonomics(PERSON, posture({})), ergonomics(PERSON, posture(REACHING))
    assert quiet.lifting_index is not None
    assert far.lifting_index is None, "nothing is recommended there, which counts as more than any index"
    asked = [(case("a", 0.8), quiet), (case("a", 1.0), far), (case("b", 0.8), quiet)]
    chosen = hardest_cases(asked)
    assert [one.person for one, _ in chosen][-1] == "b"
    for person in "ab":
        own = [one for one in asked if one[0].person == person]
        efforts = {one[0].task.height_m: one[1].strain.share for one in own if one[1].strain is not None}
        hardest = max(efforts, key=lambda height: efforts[height], default=own[0][0].task.height_m)
        shown = [one.task.height_m for one, _ in chosen if one.person == person]
        assert hardest in shown
        assert own[-1][0].task.height_m in shown, "its index is the largest"
    out = StringIO()
    Console(file=out, width=110).print(people_table(asked))
    assert "hardest postures" in out.getvalue()
    alone = [(Case(task=Hold(height_m=height)), quiet) for height in (0.8, 1.0)]
    out = StringIO()
    Console(file=out, width=110).print(people_table(alone))
    assert "each posture" in out.getvalue()
    assert "0.8 m" in out.getvalue()
