"""Finding everything sound in the file of a segment, whole, cut off or damaged.

A segment is an MCAP file: a header, then chunks (each with a checksum), their indexes and attachments (each
with a checksum), then a checksum of all that, then an index of the whole. Records are walked from the front,
each by its length. One whose checksum is wrong is left out; where lengths lead to no record, reading ends.
The bytes that are left out are gaps: nothing that is given back is guessed.

A right checksum makes nothing true: whoever changes a file can write it. What a record declares is compared
with the file and with what any sound record has before it is read or unpacked, so that reading ends in time
and memory that the size of the file bounds.

Source: the MCAP specification, version 0 (mcap.dev/spec); the written files are checked with its own reader.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from typing import Final

import msgspec
import zstandard

from evodesign.runlog.channels import HEADER_COPY
from evodesign.runlog.segment_file import LARGEST_CHUNK, LARGEST_RECORD, PREFIX, SegmentFile

MAGIC: Final = b"\x89MCAP0\r\n"
HEADER, FOOTER, CHANNEL, MESSAGE, CHUNK, MESSAGE_INDEX, ATTACHMENT, DATA_END = 1, 2, 4, 5, 6, 7, 9, 15

CHUNK_START: Final = struct.Struct("<QQQI8sQ")
CHUNK_MARK: Final = b"\x04\x00\x00\x00zstd"
FRAME_HEADER: Final = 18
"""Most bytes before the first block of a zstd frame."""

COPY_MARK: Final = struct.pack("<I", len(HEADER_COPY)) + HEADER_COPY.encode()
ATTACHMENT_NAME_AT: Final = 16
MESSAGE_START: Final = struct.Struct("<HIQQ")
FOOTER_BODY: Final = struct.Struct("<QQI")
CHANNEL_START: Final = struct.Struct("<HHI")

MOST_RATIO: Final = 64
MOST_WORK: Final = 64 * 2**20
"""Bytes unpacked are at most so many times the file's, and so many more."""


class Message(msgspec.Struct, frozen=True):
    """A message of a chunk; its time is in nanoseconds since 1970."""

    channel: int
    sequence: int
    time: int
    data: bytes


class Chunk(msgspec.Struct, frozen=True):
    """What a sound chunk holds.

    Args:
        topics: by channel number, as far as this chunk describes channels.
        messages: in order.
    """

    topics: dict[int, str]
    messages: tuple[Message, ...]


class Scan:
    """A walk through a segment; what it found out about the file is whole when the chunks have been taken.

    Args:
        file: of the segment.
    Attributes:
        size: of the file, in bytes.
        gaps: places of the bytes that cannot be read, in the order of the file.
        ended: whether the file has its last bytes: no process was killed while it wrote.
        sound: whether the file is as it was written, to its last byte.
        header_copy: the header's JSON from the first sound attachment that repeats it; empty without one.
    """

    def __init__(self, file: SegmentFile) -> None:
        self._file = file
        self.size = file.size
        self.gaps: list[range] = []
        self.ended = file.size > len(MAGIC) and file.read(file.size - len(MAGIC), len(MAGIC)) == MAGIC
        self.sound = False
        self.header_copy = b""
        self._forged = False
        self._unpacker = Unpacker(file.size)

    @property
    def damage(self) -> tuple[range, ...]:
        """Gaps that no kill explains: all but one at the end of a file that lacks its last bytes."""
        killed = not self.ended and not self._forged
        return tuple(gap for gap in self.gaps if not killed or gap.stop < self.size)

    def chunks(self) -> Iterator[Chunk]:
        """Every sound chunk, in the order of the file.

        Raises:
            OSError: the file cannot be read.
        """
        place = len(MAGIC)
        if self._file.read(0, place) != MAGIC:
            self.gaps.append(range(min(place, self.size)))
        while place < self.size and not self._unpacker.exhausted:
            kind, end, body = self._file.record(place) or (0, self.size, b"")
            if kind == DATA_END and len(body) == 4:
                self.sound = not self.gaps and self._whole(place, end, body)
                return
            known = kind in (HEADER, MESSAGE_INDEX)
            if kind == CHUNK and (records := self._unpacker.records(body)) is not None:
                known = (chunk := chunk_of(records)) is not None
                self._forged |= not known
                if chunk is not None:
                    yield chunk
            elif kind == ATTACHMENT and (copy := attached_header(body)) is not None:
                known, self.header_copy = True, self.header_copy or copy
            end = end if kind else self.size  # no record is of kind 0
            if not known:
                self.gaps.append(range(place, end))
            place = end
        if place < self.size:
            self._forged = True
            self.gaps.append(range(place, self.size))

    def _whole(self, data_end: int, summary: int, checksum: bytes) -> bool:
        """Whether the checksums of the data and of the index after it are right, and nothing follows."""
        footer = self.size - len(MAGIC) - PREFIX.size - FOOTER_BODY.size
        if not (summary <= footer <= 2 * summary + LARGEST_CHUNK and self.ended):
            return False
        kind, end, body = self._file.record(footer) or (0, 0, b"")
        if kind != FOOTER or end != self.size - len(MAGIC):
            return False
        start, _, index_checksum = FOOTER_BODY.unpack(body)
        return bool(
            start == summary
            and self._file.checksum(summary, end - 4) == index_checksum
            and self._file.checksum(0, data_end) == int.from_bytes(checksum, "little")
        )


class Unpacker:
    """Unpacks chunks, all with one decompressor, which takes longer to make than a chunk to unpack.

    Args:
        size: of the file [byte], which bounds how much is unpacked of it in all.
    """

    def __init__(self, size: int) -> None:
        self._zstd = zstandard.ZstdDecompressor()
        self._left = MOST_RATIO * size + MOST_WORK

    @property
    def exhausted(self) -> bool:
        """Whether more was unpacked than any sound file of this size holds."""
        return self._left < 0

    def records(self, body: bytes) -> bytes | None:
        """The uncompressed records of a chunk; None unless sizes and checksum are right."""
        declared = _declared(body, len(body))
        if declared is None:
            return None
        size, checksum = declared
        self._left -= size
        if self._left < 0:
            return None
        try:
            records = self._zstd.decompress(memoryview(body)[CHUNK_START.size :])
        except (zstandard.ZstdError, MemoryError):
            return None
        return records if zlib.crc32(records) == checksum else None


def _declared(start: bytes, length: int) -> tuple[int, int] | None:
    """Size and checksum that a chunk's records are to have, from the first bytes of its body.

    None if they do not fit the body's length, or are more than a sound chunk has.
    """
    if len(start) < CHUNK_START.size:
        return None
    _, _, size, checksum, mark, stored = CHUNK_START.unpack_from(start)
    if mark != CHUNK_MARK or stored != length - CHUNK_START.size or size > LARGEST_CHUNK:
        return None
    try:
        frame = start[CHUNK_START.size : CHUNK_START.size + FRAME_HEADER]
        return (size, checksum) if zstandard.frame_content_size(frame) == size else None
    except zstandard.ZstdError:
        return None


def chunk_of(records: bytes) -> Chunk | None:
    """What the uncompressed records of a chunk say; None if one of them is none."""
    topics: dict[int, str] = {}
    messages: list[Message] = []
    place = 0
    try:
        while place < len(records):
            kind, length = PREFIX.unpack_from(records, place)
            place += PREFIX.size
            body = records[place : place + length]
            if len(body) != length:
                return None
            if kind == MESSAGE:
                channel, sequence, time, _ = MESSAGE_START.unpack_from(body)
                messages.append(Message(channel, sequence, time, body[MESSAGE_START.size :]))
            elif kind == CHANNEL:
                number, _, name_length = CHANNEL_START.unpack_from(body)
                topic = body[CHANNEL_START.size : CHANNEL_START.size + name_length]
                if len(topic) != name_length:
                    return None
                topics[number] = topic.decode()
            place += length
    except (struct.error, UnicodeDecodeError):
        return None
    return Chunk(topics, tuple(messages))


def attached_header(body: bytes) -> bytes | None:
    """The header's JSON in an attachment, empty in another attachment; None unless its checksum is right."""
    if len(body) < 4 or zlib.crc32(memoryview(body)[:-4]) != int.from_bytes(body[-4:], "little"):
        return None
    name_at = ATTACHMENT_NAME_AT + len(COPY_MARK)
    if body[ATTACHMENT_NAME_AT:name_at] != COPY_MARK or len(body) < name_at + 4:
        return b""
    data_at = name_at + 4 + int.from_bytes(body[name_at : name_at + 4], "little") + 8
    data = body[data_at:-4]
    try:
        if zstandard.frame_content_size(data) not in range(LARGEST_RECORD + 1):
            return b""
        return zstandard.ZstdDecompressor().decompress(data)
    except (zstandard.ZstdError, MemoryError):
        return b""
