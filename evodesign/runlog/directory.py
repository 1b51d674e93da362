"""A run's directory: its segments `000.mcap`, `001.mcap`, ... and the lock of the process that writes.

The lock is the operating system's (`flock` on the file `lock`): it ends with its process, however that
ends, so a crash leaves none behind.
"""

from __future__ import annotations

import fcntl
import os
import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from evodesign.errors import RunError

LOCK = "lock"
SEGMENT = re.compile(r"([0-9]{3}|[1-9][0-9]{3,8})\.mcap")

LONGEST_NAME = 50
"""Letters of a name that go into a path, whose parts may have 255 bytes."""


def name_in_path(name: str) -> str:
    """A name as part of a file name: what is not a letter, digit, `-`, `_` or inner dot becomes `_`."""
    return re.sub(r"^\.|[^\w.-]", "_", name)[:LONGEST_NAME]


def segment_path(directory: Path, number: int) -> Path:
    """Where the segment of a number, counted from zero, lies."""
    return directory / f"{number:03d}.mcap"


def segments(directory: Path) -> dict[int, Path]:
    """The segments in a directory, by number, in order; none when there is no such directory.

    Raises:
        RunError: the directory cannot be read.
    """
    try:
        if not directory.is_dir():
            return {}
        found = {int(name[1]): path for path in directory.iterdir() if (name := SEGMENT.fullmatch(path.name))}
    except OSError as error:
        raise RunError(f"{directory}: cannot be read: {error.strerror}") from error
    return dict(sorted(found.items()))


def run_segments(directory: Path) -> dict[int, Path]:
    """The segments of a run, at least one.

    Raises:
        RunError: the directory is missing, is a file, or holds no run.
    """
    found = segments(directory)
    if not found and not os.path.lexists(directory):
        raise RunError(f"{directory}: there is no such run directory")
    if not found and not directory.is_dir():
        raise RunError(f"{directory}: wanted the directory of a run, found a file")
    if not found:
        raise RunError(f"{directory}: is not a run, for it holds no 000.mcap")
    return found


def make_directory(directory: Path) -> None:
    """Make a directory, and those above it, where they are missing.

    Raises:
        RunError: a file is in the way, or the place cannot be written.
    """
    try:
        directory.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise RunError(f"{directory}: cannot be made a run directory: {error.strerror}") from error


@contextmanager
def locked(directory: Path) -> Iterator[None]:
    """Hold an existing directory against every other writer.

    Raises:
        RunError: another process holds it, or it cannot be written.
    """
    try:
        flags = os.O_RDWR | os.O_CREAT | os.O_NONBLOCK | os.O_NOFOLLOW  # a lock may be any file that was sent
        file = os.fdopen(os.open(directory / LOCK, flags, 0o666), "r+b", buffering=0)
    except OSError as error:
        raise RunError(f"{directory}: cannot be locked: {error.strerror}") from error
    with file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise RunError(
                f"{directory}: another evodesign is writing this run; let it end, or stop it first"
            ) from error
        except OSError as error:
            raise RunError(f"{directory}: cannot be locked: {error.strerror}") from error
        yield


def synced(*directories: Path) -> None:
    """Make new names in directories durable: syncing a file does not sync its name."""
    for directory in directories:
        descriptor = os.open(directory, os.O_RDONLY | os.O_DIRECTORY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
