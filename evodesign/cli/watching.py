"""`watch`: a search that is being written, followed in the terminal or on a local page."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

import msgspec
from rich.live import Live

from evodesign.analysis.live_state import LiveRun, LiveState
from evodesign.cli.output import console, print_json, show_notes
from evodesign.cli.tables.live import generation_line, screen
from evodesign.errors import RunError
from evodesign.report.live.server import LiveServer
from evodesign.report.live.state import state_of
from evodesign.runlog.follow import Follower

__all__ = ["watch"]


class Watcher:
    """A run that is looked at again and again.

    Args:
        directory: of the run.
    """

    def __init__(self, directory: Path) -> None:
        self.directory = directory
        self._follower = Follower(directory)
        self._watched = LiveRun()
        self._lock = threading.Lock()

    def look(self) -> LiveState:
        """Where the search stands now.

        Raises:
            RunError: the log's header cannot be read.
        """
        with self._lock:
            self._watched.learn([(logged.record, logged.time) for logged in self._follower.look()])
        live_state = self._watched.state
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

    def state(self) -> bytes:
        """The state as JSON, for the page."""
        return msgspec.json.encode(state_of(self.look(), ended=self.ended, now=time.time()))


def watch(directory: Path, *, every: float, serve: bool, port: int, once: bool, json: bool) -> None:
    """Follow a run until it ends; Ctrl-C leaves it alone.

    Args:
        directory: of the run.
        every: seconds between two looks.
        serve: on a local page instead of the terminal.
        port: of the page; 0 for any free one.
        once: show the present state and leave.
        json: the present state as JSON.
    """
    watcher = Watcher(directory)
    live_state = watcher.look()
    show_notes(watcher.notes)
    if json:
        print_json(state_of(live_state, ended=watcher.ended, now=time.time()))
    elif once:
        console().print(screen(directory, live_state, ended=watcher.ended, now=time.time()))
    else:
        _until_ctrl_c(_follow(watcher, every=every, serve=serve, port=port))


def _follow(watcher: Watcher, *, every: float, serve: bool, port: int) -> Callable[[], None]:
    if serve:
        return lambda: _serve(watcher, port)
    if sys.stdout.isatty():
        return lambda: _on_terminal(watcher, every)
    return lambda: _in_lines(watcher, every)


def _until_ctrl_c(work: Callable[[], None]) -> None:
    """Run until the work ends or the user leaves; the search is another process and goes on."""
    try:
        work()
    except KeyboardInterrupt:
        return


def _serve(watcher: Watcher, port: int) -> None:
    with LiveServer(port, watcher.state) as server:
        show_notes([f"{watcher.directory} at {server.url}, on this machine only; Ctrl-C ends it"])
        server.serve_forever()


def _on_terminal(watcher: Watcher, every: float) -> None:
    """Redraw the screen until the budget is used up; a stopped search may be resumed meanwhile."""
    out = console()
    with Live(console=out, auto_refresh=False) as live:
        while True:
            live_state = watcher.look()
            live.update(
                screen(watcher.directory, live_state, ended=watcher.ended, now=time.time()), refresh=True
            )
            if live_state.done >= live_state.header.budget:
                return
            time.sleep(every)


def _in_lines(watcher: Watcher, every: float) -> None:
    """One line per generation until the session ends."""
    told = 0
    while True:
        ended = watcher.ended
        live_state = watcher.look()
        for generation in live_state.generations[told:]:
            sys.stdout.write(generation_line(live_state, generation) + "\n")
        sys.stdout.flush()
        told = len(live_state.generations)
        if ended or live_state.done >= live_state.header.budget:
            return
        time.sleep(every)
