"""Files that are there whole or not at all: written beside their place and renamed, or removed on failure."""

from __future__ import annotations

import os
import secrets
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO

__all__ = ["replacing", "write_folder", "write_whole"]


@contextmanager
def replacing(path: Path, part: str = "") -> Iterator[BinaryIO]:
    """A file to be written that takes the place of another at the end, when all of it is on the disk.

    Args:
        path: of the file. A link is followed; a device or a pipe is written to directly.
        part: name of the unfinished file in the same folder; left out, one that nobody else uses.
    Raises:
        OSError: it cannot be written; what was at the place before is still there.
    """
    path = path.resolve()
    if path.exists() and not path.is_file():
        with path.open("wb") as file:
            yield file
        return
    unfinished = path.with_name(part or f".evodesign-{secrets.token_hex(8)}.part")
    try:
        with unfinished.open("wb" if part else "xb") as file:
            if path.exists():
                shutil.copymode(path, unfinished)
            yield file
            file.flush()
            os.fsync(file.fileno())
        unfinished.replace(path)
    except BaseException:
        unfinished.unlink(missing_ok=True)
        raise


def write_whole(path: Path, content: bytes) -> None:
    """Write a file; see `replacing`."""
    with replacing(path) as file:
        file.write(content)


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
