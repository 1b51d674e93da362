"""Standard streams to which a command can write whatever they lead to.

    closed, as by `>&-`                     goes nowhere, and no file is opened under its number
    in an encoding that lacks a character   arrows, dots and lines become their likes in ASCII, others escapes
    standard error that nobody reads        goes nowhere, and a search goes on

Standard output that nobody reads, as by `| head`, ends a command with the exit code `UNREAD`. This module
loads nothing but the standard library.
"""

from __future__ import annotations

import codecs
import io
import os
import sys
from collections.abc import Mapping
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from _typeshed import ReadableBuffer

UNREAD = 141
"""Exit code of a command whose reader has gone: 128 and the number of SIGPIPE, as shells count."""

ALIKE = "evodesign.alike"
"""Name of the error handler of the standard streams."""

ASCII: Final[Mapping[str, str]] = {
    **{chr(code): "+" for code in range(0x2500, 0x2580)},  # corners of tables
    **dict.fromkeys("─━╌╍┄┅┈┉═╴╶╸╺╼╾", "-"),
    **dict.fromkeys("│┃╎╏┆┇┊┋║╵╷╹╻╽╿├", "|"),
    **dict(zip("▁▂▃▄▅▆▇█", "_.-:=+*#", strict=True)),
    "└": "`",
    "↓": "v",
    "↑": "^",
    "●": "*",
    "…": "~",
    "±": "~",
}
"""What stands for the signs of tables and progress where an encoding lacks them; each as wide as its sign."""


def adapt_streams() -> None:
    """Make standard input, output and error what the module says; once, before anything is written."""
    _open_closed()
    codecs.register_error(ALIKE, _alike)
    sys.stdin = sys.stdin or os.fdopen(0, encoding="utf-8", closefd=False)
    sys.stdout = sys.stdout or os.fdopen(1, "w", encoding="utf-8", closefd=False)
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors=ALIKE)
    raw = _Droppable(2, "w", closefd=False)
    encoding = sys.stderr.encoding if sys.stderr else "utf-8"
    sys.stderr = io.TextIOWrapper(io.BufferedWriter(raw), encoding, errors=ALIKE, line_buffering=True)


class _Droppable(io.FileIO):
    """A file that takes everything, also what it cannot keep."""

    def write(self, data: ReadableBuffer, /) -> int:
        """Write; gives how much was taken."""
        try:
            return super().write(data)
        except OSError:
            return memoryview(data).nbytes


def _open_closed() -> None:
    """Let closed standard streams lead to nowhere: a run's log could become standard error otherwise."""
    while (number := os.open(os.devnull, os.O_RDWR)) <= 2:  # the lowest that is closed
        os.set_inheritable(number, True)
    os.close(number)


def _alike(error: UnicodeError) -> tuple[str | bytes, int]:
    """What is written for a character that an encoding lacks; bytes of a path that are no text stay."""
    if not isinstance(error, UnicodeEncodeError):
        raise error
    letter, end = error.object[error.start], error.start + 1
    if letter in ASCII:
        return ASCII[letter], end
    if "\udc80" <= letter <= "\udcff":
        return bytes([ord(letter) - 0xDC00]), end
    return letter.encode("ascii", "backslashreplace").decode("ascii"), end
