"""The table of active limits: a row each, a column for each case, or a summary of many."""

from __future__ import annotations

import io

from rich.console import Console

from evodesign.cli.tables.design import limits_table
from evodesign.records import ActiveLimit, Case, CaseDetail, Hold, InstantDetail

INSTANT = (InstantDetail(time_s=0.0, agents={}),)


def limit(name: str, price: float, agent: str = "human", *, unit: str = "m", part: str = "") -> ActiveLimit:
    return ActiveLimit(
        name=name, value=0.5, unit=unit, price_n_m=price, at_most=price < 0.0, agent=agent, part=part
    )


def printed(cases: list[CaseDetail], width: int = 80) -> list[str]:
    shown = io.StringIO()
    Console(file=shown, width=width).print(limits_table(cases))
    return shown.getvalue().splitlines()


def case(height: float, *limits: ActiveLimit) -> CaseDetail:
    return CaseDetail(case=Case(task=Hold(height_m=height)), instants=INSTANT, limits=limits)


def test_each_case_has_a_column_and_each_limit_a_row() -> None:
    apart, elbow = limit("feet apart", -25.0), limit("joint range", 3.0, "robot", unit="rad", part="l_elbow")
    lines = printed([case(0.8, apart), case(1.0, limit("feet apart", -12.0), elbow)])
    assert max(map(len, lines)) <= 80
    (row,) = (line for line in lines if "feet apart" in line)
    assert [cell.strip() for cell in row.split("│")[1:-1]] == [
        "human", "feet apart, at most 50 cm", "cm", "-0.25", "-0.12",
    ]  # fmt: skip
    (row,) = (line for line in lines if "joint range of" in line)
    assert [cell.strip() for cell in row.split("│")[1:4:2]] == ["robot", "degree"]
    assert row.split("│")[4].strip() == "-"


def test_many_cases_are_summed_up() -> None:
    cases = [
        case(0.7 + 0.05 * place, limit("internal force", -0.1 * place, "", unit="N")) for place in range(1, 9)
    ]
    (row,) = (line for line in printed(cases) if "internal force" in line)
    assert [cell.strip() for cell in row.split("│")[1:-1]] == [
        "both", "internal force, at most 0.5 N", "N", "8 of 8", "-0.45", "-0.8",
    ]  # fmt: skip


def test_names_of_a_file_are_shown_as_they_stand_and_control_characters_as_escapes() -> None:
    lines = printed([case(0.8, limit("\x1b[2Jfeet", -5.0, "\x1brobot"))])
    assert not any("\x1b" in line for line in lines)
    lines = printed([case(0.8, limit("joint range", -5.0, "robot", unit="rad", part="[red]arm"))])
    assert any("[red]arm" in line for line in lines)
