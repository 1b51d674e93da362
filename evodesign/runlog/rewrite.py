"""Writing a run anew: all of it into one whole, indexed file, or its beginning into a new run.

Recovering writes a new run beside a damaged one; merging puts one segment in the place of many. Messages keep
their times, and their bytes unless they are of an earlier format.

A branch is a new run that begins with the first generations of another one. Its log holds them as its own, so
that it stands by itself, is resumed by replay like any other, and solves nothing twice. What the search was
for those generations is kept in its settings as a stage.
"""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator
from pathlib import Path

import msgspec
from mcap.writer import CompressionType, Writer

from evodesign.errors import InputError, RunError
from evodesign.files import replacing
from evodesign.records import RunHeader, SearchSettings, SearchStage
from evodesign.runlog.channels import RUN, known_as
from evodesign.runlog.directory import locked, make_directory, run_segments, segment_path, synced
from evodesign.runlog.gaps import record_gaps
from evodesign.runlog.reader import Entry, entries
from evodesign.runlog.run import RunLog, read_run, refuse_run
from evodesign.runlog.writer import UNFINISHED, add_header_copy, encoded, register

CHUNK_BYTES = 65536
"""Records are compressed together in chunks of this size: about 0.5 kB per evaluation instead of 1.0 kB."""

MERGING = "merged.part"


def recover(directory: Path, to: Path) -> RunLog:
    """Write all that can be read of a run to a new directory.

    Raises:
        RunError: nothing can be read, or the new directory holds a run or cannot be written.
    """
    run = read_run(directory)
    refuse_run(to)
    make_directory(to)
    with locked(to):
        _write(segment_path(to, 0), run.header, _once(directory, run), UNFINISHED)
        synced(to, to.parent)
    return read_run(to)


def merge(directory: Path, to: Path | None) -> RunLog:
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
        if to.exists():
            raise RunError(f"{to}: exists already")
        _write(to, run.header, _once(directory, run))
        return run
    paths = run_segments(directory)
    with locked(directory):
        run = _undamaged(directory)
        _write(segment_path(directory, 0), run.header, _once(directory, run), MERGING)
        try:
            synced(directory)
            for number, path in paths.items():
                if number > 0:
                    path.unlink()
            synced(directory)
        except OSError as error:
            raise RunError(f"{directory}: cannot be merged: {error.strerror}") from error
    return read_run(directory)


def _undamaged(directory: Path) -> RunLog:
    """The run, whose files are all there; records that it lacks it lacks in one file too."""
    run = read_run(directory)
    gaps = record_gaps(run.header, run.evaluations, run.generations, run.fronts)
    fault = next((fault for fault in run.faults if fault not in gaps), None)
    if fault is not None:
        raise RunError(f"{directory}: {fault}; save what can be read first: evodesign recover {directory}")
    return run


def _write(path: Path, header: RunHeader, records: Iterable[Entry], part: str = "") -> None:
    """Records, with those of headers first, as one segment that is on the disk when this returns."""
    try:
        with replacing(path, part) as file:
            writer = Writer(
                file, chunk_size=CHUNK_BYTES, compression=CompressionType.ZSTD, enable_data_crcs=True
            )
            writer.start(profile="", library="evodesign")
            channels = register(writer, header)
            latest = 0
            for entry in records:
                latest = max(latest, entry.time)
                writer.add_message(
                    channels[entry.topic], latest, encoded(entry.record), latest, entry.sequence
                )
            add_header_copy(writer, header, latest)
            writer.finish()  # type: ignore[no-untyped-call]
    except OSError as error:
        raise RunError(f"{path}: cannot be written: {error.strerror}") from error


def _once(directory: Path, run: RunLog) -> Iterator[Entry]:
    """Every record of a run in the order of its segments, headers first, each other one once."""
    paths = run_segments(directory).values()
    headers = [entry for path in paths for entry in entries(path) if entry.topic == RUN]
    yield from headers or [Entry(RUN, 0, 0, run.header)]
    records = (*run.evaluations, *run.generations, *run.fronts, *run.details)
    left = {known_as(record): record for record in records}
    for path in paths:
        for entry in entries(path):
            if entry.topic != RUN and left.get(known := known_as(entry.record)) == entry.record:
                del left[known]
                yield entry


def begin_branch(old: RunLog, directory: Path, generations: int, settings: SearchSettings) -> int:
    """Write the beginning of a branch.

    Args:
        old: the run to leave.
        directory: of the new run; made when missing.
        generations: how many generations the new run takes over.
        settings: of the search from there on. If they are the old run's, the new run goes its way again.
    Returns:
        How many evaluations were taken over.
    Raises:
        InputError: the old run has not so many generations, or the population is larger than the past.
        RunError: the directory holds a run already, or cannot be written.
    """
    if old.header.search.asynchronous:
        raise InputError("--branch-from", "", "a run with generations", f"the asynchronous {old.directory}")
    count = _evaluations_of(old, generations)
    if settings.population > count:
        raise InputError(
            "--population", "", f"at most {count}, the evaluations taken over", str(settings.population)
        )
    search = _with_past(old.header.search, generations, settings)
    refuse_run(directory)
    make_directory(directory)
    header = msgspec.structs.replace(old.header, search=search)
    with locked(directory):
        _write(segment_path(directory, 0), header, _beginning(old, header, generations, count), UNFINISHED)
        synced(directory, directory.parent)
    return count


def _beginning(old: RunLog, header: RunHeader, generations: int, count: int) -> Iterator[Entry]:
    """The records of a branch's first generations, which were not written at the times of the old ones."""
    now = time.time_ns()
    yield Entry(RUN, 0, now, header)
    details = (detail for detail in old.details if detail.evaluation < count)
    concluded = (*old.generations[:generations], *old.fronts[:generations])
    for record in (*details, *old.evaluations[:count], *concluded):
        topic, number = known_as(record)
        yield Entry(topic, number, now, record)


def _evaluations_of(old: RunLog, generations: int) -> int:
    """Evaluations of the first generations, all of which must be there."""
    whole = 0
    for number, (generation, front) in enumerate(zip(old.generations, old.fronts, strict=False)):
        known = len(old.evaluations) >= generation.evaluations
        if generation.number != number or front.generation != number or not known:
            break
        if old.evaluations[generation.evaluations - 1].number != generation.evaluations - 1:
            break
        whole = number + 1
    if generations > whole:
        wanted = f"at most {whole}, the whole generations of {old.directory}"
        raise InputError("--branch-from", "", wanted, str(generations))
    return old.generations[generations - 1].evaluations


def _with_past(before: SearchSettings, generations: int, after: SearchSettings) -> SearchSettings:
    """The settings after a turn, with the settings before as their last stage."""
    if after == before:
        return before
    stages = []
    left = generations
    for stage in before.past:
        stages.append(msgspec.structs.replace(stage, generations=min(stage.generations, left)))
        left -= stages[-1].generations
        if left == 0:
            break
    if left > 0:
        stages.append(
            SearchStage(
                algorithm=before.algorithm, population=before.population, seed=before.seed, generations=left
            )
        )
    return msgspec.structs.replace(after, past=tuple(stages))
