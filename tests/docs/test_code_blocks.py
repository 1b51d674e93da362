"""The Python of README and docs runs as it stands, but for budgets."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest

import evodesign
from evodesign.posture.precompute.precomputed import Precomputed

pytestmark = pytest.mark.slow

REPOSITORY = Path(__file__).parents[2]
BLOCK = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)
GENERATED = "api.md"
"""Its blocks are signatures, and its examples have tests of their own."""

NOT_RUN = {"distributed.md": "from dask_jobqueue"}
"""Pages whose code needs what no test has: a batch system."""

SMALLER = {
    "icub-lifting": "point-grasp",
    r"evaluations=240": "evaluations=8, population=4",
    r"evaluations=480": "evaluations=12",
    r"pop_size=24": "pop_size=4",
    r'\("n_gen", 10\)': '("n_gen", 1)',
    r"n_trials=100": "n_trials=2",
    r"\[0\.9, 1\.1\]": "[0.8, 1.0, 1.2]",
}
"""Budgets for a test, and heights for which everything is precomputed."""


def blocks(page: Path) -> list[str]:
    return BLOCK.findall(page.read_text(encoding="utf-8"))


PAGES = [
    page
    for page in sorted((*REPOSITORY.glob("*.md"), *REPOSITORY.glob("docs/**/*.md")))
    if blocks(page) and page.name != GENERATED
]


def test_the_pages_with_code_are_known() -> None:
    recipes = ["export.md", "own_objective.md", "pandas.md"]
    assert [page.name for page in PAGES] == [
        "README.md",
        "distributed.md",
        "hardware.md",
        "python.md",
        *recipes,
    ]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_code_runs_from_its_first_block_to_the_last(
    page: Path, known: Precomputed, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if page.name in NOT_RUN:
        assert all(NOT_RUN[page.name] in block for block in blocks(page))
        for block in blocks(page):
            compile(block, page.name, "exec")
        return
    assert known.postures, "worked out before, so that no search has to"
    monkeypatch.chdir(tmp_path)
    if page.name != "README.md":  # which begins with a search
        golden = REPOSITORY / "tests" / "golden" / "lifting" / "format-2"
        shutil.copytree(golden, tmp_path / "runs" / "first")
    code = "\n".join(blocks(page))
    for budget, small in SMALLER.items():
        code = re.sub(budget, small, code)
    assert not re.search(r"\d{3}", re.sub(r"#.*", "", code)), "every budget has a smaller one here"
    exec(compile(code, page.name, "exec"), {"__name__": "__main__"})
    assert len(evodesign.open_run("runs/first")) > 0
