"""`watch`: a search that is being written, followed in the terminal or on a local page."""

from __future__ import annotations

import sys
import time
from contextlib import suppress
from typing import TYPE_CHECKING, Annotated

import typer

from evodesign.cli.options import RunPath

if TYPE_CHECKING:
    from evodesign.report.live.state import FollowedRun


def watch(
    run: RunPath,
    serve: Annotated[
        bool, typer.Option("--serve", help="On a local page that refreshes itself, for this machine alone.")
    ] = False,
    port: Annotated[
        int, typer.Option(min=0, max=65535, metavar="PORT", help="Of the page; 0 for any free one.")
    ] = 8765,
    every: Annotated[float, typer.Option(min=0.1, metavar="S", help="Seconds between two looks.")] = 1.0,
    once: Annotated[bool, typer.Option("--once", help="Show the present state and leave.")] = False,
    json: Annotated[bool, typer.Option("--json", help="Print the present state as JSON and leave.")] = False,
) -> None:
    """Follow a running search; Ctrl-C leaves, and the search goes on."""
    from evodesign.cli.output import console, print_json, show_notes
    from evodesign.cli.tables.live import screen
    from evodesign.report.live.state import FollowedRun

    followed = FollowedRun(run)
    live_state = followed.look()
    show_notes(followed.notes)
    if json:
        print_json(followed.state())
    elif once:
        console().print(screen(run, live_state, ended=followed.ended, now=time.time()))
    else:
        with suppress(KeyboardInterrupt):  # the search is another process and goes on
            if serve:
                _serve(followed, port)
            elif sys.stdout.isatty():
                _on_terminal(followed, every)
            else:
                _in_lines(followed, every)


def _serve(run: FollowedRun, port: int) -> None:
    import msgspec

    from evodesign.cli.output import show_notes
    from evodesign.report.live.server import LiveServer

    with LiveServer(port, lambda: msgspec.json.encode(run.state())) as server:
        show_notes([f"{run.directory} at {server.url}, on this machine only; Ctrl-C ends it"])
        server.serve_forever()


def _on_terminal(run: FollowedRun, every: float) -> None:
    """Redraw the screen until the budget is used up; a stopped search may be resumed meanwhile."""
    from rich.live import Live

    from evodesign.cli.output import console
    from evodesign.cli.tables.live import screen

    with Live(console=console(), auto_refresh=False) as live:
        while True:
            state = run.look()
            live.update(screen(run.directory, state, ended=run.ended, now=time.time()), refresh=True)
            if state.done >= state.header.budget:
                return
            time.sleep(every)


def _in_lines(run: FollowedRun, every: float) -> None:
    """One line per generation until the session ends."""
    from evodesign.api.progress_lines import generation_line

    told = 0
    while True:
        ended = run.ended
        state = run.look()
        for generation in state.generations[told:]:
            sys.stdout.write(generation_line(generation, state.header.budget) + "\n")
        sys.stdout.flush()
        told = len(state.generations)
        if ended or state.done >= state.header.budget:
            return
        time.sleep(every)
