"""docs/problem_file.md lists every quantity that can be an objective or a constraint, as the code has it."""

from __future__ import annotations

from pathlib import Path

import pytest

from docs.write_problem_file import PAGE, page
from evodesign.problem.constraints import constraint_key
from evodesign.quantities.design_result import WORST
from evodesign.quantities.objectives import QUANTITIES, objective_kind, objective_kinds
from evodesign.records import Sense


@pytest.fixture(scope="module")
def rows(repository: Path) -> dict[str, list[str]]:
    """The table's cells after the name, by name."""
    text = (repository / "docs" / "problem_file.md").read_text(encoding="utf-8")
    section = text.split("## Quantities")[1].split("\n#")[0]
    lines = [line for line in section.splitlines() if line.startswith("| `")]
    cells = [[cell.strip(" `") for cell in line.strip("|").split("|")] for line in lines]
    return {name: rest for name, *rest in cells}


def test_the_stored_page_is_what_the_schema_says() -> None:
    assert PAGE.read_text(encoding="utf-8") == page(), "python -m docs.write_problem_file writes it"


def test_every_quantity_has_a_row_and_every_row_a_quantity(rows: dict[str, list[str]]) -> None:
    assert list(rows) == [name for name in objective_kinds() if not name.startswith(WORST)]


def test_rows_have_key_unit_sense_and_meaning(rows: dict[str, list[str]]) -> None:
    for name, (key, unit, sense, meaning) in rows.items():
        kind = objective_kind(name)
        assert kind is not None
        assert (key, unit) == (constraint_key(name), kind.unit)
        assert sense in set(Sense)
        assert len(meaning.split()) > 2


def test_the_first_rows_are_those_with_a_value_in_every_case(rows: dict[str, list[str]]) -> None:
    assert list(rows)[:11] == list(QUANTITIES), "the text says that the first eleven have worst values"
