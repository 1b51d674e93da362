"""What a run remembers while it goes on: the log of earlier sessions, and this session's, which is written.

A resumed search asks again for everything that it asked for before; memory answers what is known, checks
that it was asked for the same, and writes down what is new. The new segment is opened at the first new
record, so that a run with nothing left to do is left as it is.
"""

from __future__ import annotations

from collections.abc import Callable
from types import TracebackType
from typing import Self

from evodesign.errors import ResumeMismatch
from evodesign.records import Detail, Evaluation, Front, Generation, Genome
from evodesign.runlog.run import Run
from evodesign.runlog.writer import RunWriter

__all__ = ["Memory"]


class Memory:
    """Evaluations and generations by number; a context manager that ends the segment it opened.

    Args:
        run: what earlier sessions left.
        open_log: makes the writer of this session's segment.
    """

    def __init__(self, run: Run, open_log: Callable[[], RunWriter]) -> None:
        self._directory = run.directory
        self._evaluations = {evaluation.number: evaluation for evaluation in run.evaluations}
        self._generations = {generation.number: generation for generation in run.generations}
        self._fronts = {front.generation for front in run.fronts}
        self._open_log = open_log
        self._opened: RunWriter | None = None

    @property
    def evaluations(self) -> int:
        """How many evaluations are known."""
        return len(self._evaluations)

    def recall(self, number: int, genome: Genome) -> Evaluation | None:
        """The evaluation of a number, if it is known.

        Raises:
            ResumeMismatch: it is known, but of another genome.
        """
        known = self._evaluations.get(number)
        if known is not None and known.genome != genome:
            raise ResumeMismatch(
                f"{self._directory}: evaluation {number} is of another genome than the search now asks for; "
                "the log was changed, or another version of the search wrote it: start a new run"
            )
        return known

    def generation(self, number: int) -> Generation | None:
        """The state after the generation of a number, if it and its front are known."""
        return self._generations.get(number) if number in self._fronts else None

    def remember(self, evaluation: Evaluation, detail: Detail | None) -> None:
        """Write a new evaluation, after its postures if there are any to keep."""
        if detail is not None:
            self._log().detail(detail)
        self._log().evaluation(evaluation)
        self._evaluations[evaluation.number] = evaluation

    def conclude(self, generation: Generation, front: Front) -> None:
        """Write the state and the front after a generation, each unless it is known."""
        if generation.number not in self._generations:
            self._log().generation(generation)
            self._generations[generation.number] = generation
        if front.generation not in self._fronts:
            self._log().front(front)
            self._fronts.add(front.generation)

    def commit(self) -> None:
        """Return when everything new is on the disk."""
        if self._opened is not None:
            self._opened.commit()

    def _log(self) -> RunWriter:
        if self._opened is None:
            self._opened = self._open_log()
        return self._opened

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        where: TracebackType | None,
    ) -> None:
        if self._opened is not None:
            self._opened.close()
