from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from evodesign.evolve import Silent, resume
from evodesign.runlog.run import RunLog, read_run
from tests.faults.kills import uninterrupted
from tests.runlog.toys import OrderedPool, ToyTask, essence

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[2]


@contextmanager
def session(
    directory: Path, seconds: float, grace: float, hours: float = 0.0
) -> Iterator[subprocess.Popen[str]]:
    """A session of which an evaluation has arrived."""
    command = [sys.executable, "-m", "tests.cli.stopped_session"]
    process = subprocess.Popen(
        [*command, str(directory), str(seconds), str(grace), str(hours)],
        cwd=ROOT,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    with process:
        try:
            assert process.stdout is not None
            assert process.stdout.readline()
            yield process
        finally:
            process.kill()


def check_resumable(directory: Path, least: int, most: int) -> RunLog:
    run = read_run(directory)
    assert least <= len(run.evaluations) <= most
    resumed = resume(directory, ToyTask, OrderedPool(), Silent(), None)
    expected = uninterrupted(1, 40)
    assert [each.genome for each in resumed.evaluations[:16]] == [
        each.genome for each in expected.evaluations[:16]
    ]
    assert len(essence(resumed)[0]) == 40
    return run


@pytest.mark.parametrize("request_to_stop", [signal.SIGINT, signal.SIGTERM])
def test_a_first_request_lets_what_is_in_flight_arrive(
    tmp_path: Path, request_to_stop: signal.Signals
) -> None:
    with session(tmp_path / "run", seconds=0.3, grace=30.0) as process:
        process.send_signal(request_to_stop)
        asked = time.monotonic()
        _, errors = process.communicate(timeout=60)
        assert time.monotonic() - asked < 10.0
    assert process.returncode == 3
    assert "waiting for what is in flight, at most 30 s (Ctrl-C again stops at once)" in errors
    assert f"evodesign resume {tmp_path / 'run'}" in errors
    run = check_resumable(tmp_path / "run", 2, 1 + 4 + 2)
    assert run.complete, "the segment was closed"


def test_a_second_request_stops_at_once(tmp_path: Path) -> None:
    with session(tmp_path / "run", seconds=3.0, grace=60.0) as process:
        process.send_signal(signal.SIGINT)
        time.sleep(0.3)
        asked = time.monotonic()
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=60)
        assert time.monotonic() - asked < 2.0
    assert process.returncode == 3
    assert "evodesign resume" in errors
    assert len(read_run(tmp_path / "run").evaluations) in range(1, 4)


def test_what_does_not_arrive_in_time_is_not_waited_for(tmp_path: Path) -> None:
    with session(tmp_path / "run", seconds=3.0, grace=0.3) as process:
        asked = time.monotonic()
        process.send_signal(signal.SIGTERM)
        _, errors = process.communicate(timeout=60)
        assert time.monotonic() - asked < 2.5
    assert process.returncode == 3
    assert "at most 0.3 s" in errors


def test_the_end_of_the_wall_time_is_a_request_to_stop(tmp_path: Path) -> None:
    with session(tmp_path / "run", seconds=0.3, grace=30.0, hours=5.0 / 3600.0) as process:
        _, errors = process.communicate(timeout=60)
    assert process.returncode == 3
    assert "its wall time of 0.00138889 h is over|stopped after" in errors
    assert read_run(tmp_path / "run").complete
