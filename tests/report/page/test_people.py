"""The page of a run whose front met samples of people: its table, and the section of the card."""

from __future__ import annotations

from pathlib import Path

import pytest

from evodesign.report.page import page_content, page_html
from evodesign.runlog.run import read_run
from tests.measured_people import SAMPLES
from tests.report.page.chromium import Tab
from tests.report.page.reading import open_page

SECTIONS = "[...document.querySelectorAll('#card summary')].map(each => each.textContent)"


def test_the_content_has_the_spread_only_where_people_were_drawn(
    run_with_people: Path, repository: Path
) -> None:
    spread = page_content(read_run(run_with_people)).spread
    assert spread is not None
    assert (spread["samples"], spread["reference"]) == (SAMPLES, 0)
    assert page_content(read_run(repository / "tests/golden/lifting/format-2")).spread is None


@pytest.mark.slow
@pytest.mark.needs_chromium
def test_the_page_shows_on_how_many_fronts_a_design_is(
    run_with_people: Path, tmp_path: Path, chromium: Tab
) -> None:
    content = page_content(read_run(run_with_people))
    assert content.spread is not None
    path = tmp_path / "report.html"
    path.write_text(page_html(content), encoding="utf-8")
    chromium.events.clear()
    open_page(chromium, path)
    cells = "[...row.cells].map(one => one.textContent)"
    rows = chromium.value(f"[...document.querySelectorAll('[data-people]')].map(row => {cells})")
    assert [row[:2] for row in rows] == [
        [f"{own['id']}", f"{own['on_front']} of {SAMPLES}"] for own in content.spread["designs"]
    ]
    assert all("±" in row[3] for row in rows), "the person's torque"
    for own in content.spread["designs"]:
        chromium.value(f"window.evodesign.select({own['id']})")
        (title,) = [each for each in chromium.value(SECTIONS) if each.startswith("People")]
        assert f"on the front in {own['on_front']} of {SAMPLES} samples" in title
    met = {own["id"] for own in content.spread["designs"]}
    stranger = next(number for number in range(6) if number not in met)
    chromium.value(f"window.evodesign.select({stranger})")
    assert not [each for each in chromium.value(SECTIONS) if each.startswith("People")]
    assert chromium.complaints() == []
