from __future__ import annotations

import errno
import os
from dataclasses import replace
from io import BytesIO
from pathlib import Path

import msgspec
import pytest
from mcap.reader import make_reader

from evodesign.errors import InputError, RunError
from evodesign.evolve import replay, resume, start
from evodesign.records import RunHeader
from evodesign.runlog.directory import locked
from evodesign.runlog.rewrite import begin_branch, merge, recover
from evodesign.runlog.run import RunLog, digest, read_run
from evodesign.runlog.session_log import Silent
from evodesign.searches.registry import make_search
from tests.faults.synthetic import synthetic_header
from tests.runlog.toys import OrderedPool, ToyTask, essence, shuffled

HEADER = synthetic_header(budget=60, seed=4, population=10)


def write(directory: Path, *budgets: int) -> RunLog:
    """A run of so many sessions."""
    pool = OrderedPool(shuffled(1))
    run = None
    for budget in budgets:
        if run is None:
            header = msgspec.structs.replace(HEADER, budget=budget)
            run = start(directory, header, ToyTask(header), pool, Silent())
        else:
            run = resume(directory, ToyTask, pool, Silent(), budget, renew=renewed)
    assert run is not None
    return run


def renewed(header: RunHeader) -> RunHeader:
    return msgspec.structs.replace(header, versions={"evodesign": "later"})


def names(directory: Path) -> list[str]:
    return sorted(path.name for path in directory.iterdir())


def test_merged_segments_are_the_same_run_in_one_indexed_file(tmp_path: Path) -> None:
    run = write(tmp_path / "run", 13, 37, 60)
    before = sum(path.stat().st_size for path in (tmp_path / "run").glob("*.mcap"))
    merged = merge(tmp_path / "run", None)
    assert names(tmp_path / "run") == ["000.mcap", "lock"]
    assert essence(merged) == essence(run)
    assert sorted(merged.details, key=lambda detail: detail.evaluation) == list(run.details)
    assert (merged.header, merged.complete, merged.notes) == (run.header, True, ())
    content = (tmp_path / "run/000.mcap").read_bytes()
    assert len(content) < before
    summary = make_reader(BytesIO(content)).get_summary()
    assert summary is not None
    assert summary.chunk_indexes
    messages = list(make_reader(BytesIO(content), validate_crcs=True).iter_messages(log_time_order=False))
    topics = [channel.topic for _, channel, _ in messages]
    assert topics[:3] == ["/run"] * 3, "every session's header is kept"
    assert topics.count("/evaluation") == 60
    times = [message.log_time for _, _, message in messages]
    assert times == sorted(times)


def test_a_merged_run_goes_on(tmp_path: Path) -> None:
    write(tmp_path / "run", 13, 37)
    merge(tmp_path / "run", None)
    run = resume(tmp_path / "run", ToyTask, OrderedPool(), Silent(), 60)
    assert essence(run) == essence(write(tmp_path / "whole", 60))
    assert names(tmp_path / "run") == ["000.mcap", "001.mcap", "lock"]


def test_a_merge_to_another_file_leaves_the_run_alone(tmp_path: Path) -> None:
    run = write(tmp_path / "run", 13, 37)
    before = names(tmp_path / "run")
    merge(tmp_path / "run", tmp_path / "all.mcap")
    assert names(tmp_path / "run") == before
    (tmp_path / "copy").mkdir()
    (tmp_path / "all.mcap").rename(tmp_path / "copy/000.mcap")
    assert essence(read_run(tmp_path / "copy")) == essence(run)
    (tmp_path / "all.mcap").write_text("taken")
    with pytest.raises(RunError, match=r"all\.mcap: exists already"):
        merge(tmp_path / "run", tmp_path / "all.mcap")


def test_a_merge_that_is_killed_leaves_the_run_as_it_was(tmp_path: Path) -> None:
    run = write(tmp_path / "run", 13, 37)
    merge(tmp_path / "run", tmp_path / "all.mcap")
    (tmp_path / "run/merged.part").write_bytes((tmp_path / "all.mcap").read_bytes()[:2000])
    assert essence(read_run(tmp_path / "run")) == essence(run), "killed while it wrote"
    (tmp_path / "all.mcap").replace(tmp_path / "run/000.mcap")
    assert essence(read_run(tmp_path / "run")) == essence(run), "killed before the old segments went"
    assert essence(merge(tmp_path / "run", None)) == essence(run)
    assert names(tmp_path / "run") == ["000.mcap", "lock"]


def test_a_merge_that_finds_no_room_leaves_the_run_as_it_was(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    run = write(tmp_path / "run", 13, 37)
    before = names(tmp_path / "run")

    def full(descriptor: int) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(RunError, match=r"000\.mcap: cannot be written: No space left"):
        merge(tmp_path / "run", None)
    assert names(tmp_path / "run") == before
    assert essence(read_run(tmp_path / "run")) == essence(run)


def test_a_run_that_is_written_or_damaged_is_not_merged(tmp_path: Path) -> None:
    write(tmp_path / "run", 13, 37)
    with locked(tmp_path / "run"), pytest.raises(RunError, match="another evodesign is writing"):
        merge(tmp_path / "run", None)
    flip(tmp_path / "run/000.mcap", 0.5)
    before = names(tmp_path / "run")
    with pytest.raises(RunError, match=r"000\.mcap .*evodesign recover"):
        merge(tmp_path / "run", None)
    assert names(tmp_path / "run") == before


def flip(path: Path, share: float) -> None:
    content = bytearray(path.read_bytes())
    content[int(share * len(content))] ^= 0x10
    path.write_bytes(content)


def test_a_recovered_run_holds_what_was_sound_and_goes_on(tmp_path: Path) -> None:
    whole = write(tmp_path / "run", 20, 60)
    for share in (0.001, 0.121, 0.3, 0.45, 0.7):
        flip(tmp_path / "run/001.mcap", share)
    damaged = read_run(tmp_path / "run")
    assert damaged.damaged
    assert 50 < len(damaged.evaluations) < 60
    recovered = recover(tmp_path / "run", tmp_path / "saved")
    assert recovered.evaluations == damaged.evaluations
    assert recovered.complete
    assert len(recovered.faults) == 1
    assert recovered.faults[0].startswith("missing evaluations: ")
    assert merge(tmp_path / "saved", None).faults == recovered.faults, "one file lacks nothing else"
    run = resume(tmp_path / "saved", ToyTask, OrderedPool(), Silent(), None)
    assert not run.damaged
    assert essence(run) == essence(whole)
    with pytest.raises(RunError, match="holds a run already"):
        recover(tmp_path / "run", tmp_path / "saved")


def test_a_run_is_recovered_though_its_header_is_damaged(tmp_path: Path) -> None:
    whole = write(tmp_path / "run", 60)
    content = bytearray((tmp_path / "run/000.mcap").read_bytes())
    content[200:600] = bytes(400)
    (tmp_path / "run/000.mcap").write_bytes(content)
    recovered = recover(tmp_path / "run", tmp_path / "saved")
    assert recovered.header == whole.header
    assert recovered.evaluations == whole.evaluations


def test_the_digest_stands_for_results_and_for_nothing_else(tmp_path: Path) -> None:
    one = write(tmp_path / "one", 13, 37).evaluations
    assert digest(one) == digest(write(tmp_path / "other", 37).evaluations)
    slower = [msgspec.structs.replace(each, seconds=9.0, worker="elsewhere") for each in one]
    assert digest(slower) == digest(one)
    assert digest(one[:-1]) != digest(one)
    changed = msgspec.structs.replace(one[5], assessment=one[6].assessment)
    assert digest([*one[:5], changed, *one[6:]]) != digest(one)


def test_a_replay_accepts_what_the_search_asked_for_and_nothing_else(tmp_path: Path) -> None:
    run = write(tmp_path / "run", 60)
    replay(run)
    replay(replace(run, evaluations=run.evaluations[:37], generations=run.generations[:2]))
    outcomes = [each.assessment for each in run.evaluations[9::-1]]
    forged = [
        msgspec.structs.replace(each, assessment=other)
        for each, other in zip(run.evaluations, outcomes, strict=False)
    ]
    with pytest.raises(RunError, match="is of another genome"):
        replay(replace(run, evaluations=(*forged, *run.evaluations[10:])))


def test_a_branch_begins_with_the_past_and_takes_its_own_way(tmp_path: Path) -> None:
    old = write(tmp_path / "old", 60)
    settings = msgspec.structs.replace(old.header.search, seed=99, population=8)
    assert begin_branch(old, tmp_path / "new", 3, settings) == 30
    tasks = []

    def factory_of(header: RunHeader) -> ToyTask:
        tasks.append(ToyTask(header))
        return tasks[-1]

    run = resume(tmp_path / "new", factory_of, OrderedPool(shuffled(3)), Silent(), 60)
    assert len(tasks[0].genomes) == 30, "the past is not evaluated again"
    assert run.evaluations[:30] == old.evaluations[:30]
    assert {each.genome for each in run.evaluations[30:]}.isdisjoint(each.genome for each in old.evaluations)
    assert [state.evaluations for state in run.generations] == [10, 20, 30, 38, 46, 54]
    replay(run)
    later = begin_branch(run, tmp_path / "third", 5, msgspec.structs.replace(settings, algorithm="random"))
    assert later == 46
    third = read_run(tmp_path / "third").header.search
    assert [(stage.algorithm, stage.generations) for stage in third.past] == [("nsga2", 3), ("nsga2", 2)]
    make_search(third)
    replay(read_run(tmp_path / "third"))


def test_a_branch_with_nothing_changed_repeats_the_old_run(tmp_path: Path) -> None:
    old = write(tmp_path / "old", 60)
    begin_branch(old, tmp_path / "new", 2, old.header.search)
    assert essence(resume(tmp_path / "new", ToyTask, OrderedPool(), Silent(), 60)) == essence(old)


@pytest.mark.parametrize("stop", [KeyboardInterrupt, OSError(28, "No space left on device")])
def test_a_branch_that_is_broken_off_leaves_no_run_and_can_be_begun_again(
    stop: BaseException, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    old = write(tmp_path / "old", 60)

    def broken_off(*arguments: object) -> None:
        raise stop

    with monkeypatch.context() as patch:
        patch.setattr("evodesign.runlog.rewrite.add_header_copy", broken_off)
        with pytest.raises((KeyboardInterrupt, RunError)):
            begin_branch(old, tmp_path / "new", 3, old.header.search)
    assert [path.name for path in (tmp_path / "new").iterdir()] == ["lock"]
    assert begin_branch(old, tmp_path / "new", 3, old.header.search) == 30
    with pytest.raises(RunError, match="holds a run already"):
        begin_branch(old, tmp_path / "new", 3, old.header.search)


def test_a_branch_needs_a_past(tmp_path: Path) -> None:
    old = write(tmp_path / "old", 35)
    with pytest.raises(InputError, match=r"--branch-from: wanted at most 3, the whole generations.*found 4"):
        begin_branch(old, tmp_path / "new", 4, old.header.search)
    large = msgspec.structs.replace(old.header.search, population=21)
    with pytest.raises(InputError, match="--population: wanted at most 20"):
        begin_branch(old, tmp_path / "new", 2, large)
    assert not (tmp_path / "new").exists()
