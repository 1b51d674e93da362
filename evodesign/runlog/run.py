"""Opening a run: all its segments as one; and one short text that stands for everything it has found.

Two runs have the same digest exactly when their evaluations agree in number, generation, genome and outcome:
times, names of workers, order of arrival and number of sessions do not count.
"""

from __future__ import annotations

import gc
import hashlib
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TypeVar

import msgspec

from evodesign.errors import InputError, RunError
from evodesign.records import NO_SECONDS, Detail, Evaluation, Front, Generation, RunHeader
from evodesign.runlog.channels import known_as
from evodesign.runlog.directory import run_segments, segments
from evodesign.runlog.gaps import record_gaps, segment_gaps
from evodesign.runlog.header import differences
from evodesign.runlog.reader import Segment, read_segment
from evodesign.runlog.validity import Validity

R = TypeVar("R", bound=msgspec.Struct)


@dataclass(frozen=True, slots=True)
class RunLog:
    """What a run's directory holds.

    Args:
        directory: of the run.
        header: of the last segment, whose budget holds.
        evaluations: in order of number, each number once.
        generations: in order of number, each number once.
        fronts: in order of generation, each once.
        details: in order of evaluation, each once; every member of a front has one.
        complete: whether every segment is whole.
        notes: a sentence for everything that is missing or strange.
        faults: those of the notes that no kill explains; none while the run is still being written.
    """

    directory: Path
    header: RunHeader
    evaluations: tuple[Evaluation, ...]
    generations: tuple[Generation, ...]
    fronts: tuple[Front, ...]
    details: tuple[Detail, ...]
    complete: bool
    notes: tuple[str, ...]
    faults: tuple[str, ...] = ()

    def __repr__(self) -> str:
        return f"<log of {self.directory}: {len(self.evaluations)} evaluations>"

    @property
    def damaged(self) -> bool:
        """Whether records that were written are lost or changed, so that the front may be another one."""
        return bool(self.faults)

    def evaluation(self, number: int) -> Evaluation:
        """The evaluation of a number.

        Raises:
            InputError: the run has none.
        """
        for evaluation in self.evaluations:
            if evaluation.number == number:
                return evaluation
        wanted = f"a design of {self.directory}, which has {len(self.evaluations)}"
        raise InputError("number", "", wanted, f"{number}")


@contextmanager
def _without_collector() -> Iterator[None]:
    """Within this, Python looks for no unreachable cycles.

    Records make none, and to look through all of a large run again and again takes as long as to read it.
    """
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_enabled:
            gc.enable()


@_without_collector()
def read_run(directory: Path) -> RunLog:
    """Everything that can be read of a run, also of one that was killed or is still being written.

    Raises:
        RunError: the directory is missing or is not a run, none of its headers can be read,
            a later version of evodesign wrote it, or its segments come from different runs.
    """
    paths = run_segments(directory)
    read = [read_segment(path, last=number == max(paths)) for number, path in paths.items()]
    headers = _headers(directory, read)
    strange: list[str] = []
    read = [_valid(segment, Validity(headers[-1]), strange) for segment in read]
    evaluations, contradictions = _by_number(read)
    generations = _first_of_each(generation for segment in read for generation in segment.generations)
    fronts = _first_of_each(front for segment in read for front in segment.fronts)
    details = _first_of_each(detail for segment in read for detail in segment.details)
    sessions = [session for segment in read for session in segment.sessions]
    faults = (
        *(segment.note for segment in read if segment.damaged),
        *strange,
        *segment_gaps(paths, sessions),
        *record_gaps(headers[-1], evaluations, generations, fronts),
        *contradictions,
    )
    return RunLog(
        directory=directory,
        header=headers[-1],
        evaluations=evaluations,
        generations=generations,
        fronts=fronts,
        details=details,
        complete=all(segment.complete for segment in read),
        notes=tuple(dict.fromkeys((*(segment.note for segment in read if segment.note), *faults))),
        faults=faults,
    )


def refuse_run(directory: Path) -> None:
    """Refuse a directory that holds a run, or what is left of one.

    Raises:
        RunError: it does. The sentence says to resume only a run that can be read.
    """
    if segments(directory):
        read_run(directory)
        raise RunError(
            f"{directory}: holds a run already; choose another directory with --run, "
            f"or go on with: evodesign resume {directory}"
        )


def _headers(directory: Path, segments: list[Segment]) -> list[RunHeader]:
    """Headers of the segments that have one, all of the same problem and search."""
    headed = [(segment.path.name, header) for segment in segments for header in segment.headers]
    if not headed:
        raise RunError(
            f"{directory}: the header of {segments[0].path.name} cannot be read, so nothing of this run can; "
            "remove the directory, or choose another one with --run"
        )
    first_name, first = headed[0]
    for name, header in headed:
        if differing := differences(first, header):
            raise RunError(
                f"{directory}: {name} is of another problem or search than {first_name}: "
                f"{'; '.join(differing)}; take it out of the directory"
            )
    return [header for _, header in headed]


def _valid(segment: Segment, validity: Validity, strange: list[str]) -> Segment:
    """A segment without the records that contradict the header, on which there is a note then."""
    faults: list[str] = []

    def kept(records: tuple[R, ...]) -> tuple[R, ...]:
        wrong = {place: fault for place, record in enumerate(records) if (fault := validity.fault(record))}
        faults.extend(wrong.values())
        return tuple(each for place, each in enumerate(records) if place not in wrong) if wrong else records

    valid = replace(
        segment,
        evaluations=kept(segment.evaluations),
        generations=kept(segment.generations),
        fronts=kept(segment.fronts),
        details=kept(segment.details),
    )
    if faults:
        many = f"{len(faults)} records contradict" if len(faults) > 1 else "a record contradicts"
        strange.append(f"{segment.path.name}: {many} the header and are left out ({faults[0]})")
    return valid


def _by_number(segments: list[Segment]) -> tuple[tuple[Evaluation, ...], list[str]]:
    """Evaluations in order of number, and a note for each number that came back with another content."""
    kept: dict[int, Evaluation] = {}
    notes = []
    for segment in segments:
        for evaluation in segment.evaluations:
            first = kept.setdefault(evaluation.number, evaluation)
            if (first.genome, first.assessment) != (evaluation.genome, evaluation.assessment):
                notes.append(
                    f"evaluation {evaluation.number} stands again in {segment.path.name} "
                    "with another content; the first one holds"
                )
    return tuple(kept[number] for number in sorted(kept)), notes


def _first_of_each(records: Iterable[R]) -> tuple[R, ...]:
    kept: dict[tuple[str, int], R] = {}
    for record in records:
        kept.setdefault(known_as(record), record)
    return tuple(kept[known] for known in sorted(kept))


def digest(evaluations: Iterable[Evaluation]) -> str:
    """SHA-256, in hexadecimal, of the evaluations in the order given, without times and workers."""
    found = hashlib.sha256()
    for evaluation in evaluations:
        bare = msgspec.structs.replace(evaluation, seconds=0.0, worker="", gradient_seconds=NO_SECONDS)
        found.update(msgspec.json.encode(bare, order="deterministic") + b"\n")
    return found.hexdigest()
