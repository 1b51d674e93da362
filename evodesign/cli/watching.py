"""`watch`: a search that is being written, followed in the terminal or on a local page."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from pathlib import Path

from rich.live import Live

from evodesign.cli.output import console, print_json, show_notes
from evodesign.cli.tables.live import generation_line, screen
from evodesign.report.live.followed_run import FollowedRun
from evodesign.report.live.server import LiveServer
from evodesign.report.live.state import state_of

__all__ = ["watch"]


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
    run = FollowedRun(directory)
    live_state = run.look()
    show_notes(run.notes)
    if json:
        print_json(state_of(live_state, ended=run.ended, now=time.time()))
    elif once:
        console().print(screen(directory, live_state, ended=run.ended, now=time.time()))
    else:
        _until_ctrl_c(_follow(run, every=every, serve=serve, port=port))


def _follow(run: FollowedRun, *, every: float, serve: bool, port: int) -> Callable[[], None]:
    if serve:
        return lambda: _serve(run, port)
    if sys.stdout.isatty():
        return lambda: _on_terminal(run, every)
    return lambda: _in_lines(run, every)


def _until_ctrl_c(work: Callable[[], None]) -> None:
    """Run until the work ends or the user leaves; the search is another process and goes on."""
    try:
        work()
    except KeyboardInterrupt:
        return


def _serve(run: FollowedRun, port: int) -> None:
    with LiveServer(port, run.state) as server:
        show_notes([f"{run.directory} at {server.url}, on this machine only; Ctrl-C ends it"])
        server.serve_forever()


def _on_terminal(run: FollowedRun, every: float) -> None:
    """Redraw the screen until the budget is used up; a stopped search may be resumed meanwhile."""
    out = console()
    with Live(console=out, auto_refresh=False) as live:
        while True:
            live_state = run.look()
            live.update(screen(run.directory, live_state, ended=run.ended, now=time.time()), refresh=True)
            if live_state.done >= live_state.header.budget:
                return
            time.sleep(every)


def _in_lines(run: FollowedRun, every: float) -> None:
    """One line per generation until the session ends."""
    told = 0
    while True:
        ended = run.ended
        live_state = run.look()
        for generation in live_state.generations[told:]:
            sys.stdout.write(generation_line(live_state, generation) + "\n")
        sys.stdout.flush()
        told = len(live_state.generations)
        if ended or live_state.done >= live_state.header.budget:
            return
        time.sleep(every)
