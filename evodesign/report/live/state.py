"""Where a running search stands: its log followed, kept up to date record by record, and as a JSON object.

Of the evaluations only the front and a thinned sample of the others are kept, so that a look at a long search
costs no more than one at a short one.

The page and `watch --json` show the object: numbers are the log's, in natural values; times in seconds. Its
shape is a promise.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec

from evodesign.analysis.decision_making import knees
from evodesign.analysis.front import front
from evodesign.analysis.growth import HypervolumeGrowth, growth
from evodesign.analysis.hypervolume import best
from evodesign.errors import RunError
from evodesign.records import Evaluation, Generation, RunHeader, Status
from evodesign.runlog.follow import Follower
from evodesign.runlog.gaps import listed, missing
from evodesign.violations import exceeded_bounds

SAMPLE = 1000
"""Most evaluations that are kept beside the front; then every second one is dropped, again and again."""

PACE_OVER = 200
"""Evaluations over which the pace is measured."""

MOST_KNEES = 8
"""Knees of the front that are shown."""

MOST_POINTS = 2000
"""Designs of the front that are drawn; more are thinned out evenly, and the page says so."""

SILENCE = 60.0
"""Seconds without a new evaluation after which a search is called silent."""


@dataclass(frozen=True, slots=True)
class LiveState:
    """Where a search stands.

    Args:
        header: of the last session.
        done: evaluations so far.
        feasible: how many of them are.
        causes: how many ended in each status that is not solved.
        exceeded: how many exceed each bound of `[constraints]`, in words.
        generations: all so far, in order.
        front: of all evaluations so far, in order of number.
        others: a sample of the feasible ones that are not on the front.
        latest: when the last evaluation was written, in seconds since 1970; None before the first.
        pace: evaluations per second of the last ones of this session; None before there are two.
    """

    header: RunHeader
    done: int
    feasible: int
    causes: dict[Status, int]
    exceeded: dict[str, int]
    generations: tuple[Generation, ...]
    front: tuple[Evaluation, ...]
    others: tuple[Evaluation, ...]
    latest: float | None
    pace: float | None

    @property
    def seconds_left(self) -> float | None:
        """Until the budget is used up, at this pace; None while the pace is unknown."""
        return None if not self.pace else max(0, self.header.budget - self.done) / self.pace

    @property
    def growth(self) -> HypervolumeGrowth | None:
        """What the last doubling of evaluations gained; None before there is one."""
        return growth(self.generations)


class LiveRun:
    """Learns the records of a log in the order in which they are written."""

    def __init__(self) -> None:
        self._header: RunHeader | None = None
        self._numbers: set[int] = set()
        self._feasible = 0
        self._causes: dict[Status, int] = {}
        self._exceeded: dict[str, int] = {}
        self._generations: dict[int, Generation] = {}
        self._front: tuple[Evaluation, ...] = ()
        self._others: list[Evaluation] = []
        self._every = 1
        self._times: list[float] = []

    def learn(self, records: Sequence[tuple[msgspec.Struct, float]]) -> None:
        """Take in new records, each with the time when it was written."""
        born: list[Evaluation] = []
        for record, written in records:
            if isinstance(record, RunHeader):
                self._header = record
                self._times = []
            elif isinstance(record, Generation):
                self._generations[record.number] = record
            elif isinstance(record, Evaluation) and record.number not in self._numbers:
                self._count(record, written)
                born.append(record)
        if self._header is not None and born:
            self._sort(self._header, born)
            for evaluation in born:
                for bounds in exceeded_bounds(self._header.constrained, evaluation.assessment):
                    self._exceeded[bounds] = self._exceeded.get(bounds, 0) + 1

    @property
    def state(self) -> LiveState | None:
        """Where the search stands; None before the log's header is known."""
        if self._header is None:
            return None
        times = self._times
        span = times[-1] - times[0] if len(times) > 1 else 0.0
        return LiveState(
            header=self._header,
            done=len(self._numbers),
            feasible=self._feasible,
            causes=dict(self._causes),
            exceeded=dict(self._exceeded),
            generations=tuple(self._generations[number] for number in sorted(self._generations)),
            front=self._front,
            others=tuple(self._others),
            latest=times[-1] if times else None,
            pace=(len(times) - 1) / span if span > 0.0 else None,
        )

    @property
    def gaps(self) -> list[str]:
        """A sentence on evaluations that are missing below the last concluded generation, if any are."""
        concluded = max((state.evaluations for state in self._generations.values()), default=0)
        lost = missing(self._numbers, concluded)
        return [f"missing evaluations: {listed(lost)}"] if lost else []

    def _count(self, evaluation: Evaluation, written: float) -> None:
        self._numbers.add(evaluation.number)
        self._feasible += evaluation.feasible
        status = evaluation.assessment.status
        if status is not Status.SOLVED:
            self._causes[status] = self._causes.get(status, 0) + 1
        self._times = [*self._times[-PACE_OVER:], written]

    def _sort(self, header: RunHeader, born: Sequence[Evaluation]) -> None:
        """Put new evaluations on the front or into the sample of the others."""
        before = self._front
        self._front = front(header.objectives, [*before, *born])
        kept = {evaluation.number for evaluation in self._front}
        names = {objective.name for objective in header.objectives}
        self._others += [
            each
            for each in (*before, *born)
            if each.number not in kept
            and each.number % self._every == 0
            and each.feasible
            and names <= set(each.assessment.objectives)
        ]
        while len(self._others) > SAMPLE:
            self._every *= 2
            self._others = [each for each in self._others if each.number % self._every == 0]


def state_of(live_state: LiveState, *, ended: bool, now: float, notes: Sequence[str] = ()) -> dict[str, Any]:
    """The JSON object of a live run's state.

    Args:
        live_state: of the search.
        ended: whether the last session closed its log.
        now: seconds since 1970.
        notes: sentences on what cannot be read of the log, or is missing.
    """
    header = live_state.header
    objectives = header.objectives
    found = best(objectives, live_state.front)
    drawn = live_state.front[:: 1 + len(live_state.front) // MOST_POINTS]
    return {
        "problem": header.problem_name,
        "algorithm": header.search.algorithm,
        "population": header.search.population,
        "seed": header.search.seed,
        "state": word(live_state, ended=ended, now=now),
        "notes": list(notes),
        "done": live_state.done,
        "budget": header.budget,
        "feasible": live_state.feasible,
        "failures": {str(status): count for status, count in live_state.causes.items()},
        **({"exceeded": live_state.exceeded} if header.constrained else {}),
        "per_second": live_state.pace,
        "seconds_left": live_state.seconds_left,
        "growth": None if live_state.growth is None else live_state.growth.json,
        "silent_seconds": None if live_state.latest is None else max(0.0, now - live_state.latest),
        "objectives": [
            {"name": each.name, "unit": each.unit, "sense": each.sense, "best": found.get(each.name)}
            for each in objectives
        ],
        "generations": [
            {
                "number": each.number,
                "evaluations": each.evaluations,
                "hypervolume": each.hypervolume,
                "feasible_share": each.feasible_share,
            }
            for each in live_state.generations
        ],
        "front": [_point(header, each) for each in drawn],
        "front_size": len(live_state.front),
        "others": [_point(header, each) for each in live_state.others],
        "knees": [_point(header, each) for each in knees(objectives, live_state.front)[:MOST_KNEES]],
    }


def word(live_state: LiveState, *, ended: bool, now: float) -> str:
    """The state in a word: finished, stopped, running, or silent for a minute or more."""
    if live_state.done >= live_state.header.budget:
        return "finished"
    if ended:
        return "stopped"
    latest = live_state.latest
    return "silent" if latest is not None and now - latest > SILENCE else "running"


def _point(header: RunHeader, evaluation: Evaluation) -> list[float]:
    """Number and objectives of a design."""
    values = evaluation.assessment.objectives
    return [evaluation.number, *(values[objective.name] for objective in header.objectives)]


class FollowedRun:
    """A run that is being written, looked at again and again.

    Args:
        directory: of the run.
    """

    def __init__(self, directory: Path) -> None:
        self.directory = directory
        self._follower = Follower(directory)
        self._live_run = LiveRun()
        self._lock = threading.Lock()

    def look(self) -> LiveState:
        """Where the search stands now.

        Raises:
            RunError: the log's header cannot be read.
        """
        with self._lock:
            self._live_run.learn([(logged.record, logged.time) for logged in self._follower.look()])
        live_state = self._live_run.state
        if live_state is None:
            raise RunError(f"{self.directory}: the log has no header yet, so there is nothing to watch")
        return live_state

    @property
    def ended(self) -> bool:
        """Whether the last session closed its log."""
        return self._follower.ended

    @property
    def notes(self) -> tuple[str, ...]:
        """What cannot be read, or is missing."""
        return (*self._follower.notes, *self._live_run.gaps)

    def state(self) -> dict[str, Any]:
        """Where the search stands now, as the JSON object of the page."""
        live_state = self.look()
        return state_of(live_state, ended=self.ended, now=time.time(), notes=self.notes)
