"""What is shown while a problem is made ready: how far it is."""

from __future__ import annotations

import re
from collections.abc import Iterator
from io import StringIO
from types import SimpleNamespace

import pytest
from rich.cells import cell_len
from rich.console import Console

from evodesign.api import progress_lines
from evodesign.api.progress_lines import PrecomputeLines
from evodesign.cli import progress
from evodesign.cli.progress import PrecomputeBar
from evodesign.evaluation.progress import PrecomputeProgress

PIECES = [
    "starts of the highest load",
    "starts of the lowest load",
    "starts of postures at 0.75 m, a tall person [1], a box with brush",
    "starts of postures at 0.75 m",
    "starts of postures at 1.25 m",
    "a lift",
]


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[float]]:
    """A list whose only element is the time of the lines [s]."""
    now = [100.0]
    monkeypatch.setattr(progress_lines, "time", SimpleNamespace(monotonic=lambda: now[0]))
    return now


def make_ready(shown: PrecomputeProgress, clock: list[float]) -> None:
    shown.missing(len(PIECES))
    for piece, moment in zip(PIECES, (140.0, 150.0, 152.0, 218.0, 220.0, 221.0), strict=True):
        clock[0] = moment
        shown.done(piece)


def test_lines_tell_what_is_done_and_how_long_it_took(clock: list[float]) -> None:
    stream = StringIO()
    make_ready(PrecomputeLines(stream), clock)
    head, *lines = stream.getvalue().splitlines()
    assert head == "making the problem ready, once; the next time it is read from the cache"
    assert lines[0] == "ready 1/6: starts of the highest load (40 s)"
    assert lines[5] == "ready 6/6: a lift (121 s)"


def test_a_bar_of_80_columns_shows_all_of_it(clock: list[float], monkeypatch: pytest.MonkeyPatch) -> None:
    stream = StringIO()
    terminal = Console(file=stream, width=80, force_terminal=True, color_system=None, legacy_windows=False)
    monkeypatch.setattr(progress, "console", lambda **_: terminal)
    bar = PrecomputeBar()
    make_ready(bar, clock)
    bar.close()
    shown = re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", stream.getvalue()).replace("\r", "\n")
    assert max(map(cell_len, shown.splitlines())) <= 80
    assert "…" not in shown
    lines = [line for line in shown.splitlines() if "making ready, once" in line]
    assert all(re.search(r" [0-6]/6 [0-9]:[0-9]{2}:[0-9]{2}", line) for line in lines)
    assert "starts of postures at 0.75 m, a tall person [1], a box with brush" in shown
    assert shown.rstrip().endswith("a lift")
