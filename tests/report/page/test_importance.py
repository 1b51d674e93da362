"""What matters, in the page: the shares that `matters --json` tells, and slices through the chosen design."""

from __future__ import annotations

from pathlib import Path

import pytest

from evodesign.analysis.importance_json import matters_json
from evodesign.report.page import page_content, page_html
from evodesign.runlog.run import RunLog, read_run
from evodesign.runlog.writer import RunWriter
from tests.report.page.chromium import Tab
from tests.report.page.reading import open_page
from tests.runlog.toys import toy_evaluations, toy_header

pytestmark = pytest.mark.needs_chromium

ROWS = "[...document.querySelectorAll('[data-matters]')]"


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> RunLog:
    """A hundred and twenty designs of two parameters, of which a model can be made."""
    header = toy_header(budget=120)
    directory = tmp_path_factory.mktemp("importance") / "run"
    with RunWriter(directory, header) as log:
        for evaluation in toy_evaluations(header, 120):
            log.write(evaluation)
    return read_run(directory)


@pytest.mark.slow
def test_shares_slices_and_sentences_are_those_of_the_command(run: RunLog, chromium: Tab) -> None:
    path = run.directory / "report.html"
    path.write_text(page_html(page_content(run)), encoding="utf-8")
    chromium.events.clear()
    open_page(chromium, path)
    chosen = chromium.value("window.evodesign.state.selected")
    told = matters_json(run, chosen)
    for index, objective in enumerate(told["objectives"]):
        chromium.value(
            "(() => { const s = document.getElementById('importance-objective');"
            f"s.value = '{index}'; s.dispatchEvent(new Event('change')); }})()"
        )
        names = [each["name"] for each in objective["parameters"]]
        assert chromium.value(f"{ROWS}.map(row => row.dataset.matters)") == names
        share = objective["parameters"][0]["total"]["value"]
        assert chromium.value(f"{ROWS}[0].querySelector('.loose').textContent").startswith(
            f"{100 * share:.1f} % ("
        )
        drawn = chromium.value(f"{ROWS}[0].querySelector('.mean').getAttribute('points').split(' ').length")
        slices = {
            each["parameter"]: each for each in told["slices"] if each["objective"] == objective["name"]
        }
        assert drawn == len(slices[names[0]]["values"])
        assert chromium.value(f"{ROWS}[0].querySelector('.here') !== null")
    remarks = chromium.value(
        "[...document.querySelectorAll('#importance-remarks li')].map(e => e.textContent)"
    )
    assert set(told["sentences"]) <= set(remarks)
    assert chromium.complaints() == []


def test_of_a_few_designs_the_page_says_why_nothing_can_be_told(real_page: Path, chromium: Tab) -> None:
    open_page(chromium, real_page)
    assert chromium.value("document.getElementById('importance').hidden")
    remark = chromium.value("document.querySelector('#importance-remarks li').textContent")
    assert "cannot be told from this log" in remark
