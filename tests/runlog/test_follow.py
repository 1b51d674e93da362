"""Following a run: everything that was written comes once, in order, however the file grows."""

from __future__ import annotations

import random
from pathlib import Path

import pytest

from evodesign.errors import RunError
from evodesign.records import Evaluation, RunHeader
from evodesign.runlog.follow import Follower
from evodesign.runlog.reader import read_segment
from evodesign.runlog.writer import RunWriter
from tests.rewriting import write_anew
from tests.runlog.toys import toy_detail, toy_evaluations, toy_front, toy_generation, toy_header

HEADER = toy_header()
EVALUATIONS = toy_evaluations(HEADER, 12)


def write(writer: RunWriter, evaluations: list[Evaluation]) -> None:
    for evaluation in evaluations:
        writer.write(toy_detail(evaluation))
        writer.write(evaluation)
    writer.write(toy_generation(0, len(evaluations)))
    writer.write(toy_front(0))


def test_every_look_gives_what_was_written_since_the_last(tmp_path: Path) -> None:
    follower = None
    with RunWriter(tmp_path, HEADER) as writer:
        follower = Follower(tmp_path)
        assert [logged.record for logged in follower.look()] == [HEADER]
        for evaluation in EVALUATIONS:
            writer.write(evaluation)
            assert [logged.record for logged in follower.look()] == [evaluation]
            assert not follower.ended
        assert follower.look() == []
    assert follower.look() == []
    assert follower.ended
    assert follower.notes == ()


def test_a_file_that_grows_byte_by_byte_gives_what_the_reader_finds(tmp_path: Path) -> None:
    whole, growing = tmp_path / "whole", tmp_path / "growing"
    with RunWriter(whole, HEADER) as writer:
        write(writer, EVALUATIONS)
    content = (whole / "000.mcap").read_bytes()
    growing.mkdir()
    file = growing / "000.mcap"
    file.write_bytes(b"")
    follower = Follower(growing)
    chance = random.Random(1)
    found, length = [], 0
    while length < len(content):
        length = min(length + chance.randrange(1, 400), len(content))
        with file.open("ab") as end:
            end.write(content[file.stat().st_size : length])
        found += [logged.record for logged in follower.look()]
        evaluations = tuple(record for record in found if isinstance(record, Evaluation))
        assert evaluations == read_segment(file).evaluations
    segment = read_segment(file)
    assert follower.ended
    assert sum(isinstance(record, RunHeader) for record in found) == 1
    assert len(found) == 1 + sum(
        len(records)
        for records in (segment.evaluations, segment.generations, segment.fronts, segment.details)
    )


def test_a_resumed_run_goes_on_in_its_next_segment(tmp_path: Path) -> None:
    with RunWriter(tmp_path, HEADER) as writer:
        write(writer, EVALUATIONS[:4])
    follower = Follower(tmp_path)
    follower.look()
    assert follower.ended
    with RunWriter.next_segment(tmp_path, HEADER) as writer:
        writer.write(EVALUATIONS[4])
        assert [logged.record for logged in follower.look()] == [HEADER, EVALUATIONS[4]]
        assert not follower.ended


def test_damage_ends_a_segment_and_keeps_what_came_before(tmp_path: Path) -> None:
    with RunWriter(tmp_path, HEADER) as writer:
        write(writer, EVALUATIONS)
    file = tmp_path / "000.mcap"
    whole = file.read_bytes()
    noted = 0
    places = range(len(whole) // 3, len(whole) // 2, 97)  # among the evaluations; the index comes after
    for place in places:
        content = bytearray(whole)
        content[place] ^= 0xFF
        write_anew(file, content)
        follower = Follower(tmp_path)
        found = [each.record for each in follower.look() if isinstance(each.record, Evaluation)]
        assert found == list(EVALUATIONS[: len(found)])
        assert follower.look() == []
        noted += any(note.startswith("000.mcap cannot be read further") for note in follower.notes)
    assert noted > len(places) // 2, "a damaged length looks like a file that is still being written"


def test_looking_writes_nothing(tmp_path: Path) -> None:
    with RunWriter(tmp_path, HEADER) as writer:
        write(writer, EVALUATIONS)
    before = {path.name: (path.stat().st_mtime_ns, path.stat().st_size) for path in tmp_path.iterdir()}
    Follower(tmp_path).look()
    assert before == {
        path.name: (path.stat().st_mtime_ns, path.stat().st_size) for path in tmp_path.iterdir()
    }


def test_a_directory_without_a_run_is_refused(tmp_path: Path) -> None:
    with pytest.raises(RunError, match="is not a run"):
        Follower(tmp_path)
