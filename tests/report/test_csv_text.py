"""No name is a formula in a spreadsheet, and every name and number can be read back."""

from __future__ import annotations

import csv
import io

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evodesign.report.csv_text import csv_text


def read_back(text: str) -> list[list[str]]:
    """As docs/export.md tells programs to."""
    rows = csv.reader(io.StringIO(text, newline=""))
    return [[cell.removeprefix("'") for cell in row] for row in rows]


@pytest.mark.parametrize(
    "name", ["=cmd|'/C calc'!A0", "+1", "-1+cmd", "@SUM(A1)", "\t=1", "\r=1", "\n=1", "\uff1d1", "'=1"]
)
def test_no_cell_begins_a_formula(name: str) -> None:
    ((shown, plain),) = csv.reader(io.StringIO(csv_text([[name, "l_knee"]]), newline=""))
    assert shown == f"'{name}"
    assert plain == "l_knee"


@given(st.lists(st.text(st.characters(codec="utf-8"), min_size=1), min_size=1))
def test_every_name_can_be_read_back(names: list[str]) -> None:
    assert read_back(csv_text([names])) == [names]


@given(st.floats(allow_nan=False))
def test_numbers_are_written_in_full_whatever_their_sign(number: float) -> None:
    ((shown,),) = csv.reader(io.StringIO(csv_text([[number]])))
    assert float(shown) == number
