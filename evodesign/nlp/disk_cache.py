"""Bytes kept between runs, found again by a digest of everything that they were made from.

Threat model: what is kept here may be executed, so nothing is given back that a user other than this one
(and root) could have written or put in its place: directories and files must be the user's own and closed to
the writing of others, all the way up. Root and the user's own programs are trusted, but not to have finished:
a damaged file is treated as missing.

A file's name is `<key>.<digest of its content>`: name and content arrive together by one atomic replacement,
and whoever reads them can tell whether they still belong together.
"""

from __future__ import annotations

import fcntl
import hashlib
import os
import stat
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

OTHERS_WRITE = stat.S_IWGRP | stat.S_IWOTH


@dataclass(frozen=True, slots=True)
class Cache:
    """A directory of the user's own, made by `open_cache` or `user_cache`.

    A key is a digest of everything that its content depends on, so any undamaged entry of a key will do.

    Args:
        directory: resolved, and writable by this user alone.
    """

    directory: Path

    def find(self, key: str) -> Path | None:
        """The file of a key, when it is the user's own and undamaged; None otherwise."""
        found = self._entry(key)
        return found[0] if found else None

    def read(self, key: str) -> bytes | None:
        """The content of a key, when its file is the user's own and undamaged; None otherwise."""
        found = self._entry(key)
        return found[1] if found else None

    def store(self, key: str, content: bytes) -> Path:
        """Keep a content under a key; readers see all of it or nothing.

        Raises:
            OSError: the content cannot be written.
        """
        path = self.directory / f"{key}.{hashlib.sha256(content).hexdigest()}"
        descriptor, name = tempfile.mkstemp(prefix=".", dir=self.directory)  # rights 0600
        unfinished = Path(name)
        try:
            with os.fdopen(descriptor, "wb") as file:
                file.write(content)
            unfinished.replace(path)
        except BaseException:
            unfinished.unlink(missing_ok=True)
            raise
        return path

    @contextmanager
    def lock(self, key: str, *, keep: bool = True) -> Iterator[bool]:
        """Hold a key alone among processes; gives whether another process had to be waited for.

        Two processes without the lock would both succeed; it spares doing the work twice.

        Args:
            key: to hold.
            keep: whether the lock's file stays. Without it a process that waited and one that came later may
                both hold the key, which is harmless when each looks first what was stored.
        """
        flags = os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_CLOEXEC
        path = self.directory / f"{key}.lock"
        descriptor = os.open(path, flags, 0o600)
        try:
            yield _acquire(descriptor)
        finally:
            if not keep:
                path.unlink(missing_ok=True)
            os.close(descriptor)

    def _entry(self, key: str) -> tuple[Path, bytes] | None:
        for path in sorted(self.directory.glob(f"{key}.*")):
            try:
                content = _read_own(path)
            except OSError:
                continue
            if path.name == f"{key}.{hashlib.sha256(content).hexdigest()}":
                return path, content
        return None


def user_cache(subject: str, environment: Mapping[str, str]) -> Cache:
    """The user's cache for a subject, such as `functions`.

    It is a directory in $EVODESIGN_CACHE, or else in $XDG_CACHE_HOME/evodesign or ~/.cache/evodesign; where
    that is missing, read-only or open to others, in a private one among the temporary files.

    Raises:
        OSError: none of them can be used; it says why, for each.
    """
    refused = []
    for root in _roots(environment):
        try:
            return open_cache(root / subject)
        except (OSError, RuntimeError) as error:  # pathlib's word for a loop of links
            refused.append(str(error))
    raise OSError("no directory to keep files in: " + "; ".join(refused))


def open_cache(directory: Path) -> Cache:
    """The cache in a directory, which is made when missing, with rights for the user alone.

    Raises:
        OSError: it cannot be made or written, or another user could write it or replace it.
    """
    directory = directory.expanduser().resolve()
    for place in reversed((directory, *directory.parents)):
        if not place.exists():
            place.mkdir(mode=0o700, exist_ok=True)
    for place in directory.parents:
        state = place.stat()
        replaceable = state.st_mode & OTHERS_WRITE and not state.st_mode & stat.S_ISVTX
        if replaceable or state.st_uid not in (0, os.getuid()):
            raise PermissionError(f"{place} belongs to another user or is open to the writing of others")
    state = directory.stat()
    if not stat.S_ISDIR(state.st_mode) or not _is_own(state):
        raise PermissionError(f"{directory} is not a directory that this user alone can write")
    if not os.access(directory, os.W_OK | os.X_OK):
        raise PermissionError(f"{directory} is read-only")
    return Cache(directory)


def _roots(environment: Mapping[str, str]) -> Iterator[Path]:
    home = environment.get("HOME")
    if "EVODESIGN_CACHE" in environment:
        yield Path(environment["EVODESIGN_CACHE"])
    elif Path(environment.get("XDG_CACHE_HOME", "")).is_absolute():
        yield Path(environment["XDG_CACHE_HOME"]) / "evodesign"
    elif home:
        yield Path(home) / ".cache" / "evodesign"
    yield Path(tempfile.gettempdir()) / f"evodesign-{os.getuid()}"


def _is_own(state: os.stat_result) -> bool:
    return state.st_uid == os.getuid() and not state.st_mode & OTHERS_WRITE


def _read_own(path: Path) -> bytes:
    """Content of a regular file that this user alone could have written."""
    flags = os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC  # neither links nor pipes
    with os.fdopen(os.open(path, flags), "rb") as file:
        state = os.fstat(file.fileno())
        if not stat.S_ISREG(state.st_mode) or not _is_own(state):
            raise PermissionError(f"{path} is not a file that this user alone can write")
        return file.read()


def _acquire(descriptor: int) -> bool:
    """Lock a file; gives whether that meant waiting. The lock ends with the descriptor or the process."""
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        fcntl.flock(descriptor, fcntl.LOCK_EX)
        return True
    except OSError:  # a file system without locks: at worst the work is done twice
        return False
    return False
