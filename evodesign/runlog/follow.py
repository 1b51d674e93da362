"""Following a run while a search writes it: every look reads only what has come since the last one.

The search is not disturbed: its files are opened for reading and nothing is locked. A record that is only
half there waits for the next look.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

import msgspec

from evodesign.records import RunHeader
from evodesign.runlog.directory import run_segments
from evodesign.runlog.gaps import segment_gaps
from evodesign.runlog.header import differences
from evodesign.runlog.reader import Believer, Entry
from evodesign.runlog.scan import ATTACHMENT, CHUNK, DATA_END, HEADER, MESSAGE_INDEX, Unpacker, chunk_of
from evodesign.runlog.segment_file import opened
from evodesign.runlog.validity import Validity

MAGIC_SIZE: Final = 8
"""Bytes before the first record of an MCAP file."""

PASSED_OVER: Final = (HEADER, MESSAGE_INDEX, ATTACHMENT)
"""Records of a log that hold none of its messages."""


@dataclass(frozen=True, slots=True)
class Logged:
    """A record and when it was written, in seconds since 1970."""

    record: msgspec.Struct
    time: float


@dataclass(slots=True)
class _Place:
    """How far a segment was read."""

    path: Path
    believer: Believer
    offset: int = MAGIC_SIZE
    ended: bool = False
    damage: str = ""
    strange: list[str] = field(default_factory=list)


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
        self._sessions: set[int] = set()
        self._header: RunHeader | None = None

    @property
    def ended(self) -> bool:
        """Whether the last session closed its segment: nothing more comes unless the run is resumed."""
        return bool(self._places) and self._places[max(self._places)].ended

    @property
    def notes(self) -> tuple[str, ...]:
        """A sentence for every segment that is missing, cannot be read further or has what is no record."""
        notes = segment_gaps(self._places, self._sessions)
        for place in self._places.values():
            if place.damage:
                notes.append(f"{place.path.name} cannot be read further: {place.damage}")
            if refused := place.believer.refused + len(place.strange):
                reason = (place.strange or [place.believer.reason])[0]
                notes.append(f"{place.path.name} has {refused} messages that are no records ({reason})")
        return tuple(notes)

    def look(self) -> list[Logged]:
        """The records that have come since the last look, in the order of the log.

        Raises:
            RunError: the run has gone, or cannot be read.
        """
        for number, path in run_segments(self.directory).items():
            self._places.setdefault(number, _Place(path, Believer(path)))
        return [
            Logged(entry.record, entry.time / 1e9)
            for number in sorted(self._places)
            for entry in _news(self._places[number])
            if self._fits(self._places[number], entry)
        ]

    def _fits(self, place: _Place, entry: Entry) -> bool:
        """Whether a record agrees with the header that was read before it."""
        record = entry.record
        if isinstance(record, RunHeader):
            if self._header is not None and (differing := differences(self._header, record)):
                place.strange.append(f"it is of another problem or search: {'; '.join(differing)}")
                return False
            self._sessions.add(entry.sequence)
            self._header = record
            return True
        fault = "a record without a header" if self._header is None else Validity(self._header).fault(record)
        if fault:
            place.strange.append(fault)
        return not fault


def _news(place: _Place) -> list[Entry]:
    """New records of a segment; what cannot be read ends it."""
    found: list[Entry] = []
    if not place.ended and not place.damage:
        with opened(place.path) as file:
            unpacker = Unpacker(file.size)
            while not place.ended and not place.damage and (record := file.record(place.offset)) is not None:
                found += _step(place, record, unpacker)
            if file.beyond_any(place.offset):
                place.damage = f"the record at {place.offset} is longer than any"
    return found


def _step(place: _Place, record: tuple[int, int, bytes], unpacker: Unpacker) -> list[Entry]:
    """The records of the next whole record of a file, if that is a chunk; moves the place behind it."""
    kind, end, body = record
    found: list[Entry] = []
    if kind == DATA_END:
        place.ended = True
        return found
    if kind == CHUNK:
        records = unpacker.records(body)
        chunk = None if records is None else chunk_of(records)
        if chunk is None:
            place.damage = f"the chunk at {place.offset} does not match its checksum, or holds no records"
            return found
        place.believer.topics |= chunk.topics
        found = [entry for message in chunk.messages if (entry := place.believer.entry(message)) is not None]
    elif kind not in PASSED_OVER:
        place.damage = f"the record at {place.offset} is of a kind that no log has"
        return found
    place.offset = end
    return found
