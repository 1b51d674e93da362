"""The trials of the fault campaign: each follows from its number and the campaign's seed, but for timing."""

from __future__ import annotations

import itertools
import random
import shutil
import time
import traceback
from dataclasses import dataclass
from pathlib import Path

import msgspec

from tests.faults.command_kills import COMMANDS, kill_command
from tests.faults.kills import kill_search, kill_workers
from tests.faults.synthetic import Size
from tests.pool.cluster import Cluster

ALGORITHMS = ("nsga2", "cma-es", "random")
POOLS = ("serial", "joblib", "dask")
SEARCH_KILLS, WORKER_KILLS, COMMAND_KILLS = 8, 6, 6
SEARCH_BUDGET, WORKER_BUDGET = 160, 320
SECONDS = 0.004
"""Of one evaluation [s]; long enough for kills to come in the middle of it."""


@dataclass(frozen=True)
class Trial:
    """What is killed: the process of a search, its workers, or a command.

    Args:
        what: search, workers, or the name of a command.
        kills: how many.
        size: of the search, if it is one.
    """

    what: str
    kills: int
    size: Size | None = None

    @property
    def name(self) -> str:
        """The trial in words."""
        if self.size is None:
            return f"evodesign {self.what}"
        mode = "asynchronous" if self.size.asynchronous else "generations"
        return f"{self.what}, {self.size.pool}, {self.size.algorithm}, {mode}"


class Outcome(msgspec.Struct, frozen=True):
    """What came of a trial: a line of the campaign's file.

    Args:
        seed: of the campaign.
        number: of the trial.
        name: of the trial.
        kills: by what was killed while it did what.
        sessions: processes that were started.
        reported: evaluations.
        seconds: that it took.
        finding: what was wrong; empty if nothing was.
    """

    seed: int
    number: int
    name: str
    kills: dict[str, int]
    sessions: int
    reported: int
    seconds: float
    finding: str = ""


KINDS: tuple[Trial, ...] = (
    *(
        Trial("search", SEARCH_KILLS, Size(SEARCH_BUDGET, SECONDS, jobs, pool, algorithm, asynchronous))
        for asynchronous, algorithm, pool in itertools.product((False, True), ALGORITHMS, POOLS)
        for jobs in [1 if pool == "serial" else 2]
    ),
    *(
        Trial("workers", WORKER_KILLS, Size(WORKER_BUDGET, SECONDS, 2, pool, "nsga2", asynchronous))
        for asynchronous, pool in itertools.product((False, True), POOLS[1:])
    ),
    *(Trial(command, COMMAND_KILLS) for command in COMMANDS),
)
"""All kinds of trials; they take turns."""


def trial(number: int) -> Trial:
    """The trial of a number."""
    return KINDS[number % len(KINDS)]


def tried(number: int, seed: int, folder: Path, cluster: Cluster) -> Outcome:
    """Carry out a trial; its folder stays if there is a finding.

    Args:
        number: of the trial.
        seed: of the campaign.
        folder: for what the trial writes; what stands there is removed.
        cluster: scheduler and workers of Dask, used by nobody else meanwhile.
    """
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    kind, chance, begun = trial(number), random.Random(f"{seed} {number}"), time.monotonic()
    scheduler = [cluster.address] if kind.size is not None and kind.size.pool == "dask" else []
    kills, sessions, reported, finding = dict[str, int](), 0, 0, ""
    try:
        if kind.size is None:
            tally = kill_command(folder, kind.kills, kind.what, number, chance)
        elif kind.what == "search":
            tally = kill_search(folder / "run", kind.kills, kind.size, number, chance, *scheduler)
        else:
            parents = [process.pid for process in cluster.workers] if scheduler else []
            tally = kill_workers(
                folder / "run", kind.kills, kind.size, number, chance, *scheduler, parents=parents
            )
        kills = {f"{kind.what}, {doing}" if kind.size else doing: n for doing, n in tally.kills.items()}
        sessions, reported = tally.sessions, tally.reported
        shutil.rmtree(folder)
    except Exception as error:  # noqa: BLE001 - whatever it is, it is a finding, and the campaign goes on
        finding = f"{type(error).__name__}: {error}"
        (folder / "traceback.txt").write_text(traceback.format_exc())
    seconds = time.monotonic() - begun
    return Outcome(seed, number, kind.name, kills, sessions, reported, round(seconds, 1), finding)
