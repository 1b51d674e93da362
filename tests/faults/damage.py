"""Cutting and changing logs, and what must then still be true of what is read."""

from __future__ import annotations

import random
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from evodesign.evolve import start
from evodesign.runlog.reader import Segment, read_segment
from evodesign.runlog.session_log import Silent
from tests.faults.synthetic import Synthetic, synthetic_header
from tests.rewriting import write_anew
from tests.runlog.toys import OrderedPool, shuffled


@dataclass
class Report:
    """How many logs were read, and how many evaluations the worst of them had lost."""

    logs: int = 0
    most_lost: int = 0
    unharmed: int = 0


def write_log(folder: Path, evaluations: int) -> bytes:
    """A finished log whose evaluations arrived in any order."""
    header = synthetic_header(evaluations, seed=1)
    start(folder / "run", header, Synthetic(header, 0.0), OrderedPool(shuffled(1)), Silent())
    return (folder / "run" / "000.mcap").read_bytes()


def cut(folder: Path, content: bytes, lengths: Iterable[int]) -> Report:
    """A log cut off gives a prefix of what was written, and says that something is missing."""
    whole = _read(folder, content)
    report, before = Report(), -1
    for length in lengths:
        segment = _read(folder, content[:length])
        count = len(segment.evaluations)
        assert segment.evaluations == whole.evaluations[:count]
        assert segment.generations == whole.generations[: len(segment.generations)]
        assert segment.details == whole.details[: len(segment.details)]
        assert not segment.complete
        assert not segment.damaged
        assert f"ends after {count} evaluations" in segment.note or not segment.headers
        assert count >= before, "a longer log holds more"
        before = count
        report.logs += 1
        report.most_lost = max(report.most_lost, len(whole.evaluations) - count)
    return report


def flip(folder: Path, content: bytes, count: int, seed: int) -> Report:
    """A log with one changed byte gives a subset of what was written, and says that it is damaged."""
    whole = _read(folder, content)
    assert whole.complete
    written = {evaluation.number: evaluation for evaluation in whole.evaluations}
    generator, report, lengths = random.Random(seed), Report(), set(_lengths(content))
    for _ in range(count):
        changed, place = bytearray(content), generator.randrange(len(content))
        changed[place] ^= generator.randrange(1, 256)
        segment = _read(folder, bytes(changed))
        assert all(written[each.number] == each for each in segment.evaluations)
        assert all(each in whole.details for each in segment.details)
        assert all(each in whole.generations for each in segment.generations)
        assert all(each in whole.fronts for each in segment.fronts)
        assert segment.headers == whole.headers or place in lengths
        assert not segment.complete
        assert segment.note
        lost = len(written) - len(segment.evaluations)
        before = segment.evaluations == whole.evaluations[: len(segment.evaluations)]
        assert lost <= 1 or (place in lengths and before), "one byte costs one evaluation, or all behind it"
        report.logs += 1
        report.most_lost = max(report.most_lost, lost)
        report.unharmed += lost == 0
    return report


def _lengths(content: bytes) -> Iterator[int]:
    """Places of kinds and lengths of records, by which the next record is found."""
    place = 8
    while place < len(content) - 8:
        yield from range(place, place + 9)
        place += 9 + int.from_bytes(content[place + 1 : place + 9], "little")


def _read(folder: Path, content: bytes) -> Segment:
    path = folder / "changed.mcap"
    write_anew(path, content)
    return read_segment(path)
