"""A full disk, a directory that cannot be written, a second process, a clock that goes back."""

from __future__ import annotations

import os
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from random import Random

import msgspec
import pytest

from evodesign.errors import RunError
from evodesign.evolve import resume, start
from evodesign.problem.left_out import left_out
from evodesign.runlog.directory import locked
from evodesign.runlog.run import read_run
from evodesign.runlog.session_log import Silent
from tests.cli.here import evodesign
from tests.faults.kills import Session, uninterrupted
from tests.faults.synthetic import Size, synthetic_header
from tests.runlog.toys import OrderedPool, ToyTask, essence

HEADER = synthetic_header(budget=64, seed=5)
NOBODY = 65534


@contextmanager
def small_disk(folder: Path, kilobytes: int) -> Iterator[Path]:
    """A place with so much room: a file system of its own or, without the rights, a limit on files."""
    place = folder / "small"
    place.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", f"size={kilobytes}k", "tmpfs", str(place)]
    able = os.geteuid() == 0 and shutil.which("mount") is not None
    mounted = able and subprocess.run(mount, check=False, capture_output=True).returncode == 0
    if mounted:
        try:
            yield place
        finally:
            subprocess.run(["umount", str(place)], check=True)
        return
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    handler = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (kilobytes * 1024, hard))
    try:
        yield place
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
        signal.signal(signal.SIGXFSZ, handler)


@contextmanager
def without_rights() -> Iterator[None]:
    """Root may write everywhere; within this, the process may not."""
    if os.geteuid() != 0:
        yield
        return
    os.seteuid(NOBODY)
    try:
        yield
    finally:
        os.seteuid(0)


@pytest.fixture
def public_folder() -> Iterator[Path]:
    """A folder that another user can reach."""
    folder = Path(tempfile.mkdtemp())
    folder.chmod(0o755)
    yield folder
    shutil.rmtree(folder)


def test_a_full_disk_ends_the_search_in_a_sentence_and_loses_nothing(tmp_path: Path) -> None:
    reported = []

    class Reporter(Silent):
        def evaluated(self, evaluation: object, done: int, budget: int) -> None:
            reported.append(evaluation)

    with small_disk(tmp_path, kilobytes=32) as disk:
        sentence = r"run/000\.mcap: cannot be written: (No space left on device|File too large)"
        with pytest.raises(RunError, match=sentence):
            start(disk / "run", HEADER, ToyTask(HEADER), OrderedPool(), Reporter())
        left = read_run(disk / "run")
        shutil.copytree(disk / "run", tmp_path / "roomier")
    assert 10 < len(reported) <= len(left.evaluations) < 64
    assert list(left.evaluations[: len(reported)]) == reported
    assert not left.damaged
    run = resume(tmp_path / "roomier", ToyTask, OrderedPool(), Silent(), None)
    assert essence(run) == essence(uninterrupted(5, 64))


def test_a_disk_without_room_for_a_header_holds_no_run_that_one_could_go_on_with(tmp_path: Path) -> None:
    long = msgspec.structs.replace(HEADER, problem_name=Random(1).randbytes(60_000).hex())
    sentence = r"run/000\.mcap: cannot be written: (No space left on device|File too large)"
    with small_disk(tmp_path, kilobytes=32) as disk:
        for _ in range(2):  # the second time for want of room too, not because there is a run
            with pytest.raises(RunError, match=sentence):
                start(disk / "run", long, ToyTask(long), OrderedPool(), Silent())
            assert [path.name for path in (disk / "run").iterdir()] == ["lock"]
        with pytest.raises(RunError, match="is not a run, for it holds no"):
            resume(disk / "run", ToyTask, OrderedPool(), Silent(), None)
        shutil.copytree(disk / "run", tmp_path / "roomier")
    run = start(tmp_path / "roomier", HEADER, ToyTask(HEADER), OrderedPool(), Silent())
    assert essence(run) == essence(uninterrupted(5, 64))


def test_a_full_disk_leaves_a_run_to_be_resumed_without_a_further_segment(tmp_path: Path) -> None:
    with small_disk(tmp_path, kilobytes=32) as disk:
        with pytest.raises(RunError, match="cannot be written"):
            start(disk / "run", HEADER, ToyTask(HEADER), OrderedPool(), Silent())
        if disk.is_mount():  # with a limit on files alone, a second one finds room
            with pytest.raises(RunError, match=r"001\.mcap: cannot be written"):
                resume(disk / "run", ToyTask, OrderedPool(), Silent(), None)
            assert sorted(path.name for path in disk.glob("run/*.mcap")) == ["000.mcap"]
            assert not list(disk.glob("run/*.part"))


@pytest.mark.parametrize("content", [b"", b"not a log"])
def test_what_holds_no_header_is_refused_by_search_as_by_resume_and_gone_when_that_was_heeded(
    content: bytes, tmp_path: Path
) -> None:
    """Older versions left an empty segment on a full disk."""
    (tmp_path / "run").mkdir()
    (tmp_path / "run/000.mcap").write_bytes(content)
    with pytest.raises(RunError, match="remove the directory, or choose another one with --run") as resumed:
        resume(tmp_path / "run", ToyTask, OrderedPool(), Silent(), None)
    with pytest.raises(RunError, match="remove the directory, or choose another one with --run") as started:
        start(tmp_path / "run", HEADER, ToyTask(HEADER), OrderedPool(), Silent())
    assert str(started.value) == str(resumed.value)
    shutil.rmtree(tmp_path / "run")
    assert start(tmp_path / "run", HEADER, ToyTask(HEADER), OrderedPool(), Silent()).complete


def test_a_report_on_a_full_disk_leaves_the_old_page(tmp_path: Path) -> None:
    start(tmp_path / "run", HEADER, ToyTask(HEADER), OrderedPool(), Silent())
    with small_disk(tmp_path, kilobytes=256) as disk:
        page = disk / "report.html"
        page.write_text("the old page")
        done = evodesign("report", tmp_path / "run", "--output", page)
        assert_refused(done, "--output", f"'{page}' (No space left on device)", f"'{page}' (File too large)")
        assert page.read_text() == "the old page"
        assert [path.name for path in disk.iterdir()] == ["report.html"]


def assert_refused(done: subprocess.CompletedProcess[str], option: str, *ends: str) -> None:
    assert done.returncode == 2
    (sentence,) = (line for line in done.stderr.splitlines() if line.startswith("error: "))
    assert option in sentence
    assert sentence.endswith(ends)


def test_a_directory_that_cannot_be_written_is_refused_in_a_sentence(public_folder: Path) -> None:
    start(public_folder / "run", HEADER, ToyTask(HEADER), OrderedPool(), Silent())
    before = (public_folder / "run/000.mcap").read_bytes()
    for path in (public_folder / "run", public_folder):
        path.chmod(0o555)
    with without_rights():
        with pytest.raises(RunError, match="run: cannot be locked: Permission denied"):
            resume(public_folder / "run", ToyTask, OrderedPool(), Silent(), 99)
        with pytest.raises(RunError, match="other: cannot be made a run directory: Permission denied"):
            start(public_folder / "other", HEADER, ToyTask(HEADER), OrderedPool(), Silent())
        assert len(read_run(public_folder / "run").evaluations) == 64, "reading needs no right to write"
    for path in (public_folder, public_folder / "run"):
        path.chmod(0o755)
    assert (public_folder / "run/000.mcap").read_bytes() == before


def test_a_second_process_is_refused_and_a_crash_leaves_no_lock(tmp_path: Path) -> None:
    session = Session(tmp_path / "run", 5, Size(64, 0.05, 1, "serial"))
    try:
        assert session.wait_for(1)
        with pytest.raises(RunError, match="run: another evodesign is writing this run"):
            resume(tmp_path / "run", ToyTask, OrderedPool(), Silent(), None)
        assert len(read_run(tmp_path / "run").evaluations) >= 1, "others may read meanwhile"
    finally:
        session.close()
    with locked(tmp_path / "run"):
        pass
    run = resume(tmp_path / "run", ToyTask, OrderedPool(), Silent(), None)
    assert essence(run) == essence(uninterrupted(5, 64))


def test_a_killed_search_with_workers_leaves_no_lock(tmp_path: Path) -> None:
    """Workers outlive a killed parent for a moment; they must not hold its lock."""
    session = Session(tmp_path / "run", 5, Size(640, 0.01, 2))
    try:
        assert session.wait_for(1)
        session.kill()
        with locked(tmp_path / "run"):
            pass
    finally:
        session.close()


def test_a_clock_that_goes_back_changes_nothing_but_times(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    times = iter(range(2_000_000_000_000_000_000, 0, -3_600_000_000_000))
    monkeypatch.setattr(time, "time_ns", lambda: next(times))
    start(tmp_path / "run", synthetic_header(20, 5), ToyTask(HEADER), OrderedPool(), Silent())
    run = resume(tmp_path / "run", ToyTask, OrderedPool(), Silent(), 64)
    assert run.complete
    assert essence(run) == essence(uninterrupted(5, 64))


def test_disks_are_small_in_a_process_that_may_mount_or_not() -> None:
    """Whatever the rights, one of the two ways works: the test above never skips."""
    code = (
        "import pathlib, tempfile, tests.faults.test_disk as disk\n"
        "disk.os.geteuid = lambda: 1\n"
        "with tempfile.TemporaryDirectory() as folder, disk.small_disk(pathlib.Path(folder), 8) as place:\n"
        "    try:\n"
        "        (place / 'file').write_bytes(bytes(20000))\n"
        "    except OSError as error:\n"
        "        print(error.strerror)\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "File too large\n"


def test_output_that_finds_no_room_is_told_in_a_sentence(tmp_path: Path) -> None:
    start(tmp_path / "run", HEADER, ToyTask(HEADER), OrderedPool(), Silent())
    command = [sys.executable, "-m", "evodesign", "front", str(tmp_path / "run"), "--csv"]
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert done.returncode == 2
    told = [f"note: {sentence}" for sentence in left_out(HEADER.problem)]
    error = "error: the output cannot be written: No space left on device"
    assert done.stderr.splitlines() == [*told, error]
