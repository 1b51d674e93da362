"""Where text goes, and how numbers and names are written."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from json import dumps
from pathlib import Path
from textwrap import wrap
from typing import Any

import msgspec
from rich.console import Console, ConsoleOptions
from rich.markup import escape
from rich.text import Text

from evodesign.errors import InputError
from evodesign.files import write_whole
from evodesign.records import Objective

PLAIN_WIDTH = 110
"""Columns of a table that is not shown on a terminal."""


def console(*, stderr: bool = False) -> Console:
    """A console on standard output or error, as wide as the terminal; tables keep their width when piped."""
    stream = sys.stderr if stderr else sys.stdout
    return Console(file=stream, width=None if stream.isatty() else PLAIN_WIDTH)


def rounded(value: float | None) -> str:
    """A number with four significant figures, or a dash for none."""
    return "-" if value is None else f"{value:.4g}"


def interval(lowest: float | None, highest: float | None, *, or_lower: bool) -> str:
    """The interval of heights within reach; `or_lower` where nobody asked for lower ones."""
    return f"{rounded(lowest)}{' or lower' if or_lower else ''} to {rounded(highest)}"


def printable(text: str) -> str:
    """Text with control characters as their escapes: names in a user's file may hold them."""
    return "".join(letter if letter.isprintable() else repr(letter)[1:-1] for letter in text)


def markup(name: str) -> str:
    """A name from a user's file as rich's markup that shows it as it stands."""
    return escape(printable(name))


def heading(objective: Objective) -> str:
    """A column's heading: name, sense and unit."""
    arrow = "↓" if objective.sense == "minimise" else "↑"
    return f"{objective.name} [{objective.unit}] {arrow}"


@dataclass(frozen=True, slots=True)
class WrappedLine:
    """A line of text that goes on below at a space where the terminal ends; a longer word stays whole."""

    line: str

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> Iterator[Text]:
        """The lines that it takes."""
        lines = wrap(self.line, options.max_width, break_long_words=False, break_on_hyphens=False)
        for line in lines or [""]:
            yield Text(line, no_wrap=True, overflow="ignore")


def print_lines(*lines: str, stderr: bool = False) -> None:
    """Lines of text on standard output or error: wrapped on a terminal, as they stand elsewhere."""
    out = console(stderr=stderr)
    for line in lines:
        part = WrappedLine(line) if out.is_terminal else line
        out.print(part, highlight=False, markup=False, soft_wrap=not out.is_terminal, crop=False)


def print_commands(*commands: str) -> None:
    """Commands to go on with on standard output, each whole in a line, so that it can be copied."""
    for command in commands:
        console().print(f"  {command}", highlight=False, markup=False, soft_wrap=True)


def print_json(value: Any) -> None:
    """One JSON document on standard output; in ASCII where its encoding may lack characters."""
    text = msgspec.json.format(msgspec.json.encode(value), indent=2).decode()
    if console().options.ascii_only:
        text = "".join(letter if letter.isascii() else dumps(letter)[1:-1] for letter in text)
    sys.stdout.write(text + "\n")


def show_notes(sentences: Iterable[str]) -> None:
    """Remarks on standard error, one line each."""
    print_lines(*(f"note: {sentence}" for sentence in sentences), stderr=True)


def write_text(path: Path, text: str, option: str, *, follow: bool = True) -> None:
    """Write the file that an option names, or would name; `follow` as in `files.replacing`.

    Raises:
        InputError: it cannot be written.
    """
    write_bytes(path, text.encode(), option, follow=follow)


def write_bytes(path: Path, content: bytes, option: str, *, follow: bool = True) -> None:
    """The same for a file that is no text."""
    try:
        write_whole(path, content, follow=follow)
    except OSError as error:
        raise InputError(option, "", "a file that can be written", f"'{path}' ({error.strerror})") from error
