"""`watch` in the terminal: the log's numbers, and an end when the search ends."""

from __future__ import annotations

import json
import threading
from pathlib import Path

import msgspec
import pytest

from evodesign.analysis.front import front
from evodesign.cli.tables.live import sparkline
from evodesign.cli.watch import watch
from evodesign.errors import RunError
from evodesign.runlog.writer import RunWriter
from tests.runlog.toys import toy_evaluations, toy_generation, toy_header

HEADER = toy_header(budget=12)
RUN = toy_evaluations(HEADER, 12)


def look(run: Path, *, once: bool = False, json: bool = False) -> None:
    watch(run, every=0.01, serve=False, port=0, once=once, json=json)


def test_screen_shows_the_log_s_numbers(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    header = msgspec.structs.replace(HEADER, problem_name="<script>[red]")
    with RunWriter(tmp_path, header) as writer:
        for evaluation in RUN[:8]:
            writer.write(evaluation)
        writer.write(toy_generation(1, 8))
    look(tmp_path, once=True)
    shown = capsys.readouterr().out
    best = front(HEADER.objectives, RUN[:8])
    assert "<script>[red]" in shown
    assert "8 of 12 evaluations, stopped; go on with: evodesign resume" in shown
    assert f"{min(each.assessment.objectives['robot_torque'] for each in best):.4g}" in shown
    look(tmp_path, json=True)
    assert json.loads(capsys.readouterr().out)["front_size"] == len(best)


def test_watcher_goes_on_while_the_search_writes_and_ends_with_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with RunWriter(tmp_path, HEADER) as writer:
        watcher = threading.Thread(target=look, args=(tmp_path,))
        watcher.start()
        for number in range(3):
            for evaluation in RUN[4 * number : 4 * number + 4]:
                writer.write(evaluation)
            writer.write(toy_generation(number, 4 * number + 4))
        watcher.join(timeout=60)
        assert not watcher.is_alive()
    lines = capsys.readouterr().out.splitlines()
    assert [line.split(",")[0] for line in lines][:2] == [
        "generation 0: 4/12 evaluations",
        "generation 1: 8/12 evaluations",
    ]


def test_empty_run_has_a_screen(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    RunWriter(tmp_path, HEADER).close()
    look(tmp_path, once=True)
    assert "0 of 12 evaluations" in capsys.readouterr().out


def test_what_is_no_run_is_refused(tmp_path: Path) -> None:
    with pytest.raises(RunError, match="there is no such run directory"):
        look(tmp_path / "none", once=True)
    (tmp_path / "000.mcap").write_bytes(b"")
    with pytest.raises(RunError, match="no header yet"):
        look(tmp_path, once=True)


def test_sparklines_rise_from_the_least_to_the_greatest() -> None:
    assert sparkline([1.0, 2.0, 3.0]) == "▁▅█"
    assert sparkline([]) == ""
    assert sparkline([2.0, 2.0]) == "▁▁"
    assert sparkline([0.5], (0.0, 1.0)) == "▅"
    assert len(sparkline([float(number) for number in range(1000)])) == 30
    assert sparkline([float(number) for number in range(1000)])[-1] == "█"
