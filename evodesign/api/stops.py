"""When a session ends before its budget is used up."""

from __future__ import annotations

import signal
import threading
import time
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from types import FrameType
from typing import Protocol

SECONDS_PER_HOUR = 3600.0


class Stop(Protocol):
    """Asked by the loop whether a session is to stop."""

    @property
    def why(self) -> str:
        """What used up the session, as a clause; empty when a person stopped it."""

    def __call__(self) -> bool:
        """Whether no further evaluation is to begin."""

    def heeded(self) -> AbstractContextManager[None]:
        """Within this, the loop asks."""


class Deadline:
    """A stop at the end of a session's wall time, or after an interrupt.

    Args:
        hours: from now on; None for no end.
    """

    def __init__(self, hours: float | None) -> None:
        self._hours = hours
        self._end = None if hours is None else time.monotonic() + hours * SECONDS_PER_HOUR
        self._interrupted = False

    def __call__(self) -> bool:
        """Whether no further evaluation is to begin."""
        return self._interrupted or self.over

    @property
    def over(self) -> bool:
        """Whether the time is over."""
        return self._end is not None and time.monotonic() > self._end

    @property
    def why(self) -> str:
        """As in `Stop`."""
        return f"its wall time of {self._hours:g} h is over" if self.over else ""

    @contextmanager
    def heeded(self) -> Iterator[None]:
        """Within this, an interrupt breaks in as ever and is remembered: some libraries drop its error."""
        usual = signal.getsignal(signal.SIGINT)
        if not callable(usual) or threading.current_thread() is not threading.main_thread():
            yield
            return

        def interrupted(signum: int, frame: FrameType | None) -> None:
            self._interrupted = True
            usual(signum, frame)

        signal.signal(signal.SIGINT, interrupted)
        try:
            yield
        finally:
            signal.signal(signal.SIGINT, usual)
