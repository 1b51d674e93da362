"""The fuzzer says what it tried and what it found, and stops at nothing."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.fuzz import fuzzer, limits
from tests.fuzz.fuzzer import Try, main, try_cases


def test_cases_are_counted_by_kind_and_end(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--segments", "4", "--inputs", "8", "--first", "100"]) == 0
    told = capsys.readouterr().out
    assert "segments: 4 cases (" in told
    assert "inputs: 8 cases (" in told
    assert told.count(", 0 findings") == 2


def test_some_time_is_shared_among_all_targets(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--minutes", "0.02"]) == 0
    told = capsys.readouterr().out
    assert "segments from case " in told
    assert "inputs from case " in told


def faulty(folder: Path) -> Try:
    """Of four cases one fails, one hangs, one takes all memory and one ends its process."""
    faults: dict[int, Callable[[], object]] = {
        1: lambda: 1 / 0,
        2: lambda: [time.process_time() for _ in iter(int, 1)],
        3: lambda: bytes(2 * limits.BYTES),
        4: lambda: os._exit(3),
    }

    def attempt(number: int) -> str:
        faults.get(number, lambda: None)()
        return "sound"

    return attempt


def test_a_case_that_fails_hangs_takes_too_much_or_ends_its_process_is_found(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(limits, "SECONDS", 0.3)
    found = try_cases("faulty", faulty, iter(range(6)), lambda: False)
    assert found.ends == {"sound": 2, "finding": 4}
    assert sorted(found.findings) == [1, 2, 3, 4]
    assert "ZeroDivisionError" in found.findings[1]
    assert "no end after 0.3 s" in found.findings[2]
    assert "MemoryError" in found.findings[3]
    assert "its process died" in found.findings[4]
    assert "again with: python -m tests.fuzz.fuzzer --case faulty:4" in capsys.readouterr().out


def test_a_case_that_waits_for_ever_is_ended_from_outside(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fuzzer, "PATIENCE", 0.5)
    found = try_cases("waits", lambda folder: lambda number: str(time.sleep(3600)), iter([7]), lambda: False)
    assert list(found.findings) == [7]
