"""Killing processes of a search at random moments (signal 9), and what must then still be true."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import tempfile
import threading
from collections import Counter
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

import msgspec

from evodesign.analysis.audit import audit
from evodesign.evolve import replay, start
from evodesign.pool.worker import SerialPool
from evodesign.records import Status
from evodesign.runlog.directory import segments
from evodesign.runlog.run import RunLog, read_run
from evodesign.runlog.session_log import Silent
from tests.faults.session import BEGINNING, checksum
from tests.faults.synthetic import Size, Synthetic, synthetic_header
from tests.runlog.toys import essence, toy_assessment

ROOT = Path(__file__).parents[2]

RECOVERED_PER_JOB = 16
"""Evaluations per job after which a search has got over a kill, and what was in flight was retried alone. One
that loses its worker during the retry too is rightly given up, which would not equal an undisturbed run."""

LONGEST = 120.0
"""How long [s] a session may take to its next report, or to its end."""

START_UP = 1.2
LOADED = 0.4
"""Within so many seconds from its start, or from having loaded everything, a session is killed early."""

MOST_REPORTS = 40
"""A session is killed after at most so many reports."""


@dataclass
class Tally:
    """What was killed and found; kills are counted by what the process was doing."""

    kills: Counter[str] = field(default_factory=Counter)
    sessions: int = 0
    reported: int = 0


class Session:
    """A running session, with the evaluations that it has reported so far and their checksums."""

    def __init__(self, directory: Path, seed: int, size: Size, *scheduler: str) -> None:
        arguments = [str(directory), str(seed), msgspec.json.encode(size).decode(), *scheduler]
        self.resumes = bool(segments(directory))
        self.errors = tempfile.TemporaryFile()  # noqa: SIM115 - closed with the session
        self.process = subprocess.Popen(
            [sys.executable, "-m", "tests.faults.session", *arguments],
            cwd=ROOT,
            stdout=subprocess.PIPE,
            stderr=self.errors,
            env=os.environ | {"PYTHONPATH": str(ROOT), "PYTHONWARNINGS": "ignore"},
            start_new_session=True,
        )
        self._said = ""
        self.loaded = False
        self.reported: dict[int, int] = {}
        self._news = threading.Condition()
        self._ended = False
        self._reader = threading.Thread(target=self._read)
        self._reader.start()

    def _read(self) -> None:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            with self._news:
                if line.strip() == BEGINNING:
                    self.loaded = True
                elif line.endswith(b"\n"):
                    number, found = map(int, line.split())
                    assert number not in self.reported
                    self.reported[number] = found
                self._news.notify_all()
        with self._news:
            self._ended = True
            self._news.notify_all()

    def wait_until_loaded(self) -> None:
        """Return when the session is about to begin or resume, or has ended."""
        with self._news:
            assert self._news.wait_for(lambda: self.loaded or self._ended, LONGEST), "it hangs"

    def wait_for(self, reports: int) -> bool:
        """Return when there are so many reports, or the session has ended; whether there are."""
        with self._news:
            while len(self.reported) < reports and not self._ended:
                assert self._news.wait(LONGEST), "it hangs"
            return len(self.reported) >= reports

    def ended_within(self, seconds: float) -> bool:
        try:
            self.process.wait(seconds)
        except subprocess.TimeoutExpired:
            return False
        return True

    def kill(self) -> bool:
        """Kill the process; whether that was its end."""
        self.process.kill()
        return self.process.wait() == -signal.SIGKILL

    def close(self) -> None:
        """End the session with all its workers."""
        self.kill()
        with suppress(ProcessLookupError):
            os.killpg(self.process.pid, signal.SIGKILL)
        self._reader.join()
        self.errors.seek(0)
        self._said = self.errors.read().decode(errors="replace")[-3000:]
        self.errors.close()
        assert self.process.stdout is not None
        self.process.stdout.close()

    def doing(self, left: int) -> str:
        """What the session was at when it was killed, of which so many evaluations were left."""
        if not self.loaded:
            return "starting up"
        if not self.reported and left:
            return "resuming" if self.resumes else "beginning"
        return "writing" if len(self.reported) < left else "ending"

    def said(self) -> str:
        """The end of what it wrote on standard error."""
        return self._said


def workers_of(processes: Sequence[int]) -> list[int]:
    """Process numbers of the workers that these processes, or threads of theirs, have started."""
    lists = [path for pid in processes for path in Path(f"/proc/{pid}/task").glob("*/children")]
    children = {int(child) for path in lists for child in _read(path).split()}
    return sorted(child for child in children if b"popen_loky" in _read(Path(f"/proc/{child}/cmdline")))


def _read(path: Path) -> bytes:
    """What the system says of a process or thread; nothing when it has ended."""
    try:
        return path.read_bytes()
    except OSError:
        return b""


def uninterrupted(seed: int, budget: int, algorithm: str = "nsga2") -> RunLog:
    header = synthetic_header(budget, seed, algorithm)
    with tempfile.TemporaryDirectory() as folder:
        return start(Path(folder) / "run", header, Synthetic(header, 0.0), SerialPool(), Silent())


def check_finished(run: RunLog, seed: int, size: Size) -> None:
    """A finished run equals the one that was left in peace; an asynchronous one is what its replay says."""
    assert not run.damaged, run.faults
    assert [each.number for each in run.evaluations] == list(range(size.budget))
    assert audit(run) == []
    replay(run)
    for each in run.evaluations:
        assert each.assessment == toy_assessment(each.genome, run.header), f"evaluation {each.number}"
    if not size.asynchronous:
        assert essence(run) == essence(uninterrupted(seed, size.budget, size.algorithm))


def kill_search(
    directory: Path, kills: int, size: Size, seed: int, chance: random.Random, *scheduler: str
) -> Tally:
    """Kill a search and then its resumptions, let the last one end, and look at what it has found.

    Args:
        directory: of the run.
        kills: how often, unless the run is done before.
        size: of the run.
        seed: of the run.
        chance: of the moments.
        scheduler: address of the one of Dask, if that is the pool.
    """
    tally, reported, ended = Tally(), dict[int, int](), False
    while not ended:
        left = size.budget - len(_known(directory))
        session = Session(directory, seed, size, *scheduler)
        try:
            if tally.kills.total() < kills:
                last = tally.kills.total() == kills - 1
                _let_live(session, left, chance, to_the_end=last)
                ended = not session.kill()
                if not ended:
                    tally.kills[session.doing(left)] += 1
            else:
                ended = session.ended_within(LONGEST)
                assert ended, "it hangs"
        finally:
            session.close()
        tally.sessions += 1
        assert not ended or session.process.returncode == 0, session.said()
        assert reported.keys().isdisjoint(session.reported), "evaluated twice"
        reported |= session.reported
        known = _known(directory)
        lost = {number for number, found in reported.items() if known.get(number) != found}
        assert not lost, f"lost or changed: {sorted(lost)}"
    check_finished(read_run(directory), seed, size)
    strange = [path.name for path in directory.iterdir() if path.suffix != ".mcap" and path.name != "lock"]
    assert not strange, f"left behind: {strange}"
    tally.reported = len(reported)
    return tally


def _let_live(session: Session, left: int, chance: random.Random, *, to_the_end: bool) -> None:
    """Return at a random moment of a session's life."""
    draw, moment, reports = chance.random(), chance.random(), chance.randint(1, MOST_REPORTS)
    if draw < 0.2:
        session.ended_within(START_UP * moment)
        return
    session.wait_until_loaded()
    if draw < 0.45:
        session.ended_within(LOADED * moment)
        return
    session.wait_for(left if to_the_end and draw > 0.7 else min(reports, left))
    session.ended_within(0.01 * moment)


def _known(directory: Path) -> dict[int, int]:
    """Checksums of the evaluations on the disk; what a kill leaves can be read, or is no run."""
    if not segments(directory):
        return {}
    run = read_run(directory)
    assert not run.damaged, run.faults
    return {evaluation.number: checksum(evaluation) for evaluation in run.evaluations}


def kill_workers(
    directory: Path,
    kills: int,
    size: Size,
    seed: int,
    chance: random.Random,
    *scheduler: str,
    parents: Sequence[int] = (),
) -> Tally:
    """Kill single workers of a search that goes on, and look at what it has found.

    Args:
        directory: of the run.
        kills: how often, unless the run is done before.
        size: of the run.
        seed: of the run.
        chance: of the moments.
        scheduler: as in `kill_search`.
        parents: processes whose children the workers are; the session's own, if none are named.
    """
    tally, seen = Tally(), 0
    session = Session(directory, seed, size, *scheduler)
    try:
        while not session.ended_within(chance.uniform(0.01, 0.1)):
            workers = workers_of(parents or [session.process.pid])
            recovered = len(session.reported) >= seen + RECOVERED_PER_JOB * size.jobs
            if workers and recovered and tally.kills.total() < kills:
                seen = len(session.reported)
                with suppress(ProcessLookupError):
                    os.kill(chance.choice(workers), signal.SIGKILL)
                    tally.kills["working"] += 1
    finally:
        session.close()
    assert session.process.returncode == 0, session.said()
    run = read_run(directory)
    assert sorted(session.reported) == list(range(size.budget)), "each is reported once"
    lost = [each for each in run.evaluations if each.assessment.status is Status.WORKER_LOST]
    assert not lost, f"given up after a retry: {lost}"
    check_finished(run, seed, size)
    tally.sessions, tally.reported = 1, len(session.reported)
    return tally
