"""The file of samples of people beside a log: what is written is read back, what others put there is not."""

from __future__ import annotations

import os
from pathlib import Path

import msgspec
import pytest

from evodesign.identity import digest
from evodesign.records import SampledDesign, SampledPeople
from evodesign.runlog import sampled_file
from evodesign.runlog.run import RunLog, read_run
from evodesign.runlog.sampled_file import SAMPLED_FILE, read_sampled, write_sampled
from evodesign.runlog.writer import RunWriter
from tests.runlog.toys import toy_evaluations, toy_header


@pytest.fixture
def run(tmp_path: Path) -> RunLog:
    header = toy_header()
    with RunWriter(tmp_path / "run", header) as log:
        for evaluation in toy_evaluations(header, 6):
            log.write(evaluation)
    return read_run(tmp_path / "run")


def some(run: RunLog) -> SampledPeople:
    designs = tuple(
        SampledDesign(sample=sample, design=each.number, assessment=each.assessment, seconds=0.5)
        for sample in (1, 2)
        for each in run.evaluations[2:4]
    )
    return SampledPeople(
        problem=digest(run.header.problem),
        versions={"evodesign": "0"},
        samples=2,
        reference=2,
        designs=designs,
    )


def test_what_is_written_is_read_back_and_the_log_stays_as_it_was(run: RunLog) -> None:
    assert read_sampled(run) == (None, ())
    write_sampled(run, some(run))
    assert read_sampled(run) == (some(run), ())
    assert read_run(run.directory) == run


def test_samples_of_another_problem_are_not_believed(run: RunLog) -> None:
    write_sampled(run, msgspec.structs.replace(some(run), problem="another"))
    found, notes = read_sampled(run)
    assert found is None
    assert "of another problem" in notes[0]


def test_samples_of_no_design_of_the_run_are_left_out(run: RunLog) -> None:
    good = some(run)
    first = good.designs[0]
    strange = [
        msgspec.structs.replace(first, design=99),
        msgspec.structs.replace(first, design=4),
        msgspec.structs.replace(first, sample=0),
        first,
        msgspec.structs.replace(
            first, sample=3, assessment=msgspec.structs.replace(first.assessment, objectives={"beauty": 1.0})
        ),
    ]
    write_sampled(run, msgspec.structs.replace(good, designs=(*good.designs, *strange), reference=99))
    found, notes = read_sampled(run)
    assert found == msgspec.structs.replace(good, reference=None)
    assert "5 samples are of no design of this run" in notes[0]


@pytest.mark.parametrize("content", [b"", b"{", b"[" * 100_000, b'{"problem": 1}', b"\xff\xfe"])
def test_nonsense_is_a_note(run: RunLog, content: bytes) -> None:
    (run.directory / SAMPLED_FILE).write_bytes(content)
    found, notes = read_sampled(run)
    assert found is None
    assert "cannot be read" in notes[0]


def test_no_link_pipe_or_folder_is_read_and_a_link_is_not_written_through(
    run: RunLog, tmp_path: Path
) -> None:
    path, elsewhere = run.directory / SAMPLED_FILE, tmp_path / "elsewhere"
    elsewhere.write_bytes(msgspec.json.encode(some(run)))
    path.symlink_to(elsewhere)
    assert read_sampled(run)[0] is None
    before = elsewhere.read_bytes()
    write_sampled(run, msgspec.structs.replace(some(run), samples=7))
    assert elsewhere.read_bytes() == before
    path.unlink()
    os.mkfifo(path)
    assert "no regular file" in read_sampled(run)[1][0]
    path.unlink()
    path.mkdir()
    assert read_sampled(run)[0] is None


def test_a_huge_file_is_not_read(run: RunLog, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sampled_file, "LARGEST", 100)
    write_sampled(run, some(run))
    found, notes = read_sampled(run)
    assert found is None
    assert "more than 100 bytes" in notes[0]
