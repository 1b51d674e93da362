"""The families' map in the page: its cells are those of the command, and relatives are one click away."""

from __future__ import annotations

from pathlib import Path

import msgspec
import pytest

from evodesign.analysis.families import families
from evodesign.records import Descriptor
from evodesign.report.page import page_content, page_html
from evodesign.runlog.run import read_run
from evodesign.runlog.writer import RunWriter
from tests.report.page.chromium import Tab
from tests.report.page.reading import open_page
from tests.runlog.toys import toy_evaluations, toy_header

pytestmark = pytest.mark.needs_chromium

MAP = "document.getElementById('families')"


def open_families(tab: Tab) -> None:
    """Unfold the section as a reader does."""
    tab.value("document.querySelector('#families-section summary').click()")
    tab.wait_for(f"{MAP}.data !== undefined")


@pytest.mark.slow
def test_a_design_outside_the_map_is_said_to_be(tmp_path: Path, chromium: Tab) -> None:
    header = toy_header(budget=60)
    described = (Descriptor("arm.0", 1.0, 1.5, 5), Descriptor("arm.1", None, None, 5))
    header = msgspec.structs.replace(
        header, search=msgspec.structs.replace(header.search, descriptors=described)
    )
    evaluations = toy_evaluations(header, 60)
    with RunWriter(tmp_path / "run", header) as log:
        for evaluation in evaluations:
            log.write(evaluation)
    path = tmp_path / "report.html"
    path.write_text(page_html(page_content(read_run(tmp_path / "run"))), encoding="utf-8")
    open_page(chromium, path)
    open_families(chromium)
    for evaluation in evaluations:
        chromium.value(f"window.evodesign.select({evaluation.number})")
        said = chromium.value("document.getElementById('families-beyond').textContent")
        place = evaluation.assessment.design["arm.0"]
        sentence = f"Design {evaluation.number} lies outside the map in arm.0 (1 to 1.5)"
        assert (sentence in said) == (not 1.0 <= place <= 1.5)


def test_the_map_shows_the_elites_and_relatives_open_by_a_click(tmp_path: Path, chromium: Tab) -> None:
    header = toy_header(budget=60)
    with RunWriter(tmp_path / "run", header) as log:
        for evaluation in toy_evaluations(header, 60):
            log.write(evaluation)
    run = read_run(tmp_path / "run")
    path = tmp_path / "report.html"
    path.write_text(page_html(page_content(run)), encoding="utf-8")
    chromium.events.clear()
    open_page(chromium, path)
    assert chromium.value(f"{MAP}.data === undefined"), "families are drawn when they are asked for"
    open_families(chromium)
    elites = {kind.elite.number for kind in families(run.header, run.evaluations).kinds}
    drawn = chromium.value(f"{MAP}.data[0].customdata.flat().filter(n => n !== null)")
    assert sorted(drawn) == sorted(elites)
    chosen = chromium.value("window.evodesign.state.selected")
    relative = chromium.value("Number(document.querySelector('[data-relative]').dataset.relative)")
    assert relative in elites - {chosen}
    chromium.value("document.querySelector('[data-relative]').click()")
    assert chromium.value("document.getElementById('card-title').textContent") == f"Design {relative}"
    chromium.wait_for(f"{MAP}.data.length === 2")
    assert chromium.complaints() == []
