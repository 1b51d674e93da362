"""The file of a segment, read in bounded parts.

Whoever hands over a run decides what lies in its directory: only regular files are opened, never a pipe, a
device or a link out of the directory, and none is loaded whole. What is read is as long as the file was when
it was opened; nothing longer than `LARGEST_CHUNK` is ever held at once.
"""

from __future__ import annotations

import os
import stat
import struct
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Final

from evodesign.errors import RunError

LARGEST_RECORD: Final = 8 * 2**20
"""Longest JSON [byte] of one record that is written or believed; a header with its files is the largest."""

LARGEST_CHUNK: Final = 2 * LARGEST_RECORD
"""Longest chunk [byte] that is read or unpacked: a record, and what is written together with it."""

WINDOW: Final = 2**20
"""Bytes that are read at once."""

PREFIX: Final = struct.Struct("<BQ")
"""Before each record of an MCAP file: its kind and its length."""

KINDS: Final = {
    stat.S_IFLNK: "a symbolic link",
    stat.S_IFDIR: "a directory",
    stat.S_IFIFO: "a named pipe",
    stat.S_IFSOCK: "a socket",
}


@contextmanager
def opened(path: Path) -> Iterator[SegmentFile]:
    """A segment's file, opened for reading.

    Raises:
        RunError: it is no regular file, or cannot be opened; inside, that it cannot be read.
    """
    try:
        _refuse_other(path, path.lstat().st_mode)
        descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_NOFOLLOW | os.O_CLOEXEC)
        try:
            _refuse_other(path, os.fstat(descriptor).st_mode)  # it may be another one by now
            yield SegmentFile(descriptor)
        finally:
            os.close(descriptor)
    except OSError as error:
        raise RunError(f"{path}: cannot be read: {error.strerror}") from error


def _refuse_other(path: Path, mode: int) -> None:
    kind = stat.S_IFMT(mode)
    if kind != stat.S_IFREG:
        raise RunError(f"{path}: wanted a file, found {KINDS.get(kind, 'a device')}; take it out of the run")


class SegmentFile:
    """Random access to the records of a file.

    Args:
        descriptor: of the file; its owner closes it.
    Raises:
        OSError: from every method, if the file cannot be read.
    """

    def __init__(self, descriptor: int) -> None:
        self._descriptor = descriptor
        self.size = os.fstat(descriptor).st_size
        self._start = 0
        self._window = b""

    def read(self, place: int, length: int) -> bytes:
        """So many bytes from a place on, or fewer at the end."""
        length = min(length, self.size - place)
        parts = []
        while length > 0 and (part := os.pread(self._descriptor, length, place)):
            parts.append(part)
            place, length = place + len(part), length - len(part)
        return b"".join(parts)

    def record(self, place: int) -> tuple[int, int, bytes] | None:
        """Kind, end and body of the record at a place; None if it is not all there, or longer than any."""
        at = place - self._start
        if at < 0 or at + PREFIX.size > len(self._window):
            if not self._fill(place, PREFIX.size):
                return None
            at = 0
        kind, length = PREFIX.unpack_from(self._window, at)
        if length > LARGEST_CHUNK:
            return None
        end = at + PREFIX.size + length
        if end > len(self._window):
            if not self._fill(place, PREFIX.size + length):
                return None
            at, end = 0, PREFIX.size + length
        return kind, self._start + end, self._window[at + PREFIX.size : end]

    def beyond_any(self, place: int) -> bool:
        """Whether a record stands at a place that declares more than any has."""
        start = self.read(place, PREFIX.size)
        return len(start) == PREFIX.size and PREFIX.unpack(start)[1] > LARGEST_CHUNK

    def _fill(self, place: int, least: int) -> bool:
        """Move the window to a place; whether so many bytes are there."""
        if place + least > self.size:
            return False
        self._start, self._window = place, self.read(place, max(least, WINDOW))
        return len(self._window) >= least

    def checksum(self, start: int, end: int) -> int:
        """CRC-32 of the bytes from start to end (not included)."""
        found = 0
        for place in range(start, end, WINDOW):
            found = zlib.crc32(self.read(place, min(WINDOW, end - place)), found)
        return found
