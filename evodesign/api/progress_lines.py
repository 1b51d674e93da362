"""Progress as lines of plain text: of a search, and of what its problem needs before the first evaluation."""

from __future__ import annotations

import time
from collections import Counter
from typing import TextIO

from evodesign.analysis.failures import causes, failures
from evodesign.analysis.growth import growth
from evodesign.errors import on_one_line
from evodesign.evaluation.progress import PrecomputeProgress
from evodesign.records import Evaluation, Generation, RunHeader, Status
from evodesign.runlog.session_log import Observer


class SearchLines(Observer):
    """One line when a session starts and one per generation."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream
        self._began = time.monotonic()
        self._known = self._done = self._budget = 0
        self._failures: Counter[Status] = Counter()
        self._generations: list[Generation] = []

    def started(self, header: RunHeader, evaluations_done: int) -> None:
        """Say what begins."""
        self._began, self._budget = time.monotonic(), header.budget
        self._known = self._done = evaluations_done
        search = header.search
        known = f", {evaluations_done} known" if evaluations_done else ""
        _write(
            self._stream,
            f"{header.problem_name}: {search.algorithm}, population {search.population}, seed {search.seed}, "
            f"{header.budget} evaluations{known}",
        )

    def evaluated(self, evaluation: Evaluation, done: int, budget: int) -> None:
        """Only count."""
        self._done = done
        self._failures += failures([evaluation])

    def generation_done(self, generation: Generation) -> None:
        """Say where the search stands."""
        self._generations.append(generation)
        known = growth(self._generations)
        gain = ""
        if known is not None:
            gain = f"; a doubling may add {known.expected:.1%} ({known.low:.1%} to {known.high:.1%})"
        failed = f"; failed in this session: {causes(self._failures)}" if self._failures else ""
        line = generation_line(generation, self._budget)
        _write(self._stream, f"{line}, {self._left()} left{gain}{failed}")

    def _left(self) -> str:
        """The time left, from the pace of this session."""
        if self._done == self._known:
            return "unknown time"
        pace = (time.monotonic() - self._began) / (self._done - self._known)
        minutes, rest = divmod(round(pace * (self._budget - self._done)), 60)
        return f"{minutes} min {rest} s" if minutes else f"{rest} s"


class PrecomputeLines(PrecomputeProgress):
    """One line for each piece."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream
        self._began = time.monotonic()
        self._pieces = self._done = 0

    def missing(self, pieces: int) -> None:
        """Say what begins."""
        if not self._pieces:
            _write(self._stream, "making the problem ready, once; the next time it is read from the cache")
        self._pieces += pieces

    def done(self, piece: str) -> None:
        """Say what is done."""
        self._done += 1
        passed = time.monotonic() - self._began
        _write(self._stream, f"ready {self._done}/{self._pieces}: {piece} ({passed:.0f} s)")

    def note(self, sentence: str) -> None:
        """Say it."""
        _write(self._stream, f"note: {sentence}")


def generation_line(generation: Generation, budget: int) -> str:
    """One generation of a search with a budget as a line of text."""
    best = " ".join(f"{on_one_line(name)} {_rounded(value)}" for name, value in generation.best.items())
    return (
        f"generation {generation.number}: {generation.evaluations}/{budget} evaluations, "
        f"feasible {generation.feasible_share:.0%}, hypervolume {_rounded(generation.hypervolume)}, "
        f"best {best or '-'}"
    )


def _rounded(value: float | None) -> str:
    return "-" if value is None else f"{value:.4g}"


def _write(stream: TextIO, line: str) -> None:
    stream.write(line + "\n")
    stream.flush()
