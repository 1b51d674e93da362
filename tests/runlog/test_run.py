from __future__ import annotations

import gc
import subprocess
import sys
from pathlib import Path

import msgspec
import pytest

from evodesign.errors import RunError
from evodesign.records import FORMAT_VERSION, Evaluation, RunHeader
from evodesign.runlog.directory import locked
from evodesign.runlog.run import read_run
from evodesign.runlog.writer import RunWriter
from tests.runlog.toys import toy_evaluations, toy_front, toy_generation, toy_header

HEADER = toy_header()
EVALUATIONS = toy_evaluations(HEADER, 8)


def write(directory: Path, evaluations: list[Evaluation], header: RunHeader = HEADER) -> Path:
    """A further segment with these evaluations."""
    with RunWriter.next_segment(directory, header) as log:
        for evaluation in evaluations:
            log.write(evaluation)
        return log.path


def test_a_run_is_all_its_segments_as_one(tmp_path: Path) -> None:
    first = write(tmp_path / "run", EVALUATIONS[:3])
    second = write(tmp_path / "run", EVALUATIONS[3:])
    assert [first.name, second.name] == ["000.mcap", "001.mcap"]
    run = read_run(tmp_path / "run")
    assert list(run.evaluations) == EVALUATIONS
    assert (run.complete, run.notes) == (True, ())


def test_the_budget_of_the_last_session_holds(tmp_path: Path) -> None:
    write(tmp_path / "run", EVALUATIONS[:3])
    larger = msgspec.structs.replace(HEADER, budget=99, versions={"evodesign": "1"}, git="abc", started="now")
    write(tmp_path / "run", [], larger)
    assert read_run(tmp_path / "run").header == larger


def test_what_overlapping_segments_repeat_is_read_once_and_in_order(tmp_path: Path) -> None:
    write(tmp_path / "run", EVALUATIONS[4:])
    write(tmp_path / "run", EVALUATIONS[:6])
    with RunWriter.next_segment(tmp_path / "run", HEADER) as log:
        for number in (1, 0, 1):
            log.write(toy_generation(number, 4))
            log.write(toy_front(number))
    run = read_run(tmp_path / "run")
    assert list(run.evaluations) == EVALUATIONS
    assert [generation.number for generation in run.generations] == [0, 1]
    assert [front.generation for front in run.fronts] == [0, 1]
    assert (run.notes, run.damaged) == ((), False)


def test_an_evaluation_that_comes_back_changed_is_noted_and_the_first_holds(tmp_path: Path) -> None:
    write(tmp_path / "run", EVALUATIONS[:2])
    same = msgspec.structs.replace(EVALUATIONS[0], seconds=9.0, worker="elsewhere")
    changed = msgspec.structs.replace(EVALUATIONS[1], genome=(0.5, 0.5))
    write(tmp_path / "run", [same, changed])
    run = read_run(tmp_path / "run")
    assert list(run.evaluations) == EVALUATIONS[:2]
    assert len(run.notes) == 1
    assert "evaluation 1 stands again in 001.mcap" in run.notes[0]
    assert run.damaged


def test_a_killed_session_costs_its_tail_only(tmp_path: Path) -> None:
    path = write(tmp_path / "run", EVALUATIONS[:4])
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    write(tmp_path / "run", EVALUATIONS[4:])
    run = read_run(tmp_path / "run")
    assert [evaluation.number for evaluation in run.evaluations][-4:] == [4, 5, 6, 7]
    assert not run.complete
    assert "000.mcap ends after" in run.notes[0]


def test_a_later_segment_without_a_header_holds_nothing_but_stops_nothing(tmp_path: Path) -> None:
    write(tmp_path / "run", EVALUATIONS[:4])
    (tmp_path / "run/001.mcap").write_bytes(b"")
    assert write(tmp_path / "run", EVALUATIONS[4:]).name == "002.mcap"
    run = read_run(tmp_path / "run")
    assert list(run.evaluations) == EVALUATIONS
    assert run.notes == (
        "001.mcap is empty: its session was killed before it wrote, or what it wrote is lost",
    )
    assert not run.damaged


def test_what_is_not_a_run_is_refused_in_a_sentence(tmp_path: Path) -> None:
    with pytest.raises(RunError, match="missing: there is no such run directory"):
        read_run(tmp_path / "missing")
    (tmp_path / "empty").mkdir()
    with pytest.raises(RunError, match="empty: is not a run"):
        read_run(tmp_path / "empty")
    (tmp_path / "file").write_text("x")
    with pytest.raises(RunError, match="file: wanted the directory of a run, found a file"):
        read_run(tmp_path / "file")
    (tmp_path / "headless").mkdir()
    (tmp_path / "headless/000.mcap").write_bytes(b"not an MCAP file at all")
    with pytest.raises(RunError, match=r"header of 000\.mcap cannot be read"):
        read_run(tmp_path / "headless")
    write(tmp_path / "later", [], msgspec.structs.replace(HEADER, format_version=FORMAT_VERSION + 1))
    with pytest.raises(RunError, match="later evodesign"):
        read_run(tmp_path / "later")


def test_segments_of_two_runs_do_not_make_one(tmp_path: Path) -> None:
    write(tmp_path / "run", EVALUATIONS[:4])
    write(tmp_path / "run", EVALUATIONS[4:], toy_header(seed=2))
    with pytest.raises(RunError, match=r"001\.mcap is of another problem or search than 000\.mcap"):
        read_run(tmp_path / "run")


def test_a_run_is_locked_against_a_second_writer_until_it_is_released(tmp_path: Path) -> None:
    refused = pytest.raises(RunError, match="another evodesign is writing this run")
    with locked(tmp_path), refused, locked(tmp_path):
        pass
    with locked(tmp_path):
        pass


def test_reading_a_run_does_not_import_casadi() -> None:
    code = (
        "import sys, evodesign.runlog.run, evodesign.runlog.writer, evodesign.runlog.session_log;"
        "sys.exit(any(name.split('.')[0] in ('casadi', 'pinocchio', 'pymoo') for name in sys.modules))"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_a_long_session_goes_on_in_a_further_segment(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("evodesign.runlog.writer.LONGEST_SEGMENT", 4)
    evaluations = toy_evaluations(HEADER, 11)
    with RunWriter(tmp_path / "run", HEADER) as log:
        for evaluation in evaluations:
            log.write(evaluation)
            log.commit()
    assert sorted(path.name for path in (tmp_path / "run").iterdir()) == [
        f"00{each}.mcap" for each in range(4)
    ]
    run = read_run(tmp_path / "run")
    assert list(run.evaluations) == evaluations
    assert (run.complete, run.notes) == (True, ())


@pytest.mark.parametrize("enabled", [True, False])
def test_the_collector_of_cycles_is_as_it_was_when_a_run_was_read_or_refused(
    enabled: bool, tmp_path: Path
) -> None:
    with RunWriter(tmp_path / "run", HEADER):
        pass
    was_enabled = gc.isenabled()
    try:
        (gc.enable if enabled else gc.disable)()
        read_run(tmp_path / "run")
        with pytest.raises(RunError):
            read_run(tmp_path / "none")
        assert gc.isenabled() == enabled
    finally:
        (gc.enable if was_enabled else gc.disable)()
