"""Time and memory that a case may take."""

from __future__ import annotations

import os
import resource
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType

SECONDS = 5.0
"""Processor time after which a case counts as hanging [s]; most take a hundredth of one."""

BYTES = 300_000_000
"""Memory beyond what is loaded before the first case."""


class Hanging(BaseException):
    """A case took too long; no `except Exception` stops it."""


@contextmanager
def time_limit() -> Iterator[None]:
    """Within this, so much processor time may pass."""

    def stop(number: int, frame: FrameType | None) -> None:
        raise Hanging(f"no end after {SECONDS:g} s")

    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, SECONDS)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)


def limit_memory() -> None:
    """From now on this process may take so much memory beyond what it has."""
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
    room = pages * os.sysconf("SC_PAGE_SIZE") + BYTES
    resource.setrlimit(resource.RLIMIT_AS, (room, room))
