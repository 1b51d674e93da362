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

import pytest

from evodesign.errors import RunError
from evodesign.evolve import Silent, resume, start
from evodesign.runlog.directory import locked
from evodesign.runlog.run import read_run
from tests.faults.kills import Session, Size, uninterrupted
from tests.faults.synthetic import synthetic_header
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
    session = Session(tmp_path / "run", 5, Size(64, 0.05, 1))
    try:
        assert session.first_report.wait(60.0)
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
        assert session.first_report.wait(60.0)
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
