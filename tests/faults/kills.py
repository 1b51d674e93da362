"""Killing processes of a search at random moments (signal 9), and what must then still be true."""

from __future__ import annotations

import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

from evodesign.errors import RunError
from evodesign.evolve import Silent, start
from evodesign.pool.worker import SerialPool
from evodesign.records import Status
from evodesign.runlog.run import RunLog, read_run
from tests.faults.synthetic import Synthetic, synthetic_header
from tests.runlog.toys import essence

ROOT = Path(__file__).parents[2]

DURING_START = 0.2
"""Share of kills whose moment is counted from the start of the process, not from its first evaluation."""

RECOVERED_PER_JOB = 16
"""Evaluations per job after which a search has got over a kill, and what was in flight was retried alone. One
that loses its worker during the retry too is rightly given up, which would not equal an undisturbed run."""

START_SECONDS = 60.0
"""How long a session may take to report its first evaluation."""


@dataclass(frozen=True)
class Size:
    """Of a run that is to be killed: evaluations, seconds of each, jobs."""

    budget: int
    seconds: float
    jobs: int


@dataclass
class Tally:
    """What a campaign did and found."""

    kills: int = 0
    runs: int = 0
    reported: int = 0
    known_at_kill: list[int] = field(default_factory=list)


class Session:
    """A running session, with the numbers that it has reported so far."""

    def __init__(self, directory: Path, seed: int, size: Size) -> None:
        arguments = [str(directory), str(seed), str(size.budget), str(size.seconds), str(size.jobs)]
        self.process = subprocess.Popen(
            [sys.executable, "-m", "tests.faults.session", *arguments],
            cwd=ROOT,
            stdout=subprocess.PIPE,
            env=os.environ | {"PYTHONPATH": str(ROOT), "PYTHONWARNINGS": "ignore"},
            start_new_session=True,
        )
        self.reported: list[int] = []
        self.first_report = threading.Event()
        self._reader = threading.Thread(target=self._read)
        self._reader.start()

    def _read(self) -> None:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            if line.endswith(b"\n"):
                self.reported.append(int(line))
                self.first_report.set()
        self.first_report.set()

    def ended_within(self, seconds: float) -> bool:
        try:
            self.process.wait(seconds)
        except subprocess.TimeoutExpired:
            return False
        return True

    def kill(self) -> None:
        self.process.kill()
        self.process.wait()

    def close(self) -> None:
        """End the session with all its workers."""
        self.kill()
        with suppress(ProcessLookupError):
            os.killpg(self.process.pid, signal.SIGKILL)
        self._reader.join()
        assert self.process.stdout is not None
        self.process.stdout.close()

    def workers(self) -> list[int]:
        """Process numbers of the pool's workers."""
        pid = self.process.pid
        children = Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
        return [int(child) for child in children if b"popen_loky" in _command(child)]


def _command(process: str) -> bytes:
    try:
        return Path(f"/proc/{process}/cmdline").read_bytes()
    except OSError:
        return b""


def uninterrupted(seed: int, budget: int) -> RunLog:
    header = synthetic_header(budget, seed)
    with tempfile.TemporaryDirectory() as folder:
        return start(Path(folder) / "run", header, Synthetic(header, 0.0), SerialPool(), Silent())


def kill_processes(folder: Path, kills: int, size: Size, seed: int, longest: float) -> Tally:
    """Kill whole searches, resume them, and compare with searches that were left in peace.

    Args:
        folder: for the runs.
        kills: how many.
        size: of each run.
        seed: of the moments and, counted on, of the runs.
        longest: seconds between start or first evaluation and kill.
    """
    generator, tally = random.Random(seed), Tally()
    while tally.kills < kills:
        tally.runs += 1
        directory, reported = folder / f"run-{tally.runs}", set[int]()
        ended = False
        while not ended:
            session = Session(directory, seed + tally.runs, size)
            if tally.kills < kills:
                if generator.random() > DURING_START:
                    session.first_report.wait(START_SECONDS)
                ended = session.ended_within(generator.uniform(0.0, longest))
                if not ended:
                    session.kill()
                    tally.kills += 1
            else:
                ended = session.ended_within(600.0)
            session.close()
            assert not ended or session.process.returncode == 0
            reported |= set(session.reported)
            known = _numbers(directory)
            assert reported <= known, f"lost: {sorted(reported - known)}"
            tally.known_at_kill.append(len(known))
        run = read_run(directory)
        assert essence(run) == essence(uninterrupted(seed + tally.runs, size.budget))
        assert not run.damaged
        tally.reported += len(reported)
        shutil.rmtree(directory)
    return tally


def _numbers(directory: Path) -> set[int]:
    try:
        return {evaluation.number for evaluation in read_run(directory).evaluations}
    except RunError:  # killed before there was a header
        for path in directory.glob("*.mcap"):
            path.unlink()
        return set()


def kill_workers(folder: Path, kills: int, size: Size, seed: int) -> Tally:
    """Kill single workers of searches that go on, and compare with searches that were left in peace."""
    generator, tally = random.Random(seed), Tally()
    while tally.kills < kills:
        tally.runs += 1
        directory = folder / f"run-{tally.runs}"
        session = Session(directory, seed + tally.runs, size)
        seen = 0
        try:
            while not session.ended_within(generator.uniform(0.01, 0.2)):
                workers = session.workers()
                recovered = len(session.reported) >= seen + RECOVERED_PER_JOB * size.jobs
                if workers and recovered and tally.kills < kills:
                    seen = len(session.reported)
                    if _killed(generator.choice(workers)):
                        tally.kills += 1
        finally:
            session.close()
        assert session.process.returncode == 0
        run = read_run(directory)
        assert sorted(session.reported) == list(range(size.budget)), "each is reported once"
        lost = [each for each in run.evaluations if each.assessment.status is Status.WORKER_LOST]
        assert not lost, f"given up after a retry: {lost}"
        assert essence(run) == essence(uninterrupted(seed + tally.runs, size.budget))
        tally.reported += len(session.reported)
        shutil.rmtree(directory)
    return tally


def _killed(process: int) -> bool:
    try:
        os.kill(process, signal.SIGKILL)
    except ProcessLookupError:
        return False
    return True


def timed(tally: Tally, began: float) -> str:
    return (
        f"{tally.kills} kills in {tally.runs} runs, {tally.reported} evaluations reported, none lost, every "
        f"run equal to the uninterrupted one ({time.monotonic() - began:.0f} s)"
    )
