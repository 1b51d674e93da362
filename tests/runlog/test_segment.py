from __future__ import annotations

import errno
import os
from io import BytesIO
from pathlib import Path

import jsonschema
import msgspec
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from mcap.opcode import Opcode
from mcap.reader import make_reader

from evodesign.errors import RunError
from evodesign.records import FORMAT_VERSION, Assessment, Evaluation, Status
from evodesign.runlog.channels import RECORDS
from evodesign.runlog.reader import read_segment
from evodesign.runlog.writer import RunWriter
from tests.rewriting import write_anew
from tests.runlog.toys import toy_detail, toy_evaluations, toy_front, toy_generation, toy_header

HEADER = toy_header()


def write_small_log(directory: Path) -> dict[int, int]:
    """A finished log of three generations of two evaluations; how many were committed at which file size."""
    evaluations = toy_evaluations(HEADER, 6)
    committed = {}
    with RunWriter(directory, HEADER) as log:
        committed[log.path.stat().st_size] = 0
        for number in range(3):
            for evaluation in evaluations[2 * number : 2 * number + 2]:
                if evaluation.number % 2:
                    log.write(toy_detail(evaluation))
                log.write(evaluation)
            log.write(toy_generation(number, 2 * number + 2))
            log.write(toy_front(number))
            log.commit()
            committed[log.path.stat().st_size] = 2 * number + 2
    return committed


def test_every_record_comes_back_as_it_was_written(tmp_path: Path) -> None:
    write_small_log(tmp_path / "run")
    segment = read_segment(tmp_path / "run/000.mcap")
    assert segment.headers == (HEADER,)
    assert list(segment.evaluations) == toy_evaluations(HEADER, 6)
    assert list(segment.generations) == [toy_generation(number, 2 * number + 2) for number in range(3)]
    assert list(segment.fronts) == [toy_front(number) for number in range(3)]
    assert list(segment.details) == [toy_detail(each) for each in segment.evaluations[1::2]]
    assert segment.complete
    assert segment.note == ""


finite = st.floats(allow_nan=False, allow_infinity=False)


@settings(max_examples=30, deadline=None)
@given(genome=st.tuples(finite, finite), reason=st.text(max_size=30), violation=st.none() | finite)
def test_numbers_and_texts_come_back_to_the_last_bit(
    tmp_path_factory: pytest.TempPathFactory,
    genome: tuple[float, float],
    reason: str,
    violation: float | None,
) -> None:
    assessment = Assessment(
        design={"a": genome[0]},
        objectives={"b": genome[1]},
        violation=violation,
        status=Status.WORKER_LOST,
        reason=reason,
    )
    evaluation = Evaluation(
        number=0, generation=0, genome=genome, assessment=assessment, seconds=0.0, worker=reason
    )
    directory = tmp_path_factory.mktemp("runs") / "run"
    with RunWriter(directory, HEADER) as log:
        log.write(evaluation)
    assert read_segment(directory / "000.mcap").evaluations == (evaluation,)


@pytest.mark.parametrize("step", [7, pytest.param(1, marks=pytest.mark.slow)])
def test_a_log_cut_at_any_byte_gives_everything_before_the_cut(step: int, tmp_path: Path) -> None:
    committed = write_small_log(tmp_path / "run")
    whole = (tmp_path / "run/000.mcap").read_bytes()
    evaluations = toy_evaluations(HEADER, 6)
    cut_file = tmp_path / "cut.mcap"
    cut_file.write_bytes(whole)
    counts = []
    for length in reversed(range(0, len(whole), step)):
        os.truncate(cut_file, length)
        segment = read_segment(cut_file)
        count = len(segment.evaluations)
        durable = max((known for size, known in committed.items() if size <= length), default=0)
        assert list(segment.evaluations) == evaluations[:count]
        assert count >= durable
        assert not segment.complete
        assert "its session was killed" in segment.note
        assert segment.headers == (HEADER,) or (segment.headers == () and length < min(committed))
        counts.append(count)
    assert counts == sorted(counts, reverse=True)
    assert set(counts) == set(range(7)), "each evaluation is safe by itself"


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(place=st.floats(0.0, 1.0, exclude_max=True), bit=st.integers(0, 7))
def test_a_flipped_bit_never_raises_nor_forges_an_evaluation(tmp_path: Path, place: float, bit: int) -> None:
    if not (tmp_path / "run").exists():
        write_small_log(tmp_path / "run")
    content = bytearray((tmp_path / "run/000.mcap").read_bytes())
    content[int(place * len(content))] ^= 1 << bit
    write_anew(tmp_path / "flipped.mcap", content)
    segment = read_segment(tmp_path / "flipped.mcap")
    written = {evaluation.number: evaluation for evaluation in toy_evaluations(HEADER, 6)}
    assert all(written[evaluation.number] == evaluation for evaluation in segment.evaluations)
    assert len(segment.evaluations) == 6 or not segment.complete
    assert segment.complete == (segment.note == "")


def test_a_chunk_that_no_longer_looks_like_one_is_missed(tmp_path: Path) -> None:
    committed = write_small_log(tmp_path / "run")
    content = bytearray((tmp_path / "run/000.mcap").read_bytes())
    place = min(committed)  # where the first evaluation's chunk begins
    assert content[place] == Opcode.CHUNK
    content[place] = 0xFF  # a private record, which every reader skips
    (tmp_path / "damaged.mcap").write_bytes(content)
    segment = read_segment(tmp_path / "damaged.mcap")
    assert list(segment.evaluations) == toy_evaluations(HEADER, 6)[1:]
    assert not segment.complete
    assert "bytes at" in segment.note


def test_the_plain_reader_reads_a_finished_segment(tmp_path: Path) -> None:
    write_small_log(tmp_path / "run")
    with (tmp_path / "run/000.mcap").open("rb") as file:
        messages = list(make_reader(file, validate_crcs=True).iter_messages())
    topics = [channel.topic for _, channel, _ in messages]
    assert topics[0] == "/run"
    assert {topic: topics.count(topic) for topic in topics} == {
        "/run": 1,
        "/evaluation": 6,
        "/generation": 3,
        "/front": 3,
        "/detail": 3,
    }
    for _, channel, message in messages:
        assert msgspec.json.decode(message.data, type=RECORDS[channel.topic])
        assert message.log_time > 1_600_000_000_000_000_000
    times = [message.log_time for _, _, message in messages]
    assert times == sorted(times)


def test_the_schemas_in_the_log_accept_its_messages_and_nothing_beside(tmp_path: Path) -> None:
    write_small_log(tmp_path / "run")
    content = (tmp_path / "run/000.mcap").read_bytes()
    for schema, channel, message in make_reader(BytesIO(content)).iter_messages():
        assert schema is not None
        assert (schema.encoding, channel.message_encoding) == ("jsonschema", "json")
        validator = jsonschema.Draft202012Validator(msgspec.json.decode(schema.data))
        record = msgspec.json.decode(message.data)
        validator.validate(record)
        assert not validator.is_valid(record | {"stranger": 1})
        assert not validator.is_valid({name: record[name] for name in list(record)[1:]})


def test_a_directory_that_holds_a_run_is_refused(tmp_path: Path) -> None:
    write_small_log(tmp_path / "run")
    before = (tmp_path / "run/000.mcap").read_bytes()
    with pytest.raises(RunError, match=r"run: holds a run already.*--run.*evodesign resume"):
        RunWriter(tmp_path / "run", HEADER)
    assert (tmp_path / "run/000.mcap").read_bytes() == before


def test_an_existing_segment_is_never_overwritten(tmp_path: Path) -> None:
    (tmp_path / "001.mcap").write_bytes(b"taken")
    with pytest.raises(RunError, match=r"001\.mcap: cannot be written: File exists"):
        RunWriter(tmp_path, HEADER, segment=1)
    assert (tmp_path / "001.mcap").read_bytes() == b"taken"


def test_a_run_directory_cannot_be_made_where_a_file_lies(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("here")
    with pytest.raises(RunError, match="cannot be made a run directory"):
        RunWriter(tmp_path / "file", HEADER)


def test_a_failed_write_is_one_sentence_and_leaves_what_was_before(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    evaluations = toy_evaluations(HEADER, 3)

    def full(descriptor: int) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with RunWriter(tmp_path / "run", HEADER) as log:
        log.write(evaluations[0])
        monkeypatch.setattr(os, "fsync", full)
        with pytest.raises(RunError, match=r"000\.mcap: cannot be written: No space left on device"):
            log.commit()
        with pytest.raises(RunError, match="earlier write was broken off"):
            log.write(evaluations[1])
    segment = read_segment(tmp_path / "run/000.mcap")
    assert segment.evaluations == (evaluations[0],)
    assert not segment.complete


def test_a_write_broken_off_by_ctrl_c_leaves_a_readable_log(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    evaluations = toy_evaluations(HEADER, 2)
    with RunWriter(tmp_path / "run", HEADER) as log:
        log.write(evaluations[0])
        with monkeypatch.context() as patch:
            patch.setattr("evodesign.runlog.writer.time.time_ns", _interrupt)
            with pytest.raises(KeyboardInterrupt):
                log.write(evaluations[1])
    assert read_segment(tmp_path / "run/000.mcap").evaluations == (evaluations[0],)


def _interrupt() -> int:
    raise KeyboardInterrupt


def test_a_log_of_a_later_format_is_refused(tmp_path: Path) -> None:
    later = msgspec.structs.replace(HEADER, format_version=FORMAT_VERSION + 1)
    RunWriter(tmp_path / "run", later).close()
    with pytest.raises(RunError, match=f"format {FORMAT_VERSION} or earlier, found format"):
        read_segment(tmp_path / "run/000.mcap")


def test_a_finished_log_of_a_realistic_design_stays_small(tmp_path: Path) -> None:
    header = toy_header(dimension=16)
    with RunWriter(tmp_path / "run", header) as log:
        for evaluation in toy_evaluations(header, 96):
            log.write(evaluation)
    assert (tmp_path / "run/000.mcap").stat().st_size < 96 * 1300
