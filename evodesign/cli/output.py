"""Where text goes, and how numbers and names are written."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import msgspec
from rich.console import Console
from rich.markup import escape

from evodesign.errors import InputError
from evodesign.records import Objective

__all__ = [
    "console",
    "figure",
    "heading",
    "print_json",
    "print_lines",
    "show_notes",
    "shown",
    "visible",
    "write_text",
]

PLAIN_WIDTH = 110
"""Columns of a table that is not shown on a terminal."""


def console(*, stderr: bool = False) -> Console:
    """A console on standard output or error; tables keep their width when piped."""
    stream = sys.stderr if stderr else sys.stdout
    return Console(file=stream, width=None if stream.isatty() else PLAIN_WIDTH)


def figure(value: float | None) -> str:
    """A number with four significant figures, or a dash for none."""
    return "-" if value is None else f"{value:.4g}"


def visible(text: str) -> str:
    """Text with control characters as their escapes: names in a user's file may hold them."""
    return "".join(letter if letter.isprintable() else repr(letter)[1:-1] for letter in text)


def shown(name: str) -> str:
    """A name from a user's file as rich's markup that shows it as it stands."""
    return escape(visible(name))


def heading(objective: Objective) -> str:
    """A column's heading: name, sense and unit."""
    arrow = "↓" if objective.sense == "minimise" else "↑"
    return f"{objective.name} [{objective.unit}] {arrow}"


def print_lines(*lines: str, stderr: bool = False) -> None:
    """Lines of text on standard output or error, as they stand."""
    for line in lines:
        console(stderr=stderr).print(line, highlight=False, markup=False, soft_wrap=True)


def print_json(value: Any) -> None:
    """One JSON document on standard output."""
    sys.stdout.write(msgspec.json.format(msgspec.json.encode(value), indent=2).decode() + "\n")


def show_notes(sentences: Iterable[str]) -> None:
    """Remarks on standard error, one line each."""
    print_lines(*(f"note: {sentence}" for sentence in sentences), stderr=True)


def write_text(path: Path, text: str, option: str) -> None:
    """Write the file that an option names.

    Raises:
        InputError: it cannot be written.
    """
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise InputError(option, "", "a file that can be written", f"'{path}' ({error.strerror})") from error
