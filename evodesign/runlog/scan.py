"""Finding everything sound in the bytes of a segment, whole, cut off or damaged anywhere.

A segment is an MCAP file: a header, then chunks (each with a checksum), their indexes and attachments (each
with a checksum), then a checksum of all that, then an index of the whole. Records are walked from the front.
Where one is damaged, the walk goes on at the next chunk whose checksum is right, and the bytes between are a
gap: nothing that is given back is guessed.

Source: the MCAP specification, version 0 (mcap.dev/spec); the written files are checked with its own reader.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Final

import zstandard

from evodesign.runlog.channels import HEADER_COPY

__all__ = ["Attachment", "Chunk", "Gap", "Message", "Scan", "messages", "scan", "topics"]

MAGIC: Final = b"\x89MCAP0\r\n"
HEADER, FOOTER, CHANNEL, MESSAGE, CHUNK, MESSAGE_INDEX, ATTACHMENT, DATA_END = 1, 2, 4, 5, 6, 7, 9, 15

RECORD: Final = struct.Struct("<BQ")
CHUNK_START: Final = struct.Struct("<QQQI")
CHUNK_MARK: Final = b"\x04\x00\x00\x00zstd"
CHUNK_MARK_AT: Final = RECORD.size + CHUNK_START.size
COPY_MARK: Final = struct.pack("<I", len(HEADER_COPY)) + HEADER_COPY.encode()
COPY_MARK_AT: Final = RECORD.size + 16
MESSAGE_START: Final = struct.Struct("<HIQQ")
FOOTER_BODY: Final = struct.Struct("<QQI")
INDEX_START: Final = struct.Struct("<HI")
INDEX_ENTRY: Final = 16


@dataclass(frozen=True, slots=True)
class Chunk:
    """The uncompressed records of a sound chunk, and where it begins and ends in the file."""

    start: int
    end: int
    records: bytes


@dataclass(frozen=True, slots=True)
class Attachment:
    """A sound attachment."""

    name: str
    data: bytes


@dataclass(frozen=True, slots=True)
class Gap:
    """Bytes from start to end (not included) that cannot be read."""

    start: int
    end: int


@dataclass(frozen=True, slots=True)
class Message:
    """A message of a chunk; its time is in nanoseconds since 1970."""

    channel: int
    sequence: int
    time: int
    data: bytes


@dataclass(frozen=True, slots=True)
class Scan:
    """What is sound in a file.

    Args:
        chunks, attachments: in the order of the file.
        gaps: what cannot be read, in the order of the file.
        size: of the file, in bytes.
        ended: whether the file has its last bytes: no process was killed while it wrote.
        sound: whether the file is as it was written, to its last byte.
    """

    chunks: tuple[Chunk, ...]
    attachments: tuple[Attachment, ...]
    gaps: tuple[Gap, ...]
    size: int
    ended: bool
    sound: bool

    @property
    def damage(self) -> tuple[Gap, ...]:
        """Gaps that no kill explains: all but one at the end of a file that lacks its last bytes."""
        return tuple(gap for gap in self.gaps if self.ended or gap.end < self.size)


def scan(content: bytes) -> Scan:
    """Everything sound in the bytes of a segment; never raises."""
    chunks: list[Chunk] = []
    attachments: list[Attachment] = []
    gaps: list[Gap] = []
    unpack = _Unpacker()
    ended = content.endswith(MAGIC) and len(content) > len(MAGIC)
    place = _after_header(content)
    if place is None:
        place = _next_sound(content, 0)
        gaps.append(Gap(0, place))
    while place < len(content):
        end, body = _record(content, place)
        opcode = content[place]
        if opcode == DATA_END and len(body) == 4:
            sound = not gaps and _whole(content, place, end, body)
            return Scan(
                tuple(chunks), tuple(attachments), tuple(gaps), len(content), ended=ended, sound=sound
            )
        if opcode == CHUNK and (records := unpack.records(body)) is not None:
            chunks.append(Chunk(place, end, records))
        elif opcode == ATTACHMENT and (attachment := _attachment(body)) is not None:
            attachments.append(attachment)
        elif not (opcode == MESSAGE_INDEX and _is_index(body)):
            end = _next_sound(content, place + 1)
            gaps.append(Gap(place, end))
        place = end
    return Scan(tuple(chunks), tuple(attachments), tuple(gaps), len(content), ended=ended, sound=False)


def topics(chunk: Chunk) -> dict[int, str]:
    """Topics by channel number, as far as this chunk describes channels."""
    found = {}
    for opcode, body in _inner(chunk.records):
        if opcode == CHANNEL:
            (number,) = struct.unpack_from("<H", body)
            (length,) = struct.unpack_from("<I", body, 4)
            found[number] = body[8 : 8 + length].decode()
    return found


def messages(chunk: Chunk) -> Iterator[Message]:
    """The messages of a chunk, in order."""
    for opcode, body in _inner(chunk.records):
        if opcode == MESSAGE:
            channel, sequence, time, _ = MESSAGE_START.unpack_from(body)
            yield Message(channel, sequence, time, body[MESSAGE_START.size :])


def _inner(records: bytes) -> Iterator[tuple[int, bytes]]:
    """Opcode and body of the records in a chunk, whose checksum was right."""
    place = 0
    while place < len(records):
        opcode, length = RECORD.unpack_from(records, place)
        place += RECORD.size
        yield opcode, records[place : place + length]
        place += length


def _record(content: bytes, place: int) -> tuple[int, bytes]:
    """End and body of the record at a place; the place itself and nothing if it is not all there."""
    if place + RECORD.size > len(content):
        return place, b""
    _, length = RECORD.unpack_from(content, place)
    end = place + RECORD.size + length
    return (end, content[place + RECORD.size : end]) if end <= len(content) else (place, b"")


def _after_header(content: bytes) -> int | None:
    """Where the first record after the file's header begins; None if the header is damaged."""
    if not content.startswith(MAGIC) or len(content) == len(MAGIC) or content[len(MAGIC)] != HEADER:
        return None
    end, body = _record(content, len(MAGIC))
    return end if body else None


def _next_sound(content: bytes, place: int) -> int:
    """Where the next sound chunk or copy of the header begins, from a place on; the end if none does."""
    chunk = _next(content, place, CHUNK, CHUNK_MARK, CHUNK_MARK_AT, _Unpacker().records)
    return _next(content[:chunk], place, ATTACHMENT, COPY_MARK, COPY_MARK_AT, _attachment)


def _next(
    content: bytes, place: int, opcode: int, mark: bytes, mark_at: int, read: Callable[[bytes], object]
) -> int:
    """Where the next sound record of a kind begins, found by a mark in it; the end if none does."""
    found = content.find(mark, place + mark_at)
    while found >= 0:
        start = found - mark_at
        if content[start] == opcode and read(_record(content, start)[1]) is not None:
            return start
        found = content.find(mark, found + 1)
    return len(content)


class _Unpacker:
    """Unpacks chunks, all with one decompressor, which takes longer to make than a chunk to unpack."""

    def __init__(self) -> None:
        self._zstd = zstandard.ZstdDecompressor()

    def records(self, body: bytes) -> bytes | None:
        """The uncompressed records of a chunk; None unless sizes and checksum are right."""
        data_at = CHUNK_START.size + len(CHUNK_MARK) + 8
        if len(body) < data_at or body[CHUNK_START.size : CHUNK_START.size + len(CHUNK_MARK)] != CHUNK_MARK:
            return None
        _, _, size, checksum = CHUNK_START.unpack_from(body)
        (stored,) = struct.unpack_from("<Q", body, data_at - 8)
        data = body[data_at:]
        if len(data) != stored:
            return None
        try:
            if zstandard.frame_content_size(data) != size:
                return None
            records = self._zstd.decompress(data)
        except (zstandard.ZstdError, MemoryError):
            return None
        return records if zlib.crc32(records) == checksum else None


def _attachment(body: bytes) -> Attachment | None:
    """The attachment of a record's body; None unless its checksum is right."""
    if len(body) < 4 or zlib.crc32(body[:-4]) != int.from_bytes(body[-4:], "little"):
        return None
    (name_length,) = struct.unpack_from("<I", body, 16)
    name = body[20 : 20 + name_length]
    kind_at = 20 + name_length
    (kind_length,) = struct.unpack_from("<I", body, kind_at)
    return Attachment(name.decode(), body[kind_at + 4 + kind_length + 8 : -4])


def _is_index(body: bytes) -> bool:
    """Whether a body has the shape of a message index."""
    if len(body) < INDEX_START.size:
        return False
    _, length = INDEX_START.unpack_from(body)
    return bool(length == len(body) - INDEX_START.size and length % INDEX_ENTRY == 0)


def _whole(content: bytes, data_end: int, summary: int, checksum: bytes) -> bool:
    """Whether the checksums of the data and of the index after it are right, and nothing follows."""
    if zlib.crc32(content[:data_end]) != int.from_bytes(checksum, "little"):
        return False
    footer = len(content) - len(MAGIC) - RECORD.size - FOOTER_BODY.size
    if footer < summary or not content.endswith(MAGIC):
        return False
    end, body = _record(content, footer)
    if content[footer] != FOOTER or end != len(content) - len(MAGIC):
        return False
    start, _, index_checksum = FOOTER_BODY.unpack(body)
    return bool(start == summary and zlib.crc32(content[summary : end - 4]) == index_checksum)
