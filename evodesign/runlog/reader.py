"""Reading one segment of a run's log, whole or cut off anywhere.

The file is read as a stream, from the front: a segment whose session was killed has neither index nor
footer, and its last chunk may be half there. The first thing that cannot be read is taken as the end.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Final, TypeVar

import msgspec
import zstandard
from mcap.exceptions import McapError, RecordLengthLimitExceeded
from mcap.records import Channel, Message
from mcap.stream_reader import StreamReader

from evodesign.errors import RunError
from evodesign.records import FORMAT_VERSION, Detail, Evaluation, Front, Generation, RunHeader
from evodesign.runlog.channels import RECORDS, RUN

__all__ = ["Segment", "read_segment"]

DAMAGE: Final = (
    MemoryError,  # a damaged length
    OverflowError,  # a damaged length
    McapError,
    ValueError,  # checksums, text that is not UTF-8
    msgspec.MsgspecError,
    struct.error,
    zstandard.ZstdError,
)
"""What reading raises at the place where a file was cut off or damaged."""

R = TypeVar("R")


@dataclass(frozen=True, slots=True)
class Segment:
    """What can be read of a segment.

    Args:
        path: the file.
        header: its first message; None when even that is missing.
        evaluations, generations, fronts, details: in the order of the file.
        complete: whether the file is whole, to its last byte.
        note: a sentence on what is missing; empty when nothing is.
    """

    path: Path
    header: RunHeader | None
    evaluations: tuple[Evaluation, ...]
    generations: tuple[Generation, ...]
    fronts: tuple[Front, ...]
    details: tuple[Detail, ...]
    complete: bool
    note: str


class _Version(msgspec.Struct):
    """The one field of a header that every version has."""

    format_version: int


def read_segment(path: Path) -> Segment:
    """A segment as far as it can be read; damage never raises.

    Raises:
        RunError: the file cannot be opened, or a later version of evodesign wrote it.
    """
    try:
        content = path.read_bytes()
    except OSError as error:
        raise RunError(f"{path}: cannot be read: {error.strerror}") from error
    stream = BytesIO(content)
    records: list[msgspec.Struct] = []
    damage, cut_off = "", False
    try:
        for record in _records(path, stream, len(content)):
            records.append(record)  # noqa: PERF402 - what came before damage is kept
    except DAMAGE as error:
        damage = str(error) or type(error).__name__
        cut_off = isinstance(error, RecordLengthLimitExceeded) or stream.tell() == len(content)
    headers = _all(records, RunHeader)
    evaluations = _all(records, Evaluation)
    where = f"after {len(evaluations)} evaluations" if headers else "before its header"
    return Segment(
        path=path,
        header=headers[0] if headers else None,
        evaluations=evaluations,
        generations=_all(records, Generation),
        fronts=_all(records, Front),
        details=_all(records, Detail),
        complete=not damage,
        note=_note(path, where, damage, cut_off),
    )


def _records(path: Path, stream: BytesIO, limit: int) -> Iterator[msgspec.Struct]:
    """Records up to the end or the first damage; no part of it is longer than `limit` bytes."""
    topics: dict[int, str] = {}
    for entry in StreamReader(stream, validate_crcs=True, record_size_limit=limit).records:
        if isinstance(entry, Channel):
            topics[entry.id] = entry.topic
        elif isinstance(entry, Message):
            topic = topics.get(entry.channel_id)
            if topic is None:
                raise McapError(f"a message of the unknown channel {entry.channel_id}")
            if topic == RUN:
                _check_version(path, entry.data)
            if topic in RECORDS:
                yield msgspec.json.decode(entry.data, type=RECORDS[topic])


def _check_version(path: Path, header: bytes) -> None:
    version = msgspec.json.decode(header, type=_Version).format_version
    if version > FORMAT_VERSION:
        raise RunError(
            f"{path}: wanted a log of format {FORMAT_VERSION} or earlier, found format {version}; "
            "read it with a later evodesign"
        )


def _all(records: list[msgspec.Struct], kind: type[R]) -> tuple[R, ...]:
    return tuple(record for record in records if isinstance(record, kind))


def _note(path: Path, where: str, damage: str, cut_off: bool) -> str:
    if not damage:
        return ""
    if cut_off:
        return f"{path.name} ends {where}, without a footer: its session was killed, or is still writing"
    return f"{path.name} cannot be read further {where}: {' '.join(damage.split())}"
