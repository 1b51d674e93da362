"""Files that are there whole or not at all: written beside their place and renamed, or removed on failure.

What a kill leaves of a file that was being written has a name of its own and is locked by nobody; the next
file that is written in the same folder removes it.
"""

from __future__ import annotations

import fcntl
import os
import re
import secrets
import shutil
import stat
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO, Final

from evodesign.errors import InputError

UNFINISHED: Final = re.compile(r"\.evodesign-[0-9a-f]{16}\.part")
"""Names of files that are being written, or were when their process was killed."""


def is_there(path: Path) -> bool:
    """Whether there is something; under a name that is too long for a file, or holds a zero, there is not."""
    try:
        return path.exists()
    except (OSError, ValueError):
        return False


@contextmanager
def replacing(path: Path, part: str = "", *, follow: bool = True) -> Iterator[BinaryIO]:
    """A file to be written that takes the place of another at the end, when all of it is on the disk.

    Args:
        path: of the file.
        part: name of the unfinished file in the same folder; left out, one that nobody else uses.
        follow: whether a link is followed, and a device or a pipe written to directly; otherwise they are
            replaced, as is right where others may have put them there.
    Raises:
        OSError: it cannot be written; what was at the place before is still there.
    """
    path = path.resolve() if follow else path.parent.resolve() / path.name
    if follow and path.exists() and not path.is_file():
        with path.open("wb") as direct:
            yield direct
        return
    _remove_abandoned(path.parent)
    unfinished, file = (path.with_name(part), begun(path, part)) if part else _locked_file(path.parent)
    try:
        with file:
            if path.is_file() and not path.is_symlink():
                shutil.copymode(path, unfinished)
            yield file
            file.flush()
            os.fsync(file.fileno())
            unfinished.replace(path)  # while it is locked: nobody takes it for an abandoned one
    except BaseException:
        unfinished.unlink(missing_ok=True)
        raise


def begun(path: Path, part: str) -> BinaryIO:
    """A new file of a name beside another, in the place of whatever has this name."""
    unfinished = path.with_name(part)
    unfinished.unlink(missing_ok=True)  # not written over: a link would lead elsewhere
    return unfinished.open("xb")


def _locked_file(folder: Path) -> tuple[Path, BinaryIO]:
    """A new file of a name that nobody else uses, locked as long as it is open."""
    while True:
        unfinished = folder / f".evodesign-{secrets.token_hex(8)}.part"
        file = unfinished.open("xb")
        if _locks(file.fileno()) is not False and os.fstat(file.fileno()).st_nlink:
            return unfinished, file
        file.close()  # another process took it for an abandoned one before it was locked
        unfinished.unlink(missing_ok=True)


def _locks(descriptor: int) -> bool | None:
    """Whether this process holds a file now, against all others; None where files cannot be locked."""
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:
        return None
    return True


def _remove_abandoned(folder: Path) -> None:
    """Remove what killed processes left of files in a folder, as far as one may."""
    with suppress(OSError):
        for name in filter(UNFINISHED.fullmatch, os.listdir(folder)):  # noqa: PTH208 - other names stay text
            with suppress(OSError):
                _remove_if_abandoned(folder / name)


def _remove_if_abandoned(path: Path) -> None:
    descriptor = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC)
    try:
        if stat.S_ISREG(os.fstat(descriptor).st_mode) and _locks(descriptor):
            path.unlink()
    finally:
        os.close(descriptor)


def write_whole(path: Path, content: bytes, *, follow: bool = True) -> None:
    """Write a file; see `replacing`."""
    with replacing(path, follow=follow) as file:
        file.write(content)


def make_folder(directory: Path, source: str) -> None:
    """Make a folder that is missing, with those above it.

    Args:
        directory: the folder.
        source: who names it, such as `--plot`, for messages.
    Raises:
        InputError: it cannot be made.
    """
    try:
        directory.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        found = f"'{directory}' ({error.strerror})"
        raise InputError(source, "", "a folder that can be written", found) from error


def write_folder(directory: Path, contents: Mapping[str, bytes], *, new: bool = False) -> None:
    """Write all files of a folder, or none of them.

    Args:
        directory: made when missing, with those above it.
        contents: by path in the directory.
        new: whether the directory must not be there before.
    Raises:
        OSError: a file cannot be written, or the directory is there; what had been written is removed.
    """
    paths = [directory / name for name in contents]
    missing = {place for path in paths for place in path.parents if not place.exists()}
    written = []
    try:
        directory.mkdir(parents=True, exist_ok=not new)
        for path, content in zip(paths, contents.values(), strict=True):
            path.parent.mkdir(parents=True, exist_ok=True)
            write_whole(path, content)
            written.append(path)
    except BaseException:
        for path in written:
            path.unlink(missing_ok=True)
        for place in sorted(missing, key=lambda place: len(place.parts), reverse=True):
            with suppress(OSError):
                place.rmdir()
        raise
