"""What a run remembers while it goes on, and someone who watches it: a progress bar, a test.

A resumed search asks again for everything that it asked for before; memory, the log of earlier sessions and
this session's, answers what is known, checks that it was asked for the same, and writes down what is new. The
new segment is opened at the first new record, so that a run with nothing left to do is left as it is.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from types import TracebackType
from typing import Self

from evodesign.errors import ResumeMismatch, RunError
from evodesign.records import Detail, Evaluation, Front, Generation, Genome, RunHeader, Turn
from evodesign.runlog.run import RunLog
from evodesign.runlog.writer import RunWriter

LONGEST_WAIT = 0.1
"""Longest time [s] for which evaluations wait for others to reach the disk with them."""


class SessionLog:
    """Evaluations by number, as long as they are needed; a context manager that ends the segment it opened.

    Args:
        run: what earlier sessions left.
        open_log: makes the writer of this session's segment.
    Attributes:
        evaluations: how many are known.
    """

    def __init__(self, run: RunLog, open_log: Callable[[], RunWriter]) -> None:
        self._directory = run.directory
        self._evaluations = {evaluation.number: evaluation for evaluation in run.evaluations}
        self.evaluations = len(self._evaluations)
        self._generations = {generation.number for generation in run.generations}
        self._fronts = {front.generation for front in run.fronts}
        self._open_log = open_log
        self._opened: RunWriter | None = None
        self._committed = time.monotonic()

    def turns(self) -> dict[int, Turn]:
        """The turns, by number of evaluation, of all that is known of an asynchronous run.

        Raises:
            RunError: an evaluation is missing between others, and what was asked after it cannot be checked.
        """
        turns = {number: known.turn for number, known in sorted(self._evaluations.items()) if known.turn}
        missing = next((place for place, number in enumerate(turns) if place != number), None)
        if missing is not None:
            raise RunError(
                f"{self._directory}: evaluation {missing} cannot be read, and an asynchronous search "
                f"cannot go on without it; see what it found with: evodesign front {self._directory}"
            )
        return turns

    def recall(self, number: int, genome: Genome) -> Evaluation | None:
        """The evaluation of a number, if an earlier session left it; it is given once and then let go.

        Raises:
            ResumeMismatch: it is known, but of another genome.
        """
        known = self._evaluations.pop(number, None)
        if known is not None and known.genome != genome:
            raise ResumeMismatch(
                f"{self._directory}: evaluation {number} is of another genome than the search now asks for; "
                "the log was changed, or another version of the search wrote it: start a new run"
            )
        return known

    def concluded(self, generation: int) -> bool:
        """Whether the state and the front after a generation are known."""
        return generation in self._generations and generation in self._fronts

    def remember(self, evaluation: Evaluation, detail: Detail | None, *, more: bool = False) -> None:
        """Put a new evaluation on the disk, after its postures if there are any to keep.

        With `more` to come at once, it may wait for them, so that they reach the disk together.
        """
        if detail is not None:
            self._log().write(detail)
        self._log().write(evaluation)
        if not more or time.monotonic() - self._committed > LONGEST_WAIT:
            self._log().commit()
            self._committed = time.monotonic()
        self.evaluations += 1

    def conclude(self, generation: Generation, front: Front) -> None:
        """Put the state and the front after a generation on the disk, each unless it is known."""
        if generation.number not in self._generations:
            self._log().write(generation)
            self._generations.add(generation.number)
        if front.generation not in self._fronts:
            self._log().write(front)
            self._fronts.add(front.generation)
        self._log().commit()

    def _log(self) -> RunWriter:
        if self._opened is None:
            self._opened = self._open_log()
        return self._opened

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, where: TracebackType | None
    ) -> None:
        if self._opened is not None:
            self._opened.close()


class Observer:
    """Someone who watches a session; what it is shown is in the log already. Its methods do nothing here."""

    def started(self, header: RunHeader, evaluations_done: int) -> None:
        """A session begins, with so many evaluations known."""

    def evaluated(self, evaluation: Evaluation, done: int, budget: int) -> None:
        """A new evaluation is logged; `done` of `budget` are."""

    def generation_done(self, generation: Generation) -> None:
        """A new generation is concluded."""

    def finished(self, run: RunLog) -> None:
        """The budget is used up."""


class Silent(Observer):
    """An observer that keeps still."""
