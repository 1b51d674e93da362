"""The table of a design's postures names who holds what only where there are several."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from io import StringIO

from msgspec import structs
from rich.console import Console
from rich.table import Table

from evodesign.cli.tables.cases import cases_table, summary_table
from evodesign.records import Assessment, Case, CaseOutcome, Hold, Status

CASES = partial(cases_table, title="")


def outcome(human: str = "", payload: str = "") -> CaseOutcome:
    return CaseOutcome(
        case=Case(person=human, payload=payload, task=Hold(height_m=1.0)),
        status=Status.SOLVED,
        reason="solved",
        robot_torque_norm=1.0,
        human_torque_norm=2.0,
        iterations=3,
        residual=1e-9,
    )


def printed(table: Callable[[Assessment], Table], *heights: CaseOutcome) -> str:
    assessment = Assessment(
        design={}, objectives={}, violation=0.0, status=Status.SOLVED, reason="solved", cases=heights
    )
    out = StringIO()
    Console(file=out, width=110).print(table(assessment))
    return out.getvalue()


def test_who_holds_what_is_named_where_there_are_several() -> None:
    text = printed(CASES, outcome("male P5", "5 kg"), outcome("[red]tall"))
    assert "person" in text
    assert "│ male P5   │ 5 kg │" in text
    assert "│ [red]tall │" in text


def test_one_person_with_one_load_needs_no_name() -> None:
    assert "person" not in printed(CASES, outcome())


def test_torques_under_disturbances_stand_below_their_case_and_count_in_the_summary() -> None:
    pushed = structs.replace(outcome("tall", "5 kg"), disturbed={"push": {"robot": 4.0, "human": 8.0}})
    short = outcome("short", "5 kg")
    text = printed(CASES, pushed, short)
    assert [line.split() for line in text.splitlines() if "under 'push'" in line] == [
        ["│", "│", "│", "│", "4", "│", "8", "│", "│", "under", "'push'", "│"]
    ]
    summary = printed(summary_table, pushed, short)
    rows = [[cell.strip() for cell in line.split("│")[1:-1]] for line in summary.splitlines()]
    assert ["all", "2 of 2", "2", "4", "4", "8"] in rows
    assert ["tall", "1 of 1", "2.5", "4", "5", "8"] in rows
    assert ["short", "1 of 1", "1", "1", "2", "2"] in rows
