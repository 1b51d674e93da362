"""What a stop lets arrive and what it does not wait for: evaluations are held until a test lets them go."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import pytest

from evodesign.evolve import resume
from evodesign.pool.dask_pool import CONNECT_SECONDS
from evodesign.runlog.run import RunLog, read_run
from evodesign.runlog.session_log import Silent
from tests.cli.stopped_session import JOBS
from tests.faults.kills import uninterrupted
from tests.pool.cluster import Cluster
from tests.runlog.toys import OrderedPool, ToyTask, essence

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[2]
LONG = 300.0
"""A wait [s] that only a session that hangs takes."""

FOR_EVER = 3600.0
IN_FLIGHT = 2 * JOBS
"""Evaluations that are at work or prefetched."""


@dataclass(frozen=True)
class Held:
    """A session whose evaluations, but for the first, wait for a file to go."""

    process: subprocess.Popen[str]
    hold: Path

    def first_arrives(self) -> None:
        assert self.process.stdout is not None
        assert self.process.stdout.readline()

    def says(self) -> str:
        """Its next line on standard error, when it comes."""
        assert self.process.stderr is not None
        return self.process.stderr.readline()

    def rest(self) -> str:
        """What it still says until it ends, by itself."""
        return self.process.communicate(timeout=LONG)[1]


@contextmanager
def session(directory: Path, grace: float, hours: float = 0.0, *scheduler: str) -> Iterator[Held]:
    """A session that has begun."""
    hold = directory.with_name("hold")
    hold.touch()
    command = [sys.executable, "-m", "tests.cli.stopped_session"]
    process = subprocess.Popen(
        [*command, str(directory), str(hold), str(grace), str(hours), *scheduler],
        cwd=ROOT,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    with process:
        try:
            yield Held(process, hold)
        finally:
            hold.unlink(missing_ok=True)
            process.kill()


def check_resumable(directory: Path) -> RunLog:
    run = read_run(directory)
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
    with session(tmp_path / "run", grace=FOR_EVER) as held:
        held.first_arrives()
        held.process.send_signal(request_to_stop)
        heard = held.says()
        held.hold.unlink()
        errors = held.rest()
    assert held.process.returncode == 3
    assert heard == "note: waiting for what is in flight, at most 3600 s (Ctrl-C again stops at once)\n"
    assert f"evodesign resume {tmp_path / 'run'}" in errors
    run = check_resumable(tmp_path / "run")
    assert JOBS <= len(run.evaluations) <= 1 + IN_FLIGHT
    assert run.complete, "the segment was closed"


def test_a_second_request_stops_at_once(tmp_path: Path) -> None:
    with session(tmp_path / "run", grace=FOR_EVER) as held:
        held.first_arrives()
        held.process.send_signal(signal.SIGINT)
        assert "waiting for what is in flight" in held.says()
        held.process.send_signal(signal.SIGINT)
        errors = held.rest()
        assert held.hold.exists(), "nobody let an evaluation go"
    assert held.process.returncode == 3
    assert "evodesign resume" in errors
    assert len(read_run(tmp_path / "run").evaluations) == 1


def test_what_does_not_arrive_in_time_is_not_waited_for(tmp_path: Path) -> None:
    with session(tmp_path / "run", grace=0.3) as held:
        held.first_arrives()
        held.process.send_signal(signal.SIGTERM)
        errors = held.rest()
        assert held.hold.exists(), "nobody let an evaluation go"
    assert held.process.returncode == 3
    assert "at most 0.3 s" in errors
    assert len(read_run(tmp_path / "run").evaluations) == 1


def test_the_end_of_the_wall_time_is_a_request_to_stop(tmp_path: Path) -> None:
    with session(tmp_path / "run", grace=FOR_EVER, hours=0.5 / 3600.0) as held:
        heard = held.says()
        held.hold.unlink()
        errors = held.rest()
    assert held.process.returncode == 3
    assert "its wall time of 0.000138889 h is over" in heard
    assert "its wall time of 0.000138889 h is over|stopped after" in errors
    run = check_resumable(tmp_path / "run")
    assert len(run.evaluations) <= 1 + IN_FLIGHT
    assert run.complete


@pytest.mark.parametrize("moment", ["after it was lost", "while it is missed", "before it is lost"])
def test_a_session_whose_scheduler_is_lost_ends_soon_after_the_first_request(
    moment: str, tmp_path: Path
) -> None:
    with Cluster() as cluster:
        cluster.start_scheduler()
        cluster.add_worker("--no-nanny")
        cluster.wait_for(1)
        with session(tmp_path / "run", FOR_EVER, 0.0, cluster.address) as held:
            held.first_arrives()
            if moment == "before it is lost":
                held.process.send_signal(signal.SIGINT)
                assert "waiting for what is in flight" in held.says()
                cluster.kill_scheduler()
                began = time.monotonic()
            else:
                cluster.kill_scheduler()
                time.sleep(0.1 if moment == "after it was lost" else CONNECT_SECONDS + 2.0)
                began = time.monotonic()
                held.process.send_signal(signal.SIGINT)
            errors = held.rest()
            seconds = time.monotonic() - began
    assert held.process.returncode == 3
    assert seconds < 5.0
    assert "Traceback" not in errors
    assert f"evodesign resume {tmp_path / 'run'}" in errors
    check_resumable(tmp_path / "run")
