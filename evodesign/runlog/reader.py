"""Reading one segment of a run's log, whole, cut off or damaged anywhere.

A segment whose session was killed has neither index nor footer, and its last chunk may be half there. What is
sound is read, also after a damaged part; what is not is said.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final, TypeVar

import msgspec
import zstandard

from evodesign.errors import RunError
from evodesign.records import FORMAT_VERSION, Detail, Evaluation, Front, Generation, RunHeader
from evodesign.runlog.channels import HEADER_COPY, RECORDS, RUN
from evodesign.runlog.scan import Scan, messages, scan, topics
from evodesign.runlog.upgrade import record_of

__all__ = ["Entry", "Segment", "entries", "read_content", "read_segment"]

R = TypeVar("R")

USUAL_TOPICS: Final = dict(enumerate(RECORDS, 1))
"""Topics by channel number as the writer registers them, for a segment whose descriptions are damaged."""


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


@dataclass(frozen=True, slots=True)
class Entry:
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
    found = scan(read_content(path))
    read = list(entries(path, found))
    records = [entry.record for entry in read]
    headers = _all(records, RunHeader) or _header_copy(path, found)
    evaluations = _all(records, Evaluation)
    return Segment(
        path=path,
        headers=headers,
        evaluations=evaluations,
        generations=_all(records, Generation),
        fronts=_all(records, Front),
        details=_all(records, Detail),
        sessions=tuple(entry.sequence for entry in read if entry.topic == RUN),
        complete=found.sound,
        damaged=bool(found.damage) or (found.ended and not found.sound),
        note=_note(path, found, len(evaluations), headed=bool(headers), last=last),
    )


def read_content(path: Path) -> bytes:
    """The bytes of a segment.

    Raises:
        RunError: the file cannot be opened.
    """
    try:
        return path.read_bytes()
    except OSError as error:
        raise RunError(f"{path}: cannot be read: {error.strerror}") from error


def entries(path: Path, found: Scan) -> Iterator[Entry]:
    """All records in the order of the file; what this version does not know is passed over.

    Raises:
        RunError: a later version of evodesign wrote the file.
    """
    known = dict(USUAL_TOPICS)
    for chunk in found.chunks:
        known |= topics(chunk)
        for message in messages(chunk):
            topic = known.get(message.channel, "")
            if topic == RUN:
                _check_version(path, message.data)
            if topic in RECORDS and (record := _decoded(topic, message.data)) is not None:
                yield Entry(topic, message.sequence, message.time, record)


def _decoded(topic: str, data: bytes) -> msgspec.Struct | None:
    try:
        return record_of(topic, data)
    except (msgspec.MsgspecError, UnicodeDecodeError):
        return None


def _header_copy(path: Path, found: Scan) -> tuple[RunHeader, ...]:
    """The header from its copy beside the messages."""
    copies = [attachment.data for attachment in found.attachments if attachment.name == HEADER_COPY]
    headers = [zstandard.ZstdDecompressor().decompress(copy) for copy in copies[:1]]
    for header in headers:
        _check_version(path, header)
    return _all([record_of(RUN, header) for header in headers], RunHeader)


def _check_version(path: Path, header: bytes) -> None:
    version = msgspec.json.decode(header, type=_Version).format_version
    if version > FORMAT_VERSION:
        raise RunError(
            f"{path}: wanted a log of format {FORMAT_VERSION} or earlier, found format {version}; "
            "read it with a later evodesign"
        )


def _all(records: Sequence[msgspec.Struct], kind: type[R]) -> tuple[R, ...]:
    return tuple(record for record in records if isinstance(record, kind))


def _note(path: Path, found: Scan, evaluations: int, *, headed: bool, last: bool) -> str:
    """A sentence on what a file lacks."""
    if found.sound:
        return ""
    if found.size == 0:
        other = "has just begun" if last else "what it wrote is lost"
        return f"{path.name} is empty: its session was killed before it wrote, or {other}"
    where = f"after {evaluations} evaluations" if headed else "before its header"
    if found.damage:
        places = ", ".join(f"{gap.end - gap.start} bytes at {gap.start}" for gap in found.damage)
        return f"{path.name} is damaged: {places} cannot be read; {evaluations} evaluations can"
    if found.ended:
        return f"{path.name} does not match its checksums, though each of its {evaluations} evaluations does"
    other = "is still writing" if last else "its end is lost"
    return f"{path.name} ends {where}, without a footer: its session was killed, or {other}"
