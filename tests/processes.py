"""Processes that a test waits for."""

from __future__ import annotations

import time
from collections.abc import Iterable
from pathlib import Path

PATIENCE = 50.0
"""Longest wait [s] for a process to end; those that nobody ends sleep for a minute or more."""


def is_alive(pid: int | None) -> bool:
    """Whether a process runs (a zombie does not)."""
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
    except (FileNotFoundError, ProcessLookupError):
        return False
    return state != "Z"


def wait_until_all_end(pids: Iterable[int | None]) -> None:
    """Return when none of them runs any more."""
    end = time.monotonic() + PATIENCE
    while still := [pid for pid in pids if is_alive(pid)]:
        assert time.monotonic() < end, f"{still} still run"
        time.sleep(0.02)
