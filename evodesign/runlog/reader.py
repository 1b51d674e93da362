"""Reading one segment of a run's log, whole, cut off or damaged.

A segment whose session was killed has neither index nor footer, and its last chunk may be half there. What
cannot be read is said.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final, TypeVar

import msgspec

from evodesign.errors import RunError, on_one_line
from evodesign.records import FORMAT_VERSION, Detail, Evaluation, Front, Generation, RunHeader
from evodesign.runlog.channels import RECORDS, RUN
from evodesign.runlog.scan import Message, Scan
from evodesign.runlog.segment_file import LARGEST_RECORD, opened
from evodesign.runlog.upgrade import record_of
from evodesign.runlog.validity import header_fault

R = TypeVar("R")

USUAL_TOPICS: Final = dict(enumerate(RECORDS, 1))
"""Topics by channel number as the writer registers them, for a segment whose descriptions are damaged."""

MOST_LISTED: Final = 20
"""Gaps in one sentence."""

LONGEST_REASON: Final = 200
"""Letters of what is quoted of an error."""

LAST_VERSION: Final = 1000
"""No later format will be: what claims to be one was not written by evodesign."""

NOT_DECODED: Final = (msgspec.MsgspecError, ValueError, RecursionError)
"""What decoding raises: other fields or types, text that is not UTF-8 or JSON, too much of one in another."""


@dataclass(frozen=True, slots=True)
class Segment:
    """What can be read of a segment.

    Args:
        path: the file.
        headers: a single one, or of a merged segment one of each; none when even that is missing.
        evaluations, generations, fronts, details: in the order of the file.
        sessions: numbers in the run of the segments whose headers are here, of a merged segment many.
        complete: whether the file is whole, to its last byte.
        damaged: whether something is wrong that no kill explains.
        note: a sentence on what is missing; empty when nothing is.
    """

    path: Path
    headers: tuple[RunHeader, ...]
    evaluations: tuple[Evaluation, ...]
    generations: tuple[Generation, ...]
    fronts: tuple[Front, ...]
    details: tuple[Detail, ...]
    sessions: tuple[int, ...]
    complete: bool
    damaged: bool
    note: str


class Entry(msgspec.Struct, frozen=True):
    """A record of the log with its topic, its number there and its time [ns since 1970]."""

    topic: str
    sequence: int
    time: int
    record: msgspec.Struct


class _Version(msgspec.Struct):
    """The one field of a header that every version has."""

    format_version: int


def read_segment(path: Path, *, last: bool = True) -> Segment:
    """A segment as far as it can be read; damage never raises.

    Args:
        path: the file.
        last: whether it is the run's last one, which may still be written.
    Raises:
        RunError: the file cannot be opened, or a later version of evodesign wrote it.
    """
    with opened(path) as file:
        found = Scan(file)
        believer = Believer(path)
        read = list(_believed(found, believer))
    records = [entry.record for entry in read]
    headers = _all(records, RunHeader) or believer.copied(found.header_copy)
    evaluations = _all(records, Evaluation)
    return Segment(
        path=path,
        headers=headers,
        evaluations=evaluations,
        generations=_all(records, Generation),
        fronts=_all(records, Front),
        details=_all(records, Detail),
        sessions=tuple(entry.sequence for entry in read if entry.topic == RUN),
        complete=found.sound and not believer.refused,
        damaged=bool(found.damage) or (found.ended and not found.sound) or bool(believer.refused),
        note=_note(path, found, believer, len(evaluations), headed=bool(headers), last=last),
    )


def entries(path: Path) -> Iterator[Entry]:
    """All records in the order of the file; what this version does not know is passed over.

    Raises:
        RunError: the file cannot be opened, or a later version of evodesign wrote it.
    """
    with opened(path) as file:
        yield from _believed(Scan(file), Believer(path))


def _believed(found: Scan, believer: Believer) -> Iterator[Entry]:
    for chunk in found.chunks():
        believer.topics |= chunk.topics
        for message in chunk.messages:
            entry = believer.entry(message)
            if entry is not None:
                yield entry


class Believer:
    """Takes messages for the records that they are, and keeps account of those that are none.

    Args:
        path: of the file, for messages.
    Attributes:
        topics: by channel number, as far as they are known.
        refused: how many messages are none of this version's records.
        reason: why the first of them is none.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self.topics = dict(USUAL_TOPICS)
        self.refused = 0
        self.reason = ""

    def entry(self, message: Message) -> Entry | None:
        """The record of a message; None if its topic is unknown, or it is no record.

        Raises:
            RunError: a later version of evodesign wrote it.
        """
        topic = self.topics.get(message.channel, "")
        if topic not in RECORDS:
            return None
        record = self._record(topic, message.data)
        return None if record is None else Entry(topic, message.sequence, message.time, record)

    def copied(self, header: bytes) -> tuple[RunHeader, ...]:
        """The header of its copy beside the messages, if that is one."""
        record = self._record(RUN, header) if header else None
        return _all([record] if record is not None else [], RunHeader)

    def _record(self, topic: str, data: bytes) -> msgspec.Struct | None:
        try:
            if len(data) > LARGEST_RECORD:
                raise ValueError(f"{len(data)} bytes are more than any record has")
            if topic == RUN:
                self._check_version(data)
            record = record_of(topic, data)
            if isinstance(record, RunHeader) and (fault := header_fault(record)):
                raise ValueError(fault)
        except NOT_DECODED as error:
            self.refused += 1
            self.reason = self.reason or f"{topic}: {on_one_line(str(error))[:LONGEST_REASON]}"
            return None
        return record

    def _check_version(self, header: bytes) -> None:
        version = msgspec.json.decode(header, type=_Version).format_version
        if not 1 <= version <= LAST_VERSION:
            raise ValueError(f"there is no format {version}")
        if version > FORMAT_VERSION:
            raise RunError(
                f"{self._path}: wanted a log of format {FORMAT_VERSION} or earlier, found format {version}; "
                "read it with a later evodesign"
            )


def _all(records: Sequence[msgspec.Struct], kind: type[R]) -> tuple[R, ...]:
    return tuple(record for record in records if isinstance(record, kind))


def _note(path: Path, found: Scan, believer: Believer, evaluations: int, *, headed: bool, last: bool) -> str:
    """A sentence on what a file lacks."""
    if found.size == 0:
        other = "has just begun" if last else "what it wrote is lost"
        return f"{path.name} is empty: its session was killed before it wrote, or {other}"
    if found.damage:
        places = [f"{len(gap)} bytes at {gap.start}" for gap in found.damage[:MOST_LISTED]]
        further = len(found.damage) - len(places)
        more = f" and at {further} more places" if further else ""
        return (
            f"{path.name} is damaged: {', '.join(places)}{more} cannot be read; {evaluations} evaluations can"
        )
    if believer.refused:
        return f"{path.name} has {believer.refused} messages that are no records ({believer.reason})"
    if found.sound:
        return ""
    if found.ended:
        return f"{path.name} does not match its checksums, though each of its {evaluations} evaluations does"
    where = f"after {evaluations} evaluations" if headed else "before its header"
    other = "is still writing" if last else "its end is lost"
    return f"{path.name} ends {where}, without a footer: its session was killed, or {other}"
