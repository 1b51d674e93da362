"""The documentation as a site: it builds without warnings, loads nothing from elsewhere, its search finds."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.report.page.chromium import Tab, browser

pytestmark = pytest.mark.slow

FIRST = {
    "constraint": "docs/recipes/constraint",
    "people": "docs/recipes/people",
    "cluster": "docs/recipes/cluster",
    "trust": "docs/trust",
    "own robot": "docs/recipes/own_robot",
    "pandas": "docs/recipes/pandas",
}
"""What is looked for, and the page that has to come first."""

RESULTS = (
    "[...document.querySelectorAll('#search-results ul.search li > a')].map(a => a.getAttribute('href'))"
)


@pytest.fixture(scope="module")
def site(repository: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("site")
    command = [
        sys.executable,
        "-m",
        "sphinx",
        "-W",
        "--keep-going",
        "-q",
        "-c",
        "docs",
        "-d",
        str(place / "trees"),
    ]
    built = subprocess.run(
        [*command, ".", str(place / "html")], cwd=repository, capture_output=True, text=True, check=False
    )
    assert built.returncode == 0, built.stderr
    return place / "html"


@pytest.fixture
def tab(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Tab]:
    with browser(tmp_path_factory.mktemp("profile")) as opened:
        yield opened


def test_the_search_finds_what_people_look_for_and_no_change(site: Path, tab: Tab) -> None:
    for words, page in FIRST.items():
        tab.open(f"file://{site}/search.html?q={words}")
        tab.wait_for(f"{RESULTS}.length > 3 || document.querySelector('.search-summary').textContent > ''")
        found = tab.value(RESULTS)
        assert found[0].split(".html")[0] == page, words
        assert not any(name.startswith("CHANGELOG") for name in found), words


def test_pages_set_formulas_and_load_nothing_from_elsewhere(site: Path, tab: Tab) -> None:
    for page in ("index", "docs/model", "docs/recipes/index"):
        tab.open(f"file://{site}/{page}.html")
    assert all(url.startswith("file:") for url in tab.requests())
    assert tab.complaints() == []
    assert (site / "docs" / "model.html").read_text(encoding="utf-8").count("<math") > 50
    assert "$" not in tab.value("document.querySelector('article').textContent")
