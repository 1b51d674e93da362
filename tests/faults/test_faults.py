"""The fault campaign in short; `make faults` runs it in full."""

from __future__ import annotations

from pathlib import Path

from tests.faults.damage import cut, flip, write_log
from tests.faults.kills import Size, kill_processes, kill_workers


def test_a_killed_search_loses_nothing_reported_and_goes_on_as_if_never_killed(tmp_path: Path) -> None:
    tally = kill_processes(tmp_path, 4, Size(160, 0.01, 2), seed=3, longest=0.5)
    assert tally.kills == 4
    assert max(tally.known_at_kill[:-1]) > 0, "at least one kill came in the middle"


def test_a_killed_worker_changes_nothing(tmp_path: Path) -> None:
    assert kill_workers(tmp_path, 2, Size(160, 0.01, 2), seed=3).kills == 2


def test_a_log_cut_anywhere_gives_what_stood_before(tmp_path: Path) -> None:
    content = write_log(tmp_path, 48)
    assert cut(tmp_path, content, range(0, len(content), 211)).most_lost == 48
    tail = range(len(content) - 3000, len(content), 7)
    assert cut(tmp_path, content, tail).logs == len(tail)


def test_a_changed_byte_costs_one_evaluation_at_most_and_is_noticed(tmp_path: Path) -> None:
    content = write_log(tmp_path, 48)
    report = flip(tmp_path, content, 120, seed=7)
    assert 0 < report.unharmed < report.logs
