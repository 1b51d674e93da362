"""Writing the segments of a run's log, so that nothing believed is ever lost.

Every record is a chunk of its own, handed to the operating system at once: it survives the death of this
process. `commit` also reaches the disk: what came before survives a power cut. Memory commits after every
evaluation, before anyone is told of it. The price is a log of about 1.0 kB instead of 0.5 kB per evaluation
of 16 parameters and 3 heights (1.8 kB as JSON), and 5 kB more for each design with its postures.
"""

from __future__ import annotations

import errno
import os
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from types import TracebackType
from typing import BinaryIO, Self

import msgspec
import zstandard
from mcap.writer import CompressionType, Writer

from evodesign.errors import RunError
from evodesign.files import begun
from evodesign.records import FORMAT_VERSION, Detail, Evaluation, Front, Generation, RunHeader
from evodesign.runlog.channels import (
    HEADER_COPY,
    MESSAGE_ENCODING,
    RECORDS,
    RUN,
    SCHEMA_ENCODING,
    described,
    known_as,
)
from evodesign.runlog.directory import make_directory, segment_path, segments, synced
from evodesign.runlog.run import refuse_run
from evodesign.runlog.segment_file import LARGEST_RECORD

UNFINISHED = "segment.part"
"""A segment that has no header yet; a kill leaves at most one, which the next session writes over."""

LONGEST_SEGMENT = 4096
"""Messages after which `commit` begins the next segment: an open one keeps its index in memory, 2 kB each."""


class RunWriter:
    """Writes a new segment, and the next one when it has grown long; a context manager that ends the last.

    A write that fails or is broken off spoils the segment: it then ends without a footer, after its last
    whole chunk, and the reader takes it so.

    Args:
        directory: of the run; made when missing.
        header: first message of the segment; on the disk when the writer is ready.
        segment: number of the segment.
    Raises:
        RunError: the first segment is asked for and the directory holds a run, or nothing can be written.
    """

    def __init__(self, directory: Path, header: RunHeader, segment: int = 0) -> None:
        if segment == 0:
            refuse_run(directory)
        make_directory(directory)
        self._directory = directory
        self._header = header
        self._segment = segment
        self._spoilt = False
        self._closed = False
        self._time = 0
        self.path = segment_path(directory, segment)
        with self._writing():
            self._begin()

    def _begin(self) -> None:
        """Put the present segment with its header on the disk; it has its name from then on, not before."""
        self.path = segment_path(self._directory, self._segment)
        unfinished = self._directory / UNFINISHED
        self._file = begun(self.path, UNFINISHED)  # in the place of what a killed session left
        try:
            self._put_header()
            if os.path.lexists(self.path):
                raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST))
            unfinished.rename(self.path)
        except BaseException:
            with suppress(OSError):
                self._file.close()
            unfinished.unlink(missing_ok=True)
            raise
        synced(self._directory, self._directory.parent)

    def _put_header(self) -> None:
        self._messages = 0
        self._mcap = Writer(self._file, compression=CompressionType.ZSTD, enable_data_crcs=True)
        self._mcap.start(profile="", library="evodesign")
        self._channels = register(self._mcap, self._header)
        self._add(RUN, self._segment, self._header)
        add_header_copy(self._mcap, self._header, self._now())
        _to_disk(self._file)

    def _end(self) -> None:
        """Finish the present segment with its index and footer."""
        self._mcap.finish()  # type: ignore[no-untyped-call]
        _to_disk(self._file)
        self._file.close()

    @classmethod
    def next_segment(cls, directory: Path, header: RunHeader) -> RunWriter:
        """The segment after those that a run has."""
        return cls(directory, header, 1 + max(segments(directory), default=-1))

    def write(self, record: Evaluation | Detail | Generation | Front) -> None:
        """Append a record; postures go before their evaluation, so that it is never known without them."""
        with self._writing():
            self._add(*known_as(record), record)

    def commit(self) -> None:
        """Return when all that was appended is on the disk; the place where a long segment ends."""
        with self._writing():
            _to_disk(self._file)
            if self._messages >= LONGEST_SEGMENT:
                self._end()
                self._segment += 1
                self._begin()

    def close(self) -> None:
        """End the segment with its index and footer, unless it is spoilt; a second call does nothing."""
        if self._closed:
            return
        self._closed = True
        try:
            if not self._spoilt:
                with self._writing():
                    self._end()
        finally:
            with suppress(OSError):
                self._file.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, where: TracebackType | None
    ) -> None:
        self.close()

    def _add(self, topic: str, sequence: int, record: msgspec.Struct) -> None:
        """A chunk with one message, handed to the operating system."""
        now, data = self._now(), encoded(record)
        if len(data) > LARGEST_RECORD:
            raise RunError(
                f"{self.path}: wanted records of at most {LARGEST_RECORD} bytes, which can be read again, "
                f"found one for {topic} of {len(data)}"
            )
        self._mcap.add_message(self._channels[topic], now, data, now, sequence)
        self._mcap.flush()  # type: ignore[no-untyped-call]
        self._messages += 1

    def _now(self) -> int:
        """Time [ns since 1970] that never goes back within a segment, whatever the clock does."""
        self._time = max(self._time, time.time_ns())
        return self._time

    @contextmanager
    def _writing(self) -> Iterator[None]:
        if self._spoilt:
            raise RunError(f"{self.path}: an earlier write was broken off, so nothing can follow it")
        self._spoilt = True
        try:
            yield
        except OSError as error:
            raise RunError(f"{self.path}: cannot be written: {error.strerror}") from error
        self._spoilt = False


def encoded(record: msgspec.Struct) -> bytes:
    """A record as a message; a header of an earlier format is written, as all beside it, in this one."""
    if isinstance(record, RunHeader):
        version = max(record.format_version, FORMAT_VERSION)
        record = msgspec.structs.replace(record, format_version=version)
    return msgspec.json.encode(record)


def register(writer: Writer, header: RunHeader) -> dict[str, int]:
    """Describe all channels in a file; their numbers by topic."""
    channels = {}
    for topic, schema in described(header).items():
        number = writer.register_schema(RECORDS[topic].__name__, SCHEMA_ENCODING, schema)
        channels[topic] = writer.register_channel(topic, MESSAGE_ENCODING, number)
    return channels


def add_header_copy(writer: Writer, header: RunHeader, now: int) -> None:
    """Attach the header once more, with a checksum of its own, at a time [ns since 1970]."""
    data = zstandard.compress(encoded(header))
    writer.add_attachment(now, now, HEADER_COPY, "application/zstd", data)


def _to_disk(file: BinaryIO) -> None:
    file.flush()
    os.fsync(file.fileno())
