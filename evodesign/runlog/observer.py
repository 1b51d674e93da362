"""Someone who watches a run being written: a progress bar, a test."""

from __future__ import annotations

from typing import Protocol

from evodesign.records import Evaluation, Generation, RunHeader
from evodesign.runlog.run import Run

__all__ = ["Observer", "Silent"]


class Observer(Protocol):
    """Someone who watches a session; what it is shown is in the log already."""

    def started(self, header: RunHeader, evaluations_done: int) -> None:
        """A session begins, with so many evaluations known."""

    def evaluated(self, evaluation: Evaluation, done: int, budget: int) -> None:
        """A new evaluation is logged; `done` of `budget` are."""

    def generation_done(self, generation: Generation) -> None:
        """A new generation is concluded."""

    def finished(self, run: Run) -> None:
        """The budget is used up."""


class Silent:
    """An observer that keeps still."""

    def started(self, header: RunHeader, evaluations_done: int) -> None:
        """Nothing."""

    def evaluated(self, evaluation: Evaluation, done: int, budget: int) -> None:
        """Nothing."""

    def generation_done(self, generation: Generation) -> None:
        """Nothing."""

    def finished(self, run: Run) -> None:
        """Nothing."""
