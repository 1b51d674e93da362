"""Progress of what is made ready before a first evaluation: a bar on a terminal, plain lines elsewhere."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TextIO

from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from evodesign.cli.output import console, show_notes
from evodesign.problem.progress import PrecomputeProgress

__all__ = ["making"]


class Making(PrecomputeProgress):
    """Progress that is shown on standard error until it is closed."""

    def note(self, sentence: str) -> None:
        """Say it."""
        show_notes([sentence])

    def close(self) -> None:
        """Give the terminal back."""


@contextmanager
def making() -> Iterator[PrecomputeProgress]:
    """The watcher that suits standard error; it shows nothing until something is missing."""
    watcher: Making = Bar() if sys.stderr.isatty() else Lines(sys.stderr)
    try:
        yield watcher
    finally:
        watcher.close()


class Lines(Making):
    """One line for each piece."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream
        self._began = time.monotonic()
        self._pieces = self._done = 0

    def missing(self, pieces: int) -> None:
        """Say what begins."""
        if not self._pieces:
            self._write("making the problem ready, once; the next time it is read from the cache")
        self._pieces += pieces

    def done(self, piece: str) -> None:
        """Say what is done."""
        self._done += 1
        seconds = time.monotonic() - self._began
        self._write(f"ready {self._done}/{self._pieces}: {piece} ({seconds:.0f} s)")

    def _write(self, line: str) -> None:
        self._stream.write(line + "\n")
        self._stream.flush()


class Bar(Making):
    """A bar over all pieces, with the one that was done last."""

    def __init__(self) -> None:
        self._progress = Progress(
            TextColumn("[bold]making ready, once"),
            BarColumn(),
            MofNCompleteColumn(),
            TimeElapsedColumn(),
            TextColumn("{task.description}"),
            console=console(stderr=True),
        )
        self._task = self._progress.add_task("", total=0)
        self._pieces = 0

    def missing(self, pieces: int) -> None:
        """Draw the bar, longer by so many pieces."""
        self._pieces += pieces
        self._progress.update(self._task, total=self._pieces)
        self._progress.start()

    def done(self, piece: str) -> None:
        """Move the bar."""
        self._progress.update(self._task, advance=1, description=piece)

    def close(self) -> None:
        """Give the terminal back."""
        self._progress.stop()
