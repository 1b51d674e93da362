"""Writing a run anew: all that can be read of its segments into one whole, indexed file.

Recovering writes a new run beside a damaged one; merging puts one segment in the place of many. Messages keep
their times, and their bytes unless they are of an earlier format.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

from mcap.writer import CompressionType, Writer

from evodesign.errors import RunError
from evodesign.runlog.channels import RUN
from evodesign.runlog.directory import locked, make_directory, refuse_run, run_segments, segment_path, synced
from evodesign.runlog.reader import Entry, entries, read_content
from evodesign.runlog.run import Run, read_run
from evodesign.runlog.scan import scan
from evodesign.runlog.writer import add_header_copy, encoded, register

__all__ = ["merge", "recover"]

CHUNK_BYTES = 65536
"""Records are compressed together in chunks of this size: about 0.5 kB per evaluation instead of 1.0 kB."""

UNFINISHED = "merged.part"


def recover(directory: Path, to: Path) -> Run:
    """Write all that can be read of a run to a new directory.

    Raises:
        RunError: nothing can be read, or the new directory holds a run or cannot be written.
    """
    run = read_run(directory)
    refuse_run(to)
    make_directory(to)
    with locked(to):
        _write(segment_path(to, 0), directory, run)
        synced(to, to.parent)
    return read_run(to)


def merge(directory: Path, to: Path | None) -> Run:
    """Put all segments of a run into one file: elsewhere, or in their own place.

    The new file is whole and compared with the old ones before any of them goes; a merge that is killed
    leaves the run as it was, or with some things twice, which reading takes once.

    Args:
        directory: of the run.
        to: the file to write; None for the run's own place.
    Raises:
        RunError: a segment is damaged, another process writes the run, or the file cannot be written.
    """
    if to is not None:
        run = _undamaged(directory)
        _write(to, directory, run)
        return run
    paths = run_segments(directory)
    with locked(directory):
        run = _undamaged(directory)
        unfinished = directory / UNFINISHED
        try:
            unfinished.unlink(missing_ok=True)  # of a merge that was killed
            _write(unfinished, directory, run)
            unfinished.replace(segment_path(directory, 0))
            synced(directory)
            for number, path in paths.items():
                if number > 0:
                    path.unlink()
            synced(directory)
        except OSError as error:
            raise RunError(f"{directory}: cannot be merged: {error.strerror}") from error
    return read_run(directory)


def _undamaged(directory: Path) -> Run:
    run = read_run(directory)
    if run.damaged:
        raise RunError(
            f"{directory}: {run.notes[0]}; save what can be read first: evodesign recover {directory}"
        )
    return run


def _write(path: Path, directory: Path, run: Run) -> None:
    """All records of a run, each once, as one segment that is on the disk when this returns.

    Raises:
        RunError: the file cannot be written.
    """
    try:
        with path.open("xb") as file:
            writer = Writer(
                file, chunk_size=CHUNK_BYTES, compression=CompressionType.ZSTD, enable_data_crcs=True
            )
            writer.start(profile="", library="evodesign")
            channels = register(writer, run.header)
            time = 0
            for entry in _once(directory, run):
                time = max(time, entry.time)
                writer.add_message(channels[entry.topic], time, encoded(entry.record), time, entry.sequence)
            add_header_copy(writer, run.header, time)
            writer.finish()  # type: ignore[no-untyped-call]
            file.flush()
            os.fsync(file.fileno())
    except FileExistsError as error:
        raise RunError(f"{path}: exists already") from error
    except OSError as error:
        path.unlink(missing_ok=True)
        raise RunError(f"{path}: cannot be written: {error.strerror}") from error


def _once(directory: Path, run: Run) -> Iterator[Entry]:
    """Every record of a run in the order of its segments, headers first, each other one once."""
    found = [(path, scan(read_content(path))) for path in run_segments(directory).values()]
    headers = [entry for path, part in found for entry in entries(path, part) if entry.topic == RUN]
    yield from headers or [Entry(RUN, 0, 0, run.header)]
    seen: set[tuple[str, int]] = set()
    for path, part in found:
        for entry in entries(path, part):
            if entry.topic != RUN and (entry.topic, entry.sequence) not in seen:
                seen.add((entry.topic, entry.sequence))
                yield entry
