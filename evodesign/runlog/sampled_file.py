"""The file in a run's directory that keeps how designs did beside samples of people.

It stands beside the log, so that neither the replay of a search nor its digest know of it. What lies there is
checked before it is believed, as a log is: a regular file of a limited size, of this run's problem, with
designs of this run.
"""

from __future__ import annotations

import os
import stat
from pathlib import Path

import msgspec

from evodesign.errors import RunError
from evodesign.files import write_whole
from evodesign.identity import digest
from evodesign.records import SampledDesign, SampledPeople
from evodesign.runlog.run import RunLog

SAMPLED_FILE = "spread.json"

LARGEST = 2**26
"""Bytes of a file that is read."""


def read_sampled(run: RunLog) -> tuple[SampledPeople | None, tuple[str, ...]]:
    """What is kept of samples of people of a run, None if nothing is; and notes on what is strange."""
    path = run.directory / SAMPLED_FILE
    try:
        content = _content(path)
    except FileNotFoundError:
        return None, ()
    except (OSError, ValueError) as error:
        return None, (f"{path}: samples of people cannot be read ({error})",)
    try:
        found = msgspec.json.decode(content, type=SampledPeople)
    except (msgspec.DecodeError, RecursionError) as error:
        return None, (f"{path}: samples of people cannot be read ({error})",)
    if found.problem != digest(run.header.problem):
        return None, (f"{path}: the samples of people are of another problem",)
    designs = {each.number: each.assessment.design for each in run.evaluations}
    names = {each.name for each in run.header.objectives}
    kept: dict[tuple[int, int], SampledDesign] = {}
    for each in found.designs:
        own = each.assessment.design == designs.get(each.design)
        if own and each.sample >= 1 and names.issuperset(each.assessment.objectives):
            kept.setdefault((each.sample, each.design), each)
    strange = len(found.designs) - len(kept)
    notes = (f"{path}: {strange} samples are of no design of this run and are left out",) if strange else ()
    reference = found.reference if found.reference in designs else None
    return msgspec.structs.replace(found, designs=tuple(kept.values()), reference=reference), notes


def _content(path: Path) -> bytes:
    """A regular file of a limited size, without following a link."""
    descriptor = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC)
    with os.fdopen(descriptor, "rb") as file:
        about = os.fstat(descriptor)
        if not stat.S_ISREG(about.st_mode):
            raise ValueError("it is no regular file")
        if about.st_size > LARGEST:
            raise ValueError(f"it has more than {LARGEST} bytes")
        return file.read(LARGEST)


def write_sampled(run: RunLog, sampled: SampledPeople) -> None:
    """Keep samples of people, in the place of those before.

    Raises:
        RunError: the file cannot be written.
    """
    path = run.directory / SAMPLED_FILE
    try:
        write_whole(path, msgspec.json.encode(sampled), follow=False)
    except OSError as error:
        raise RunError(f"{path}: cannot be written: {error.strerror}") from error
