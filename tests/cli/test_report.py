"""`report` writes one file and says where; what it cannot do it refuses in a sentence."""

from __future__ import annotations

from pathlib import Path

import pytest

from evodesign.cli.report import report
from evodesign.errors import InputError, RunError
from evodesign.runlog.writer import RunWriter
from tests.runlog.toys import toy_evaluations, toy_header


@pytest.fixture
def run(tmp_path: Path) -> Path:
    with RunWriter(tmp_path / "run", toy_header()) as log:
        for evaluation in toy_evaluations(toy_header(), 12):
            log.write(evaluation)
    return tmp_path / "run"


def test_page_lies_in_the_run_unless_told_otherwise(run: Path, capsys: pytest.CaptureFixture[str]) -> None:
    report(run, None, "")
    shown = capsys.readouterr()
    assert shown.out.startswith(f"{run / 'report.html'} (")
    assert "no robot is drawn" in shown.err
    report(run, run / "other.html", "3, 5,3")
    assert (run / "other.html").read_text(encoding="utf-8").startswith("<!doctype html>")


@pytest.mark.parametrize(
    ("designs", "found"), [("3,x", "'x'"), ("99", "99"), ("-1", "'-1'"), ("1.5", "'1.5'")]
)
def test_designs_that_are_none_are_refused(run: Path, designs: str, found: str) -> None:
    with pytest.raises(InputError, match="--designs") as refused:
        report(run, None, designs)
    assert found in str(refused.value)
    assert not (run / "report.html").exists()


def test_place_that_cannot_be_written_is_named(run: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="--output"):
        report(run, tmp_path / "missing" / "page.html", "")


def test_directory_without_a_run_is_refused(tmp_path: Path) -> None:
    with pytest.raises(RunError, match="is not a run"):
        report(tmp_path, None, "")
