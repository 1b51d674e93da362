"""Comma-separated values that a spreadsheet shows as they stand.

A spreadsheet takes text that begins with one of `= + - @` for a formula, which may start programs, and drops
tabs and line ends before it. Such text gets an apostrophe before it, as does text that begins with one: who
reads the file removes one leading apostrophe. Numbers stay as they are.

Source: OWASP, CSV injection.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Sequence

FORMULA = tuple("=+-@\t\r\n'＝＋－＠")  # noqa: RUF001 - full-width signs begin a formula too


def csv_text(rows: Iterable[Sequence[str | float | None]]) -> str:
    """Rows as lines; numbers with as many digits as read back to the same double."""
    return "".join(f"{_line(row)}\n" for row in rows)


def _line(row: Sequence[str | float | None]) -> str:
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\r\n")  # with both ends, cells that hold either are quoted
    writer.writerow([_shown(cell) for cell in row])
    return stream.getvalue().removesuffix("\r\n")


def _shown(cell: str | float | None) -> str | float | None:
    return f"'{cell}" if isinstance(cell, str) and cell.startswith(FORMULA) else cell
