"""Segments written by hand, with right checksums whatever they hold."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterable, Sequence
from typing import Any

import msgspec
import zstandard

from evodesign.runlog.channels import HEADER_COPY, RECORDS

MAGIC = b"\x89MCAP0\r\n"
HEADER, FOOTER, CHANNEL, MESSAGE, CHUNK, ATTACHMENT, DATA_END = 1, 2, 4, 5, 6, 9, 15
NUMBERS = {topic: number for number, topic in enumerate(RECORDS, 1)}


def record(kind: int, body: bytes) -> bytes:
    return struct.pack("<BQ", kind, len(body)) + body


def text(value: bytes) -> bytes:
    return struct.pack("<I", len(value)) + value


def channels(topics: Sequence[bytes] = tuple(topic.encode() for topic in RECORDS)) -> bytes:
    return b"".join(
        record(CHANNEL, struct.pack("<HH", number, number) + text(topic) + text(b"json") + text(b""))
        for number, topic in enumerate(topics, 1)
    )


def message(topic: str, data: bytes, sequence: int = 0) -> bytes:
    return record(MESSAGE, struct.pack("<HIQQ", NUMBERS[topic], sequence, 10**18, 10**18) + data)


def told(topic: str, value: Any, sequence: int = 0) -> bytes:
    """A message of any JSON."""
    return message(topic, msgspec.json.encode(value), sequence)


def compressed_chunk(data: bytes, size: int, checksum: int) -> bytes:
    start = struct.pack("<QQQI", 0, 0, size, checksum)
    return record(CHUNK, start + text(b"zstd") + struct.pack("<Q", len(data)) + data)


def chunk(records: bytes) -> bytes:
    return compressed_chunk(zstandard.compress(records), len(records), zlib.crc32(records))


def attachment(data: bytes, name: bytes = HEADER_COPY.encode()) -> bytes:
    body = bytes(16) + text(name) + text(b"application/zstd") + struct.pack("<Q", len(data)) + data
    return record(ATTACHMENT, body + struct.pack("<I", zlib.crc32(body)))


def segment(parts: Iterable[bytes]) -> bytes:
    """A whole segment of these records."""
    data = MAGIC + record(HEADER, text(b"") + text(b"evodesign")) + b"".join(parts)
    end = record(DATA_END, struct.pack("<I", zlib.crc32(data)))
    footer = record(FOOTER, struct.pack("<QQI", len(data) + len(end), 0, 0))[:-4]
    return data + end + footer + struct.pack("<I", zlib.crc32(footer)) + MAGIC
