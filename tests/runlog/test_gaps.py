"""What a run lacks is said as far as it can be known, and nothing is missed in a run that was only killed."""

from __future__ import annotations

from pathlib import Path

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from evodesign.errors import RunError
from evodesign.evolve import resume, start
from evodesign.records import Evaluation, Turn
from evodesign.runlog.gaps import consecutive, listed, missing, segment_gaps
from evodesign.runlog.rewrite import merge
from evodesign.runlog.run import read_run
from evodesign.runlog.session_log import Observer, Silent
from evodesign.runlog.writer import RunWriter
from tests.faults.synthetic import synthetic_header
from tests.runlog.toys import OrderedPool, ToyTask, shuffled, toy_evaluations, toy_front, toy_generation

HEADER = synthetic_header(budget=60, seed=4, population=12)


def sessions(directory: Path, *budgets: int) -> Path:
    """A run of so many sessions, with evaluations that come in any order."""
    header = msgspec.structs.replace(HEADER, budget=budgets[0])
    start(directory, header, ToyTask(header), OrderedPool(shuffled(1)), Silent())
    for budget in budgets[1:]:
        resume(directory, ToyTask, OrderedPool(shuffled(1)), Silent(), budget)
    return directory


@given(numbers=st.sets(st.integers(0, 60)), end=st.integers(0, 70))
def test_missing_numbers_are_those_that_are_not_known(numbers: set[int], end: int) -> None:
    found = missing(numbers, end)
    assert [each for part in found for each in part] == [each for each in range(end) if each not in numbers]
    assert found == consecutive(set(range(end)) - numbers)


def test_a_long_list_of_gaps_ends_with_a_count() -> None:
    assert listed(consecutive([3, 7, 8, 9])) == "3, 7 to 9"
    assert listed(consecutive(range(0, 1000, 2))).endswith(", 38, and 480 more")


def test_a_removed_segment_and_its_evaluations_are_missed(tmp_path: Path) -> None:
    run = sessions(tmp_path / "run", 24, 48, 60)
    assert (read_run(run).notes, read_run(run).damaged) == ((), False)
    (run / "001.mcap").unlink()
    assert read_run(run).faults == (
        "segment 1 of the run is missing",
        "missing evaluations: 24 to 47",
        "missing states of generations: 2 to 3",
        "missing fronts of generations: 2 to 3",
    )
    with pytest.raises(RunError, match=r"segment 1 of the run is missing; save .* evodesign recover"):
        merge(run, None)


def test_an_emptied_segment_is_told_with_what_is_lost(tmp_path: Path) -> None:
    run = sessions(tmp_path / "run", 9, 48, 60)
    (run / "001.mcap").write_bytes(b"")
    read = read_run(run)
    assert read.notes[0] == (
        "001.mcap is empty: its session was killed before it wrote, or what it wrote is lost"
    )
    assert read.faults[0] == "missing evaluations: 9 to 47"


def test_a_resumed_run_repeats_what_is_missing_and_still_tells_of_the_lost_file(tmp_path: Path) -> None:
    run = sessions(tmp_path / "run", 24, 48, 60)
    (run / "001.mcap").unlink()
    again = resume(run, ToyTask, OrderedPool(), Silent(), None)
    assert len(again.evaluations) == 60
    assert again.faults == ("segment 1 of the run is missing",)


def test_segments_that_a_merge_was_killed_before_removing_are_not_missed(tmp_path: Path) -> None:
    run = sessions(tmp_path / "run", 24, 48, 60)
    kept = (run / "002.mcap").read_bytes()
    merge(run, None)
    (run / "002.mcap").write_bytes(kept)
    assert read_run(run).notes == ()


def test_missing_segments_are_counted() -> None:
    assert segment_gaps([0, 1, 2], []) == []
    assert segment_gaps([0, 2, 5], [0, 1, 2]) == ["segments 3 to 4 of the run are missing"]


class Reading(Observer):
    """Reads the run after every evaluation and generation, and keeps what it is told to be damaged."""

    def __init__(self, directory: Path) -> None:
        self.directory = directory
        self.reads = 0
        self.faults: list[str] = []

    def evaluated(self, evaluation: Evaluation, done: int, budget: int) -> None:
        self.reads += 1
        self.faults += read_run(self.directory).faults


@pytest.mark.parametrize("asynchronous", [False, True])
def test_a_run_that_is_being_written_lacks_nothing(asynchronous: bool, tmp_path: Path) -> None:
    search = msgspec.structs.replace(HEADER.search, asynchronous=asynchronous)
    header = msgspec.structs.replace(HEADER, search=search, budget=30)
    reading = Reading(tmp_path / "run")
    pool = OrderedPool() if asynchronous else OrderedPool(shuffled(2))
    start(tmp_path / "run", header, ToyTask(header), pool, reading)
    assert (reading.reads, reading.faults) == (30, [])


@pytest.mark.parametrize("asynchronous", [False, True])
def test_evaluations_of_a_generation_come_in_any_order_but_not_those_without_generations(
    asynchronous: bool, tmp_path: Path
) -> None:
    search = msgspec.structs.replace(HEADER.search, asynchronous=asynchronous)
    header = msgspec.structs.replace(HEADER, search=search)
    with RunWriter(tmp_path / "run", header) as log:
        for evaluation in toy_evaluations(header, 12)[5:]:
            turn = Turn(number=evaluation.number, told=evaluation.number) if asynchronous else None
            log.write(msgspec.structs.replace(evaluation, turn=turn))
    expected = ("missing evaluations: 0 to 4",) if asynchronous else ()
    assert read_run(tmp_path / "run").faults == expected


def test_evaluations_below_a_concluded_generation_or_a_member_of_its_front_are_missed(tmp_path: Path) -> None:
    with RunWriter(tmp_path / "states", HEADER) as log:
        log.write(toy_generation(0, 12))
    assert read_run(tmp_path / "states").faults == ("missing evaluations: 0 to 11",)
    with RunWriter(tmp_path / "fronts", HEADER) as log:
        log.write(toy_front(1))
    assert read_run(tmp_path / "fronts").faults == (
        "missing evaluations: 0 to 1",
        "missing fronts of generations: 0",
    )
