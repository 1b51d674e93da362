"""Following a run while a search writes it: every look reads only what has come since the last one.

The search is not disturbed: its files are opened for reading and nothing is locked. A record that is only
half there waits for the next look.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path
from typing import Final

import msgspec
import zstandard
from mcap.exceptions import EndOfFile, McapError
from mcap.opcode import Opcode
from mcap.records import Channel, Message
from mcap.stream_reader import StreamReader

from evodesign.errors import RunError
from evodesign.runlog.channels import RECORDS
from evodesign.runlog.directory import run_segments
from evodesign.runlog.upgrade import record_of

__all__ = ["Follower", "Logged"]

DAMAGE: Final = (
    MemoryError,  # a damaged length
    OverflowError,  # a damaged length
    McapError,
    ValueError,  # checksums, text that is not UTF-8
    msgspec.MsgspecError,
    struct.error,
    zstandard.ZstdError,
)
"""What reading raises where a file is damaged."""

MAGIC_SIZE: Final = 8
"""Bytes before the first record of an MCAP file."""

PREFIX: Final = struct.Struct("<BQ")
"""Before each record of an MCAP file: its kind and its length."""


@dataclass(frozen=True, slots=True)
class Logged:
    """A record and when it was written, in seconds since 1970."""

    record: msgspec.Struct
    time: float


@dataclass(slots=True)
class _Place:
    """How far a segment was read."""

    path: Path
    offset: int = MAGIC_SIZE
    topics: dict[int, str] = field(default_factory=dict)
    ended: bool = False
    damage: str = ""


class Follower:
    """Reads a run's segments as they grow.

    Args:
        directory: of the run.
    Raises:
        RunError: the directory is missing or is not a run.
    """

    def __init__(self, directory: Path) -> None:
        run_segments(directory)
        self.directory = directory
        self._places: dict[int, _Place] = {}

    @property
    def ended(self) -> bool:
        """Whether the last session closed its segment: nothing more comes unless the run is resumed."""
        return bool(self._places) and self._places[max(self._places)].ended

    @property
    def notes(self) -> tuple[str, ...]:
        """A sentence for every segment that cannot be read further."""
        return tuple(
            f"{place.path.name} cannot be read further: {place.damage}"
            for place in self._places.values()
            if place.damage
        )

    def look(self) -> list[Logged]:
        """The records that have come since the last look, in the order of the log.

        Raises:
            RunError: the run has gone, or cannot be read.
        """
        for number, path in run_segments(self.directory).items():
            self._places.setdefault(number, _Place(path))
        return [logged for number in sorted(self._places) for logged in _news(self._places[number])]


def _news(place: _Place) -> list[Logged]:
    """New records of a segment; what cannot be read ends it."""
    found: list[Logged] = []
    if place.ended or place.damage:
        return found
    try:
        with place.path.open("rb") as file:
            file.seek(place.offset)
            content = file.read()
    except OSError as error:
        raise RunError(f"{place.path}: cannot be read: {error.strerror}") from error
    whole, place.ended = _whole_records(content)
    place.offset += whole
    try:
        for logged in _records(content[:whole], place.topics):
            found.append(logged)  # noqa: PERF402 - what came before damage is kept
    except EndOfFile:
        pass  # no footer follows: there is more to come
    except DAMAGE as error:
        place.damage = " ".join(str(error).split()) or type(error).__name__
    return found


def _whole_records(content: bytes) -> tuple[int, bool]:
    """Length of the data's records that are there from end to end, and whether the data ends after them."""
    end = 0
    while end + PREFIX.size <= len(content):
        kind, length = PREFIX.unpack_from(content, end)
        if kind == Opcode.DATA_END:
            return end, True
        if end + PREFIX.size + length > len(content):
            break
        end += PREFIX.size + length
    return end, False


def _records(content: bytes, topics: dict[int, str]) -> Iterator[Logged]:
    """Records of whole chunks; the topics of channels are remembered from call to call."""
    stream = BytesIO(content)
    reader = StreamReader(stream, skip_magic=True, validate_crcs=True, record_size_limit=len(content))
    for entry in reader.records:
        if isinstance(entry, Channel):
            topics[entry.id] = entry.topic
        elif isinstance(entry, Message) and (topic := topics.get(entry.channel_id, "")) in RECORDS:
            yield Logged(record_of(topic, entry.data), entry.log_time / 1e9)
