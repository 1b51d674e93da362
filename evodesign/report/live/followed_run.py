"""A run that is being written: where its search stands at each look."""

from __future__ import annotations

import threading
import time
from pathlib import Path
from typing import Any

from evodesign.errors import RunError
from evodesign.report.live.state import LiveRun, LiveState, state_of
from evodesign.runlog.follow import Follower

__all__ = ["FollowedRun"]


class FollowedRun:
    """A run that is being written, looked at again and again.

    Args:
        directory: of the run.
    """

    def __init__(self, directory: Path) -> None:
        self.directory = directory
        self._follower = Follower(directory)
        self._live_run = LiveRun()
        self._lock = threading.Lock()

    def look(self) -> LiveState:
        """Where the search stands now.

        Raises:
            RunError: the log's header cannot be read.
        """
        with self._lock:
            self._live_run.learn([(logged.record, logged.time) for logged in self._follower.look()])
        live_state = self._live_run.state
        if live_state is None:
            raise RunError(f"{self.directory}: the log has no header yet, so there is nothing to watch")
        return live_state

    @property
    def ended(self) -> bool:
        """Whether the last session closed its log."""
        return self._follower.ended

    @property
    def notes(self) -> tuple[str, ...]:
        """What cannot be read."""
        return self._follower.notes

    def state(self) -> dict[str, Any]:
        """Where the search stands now, as the JSON object of the page."""
        return state_of(self.look(), ended=self.ended, now=time.time())
