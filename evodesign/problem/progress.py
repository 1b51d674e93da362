"""Who is shown what a problem needs before its first evaluation; a module that loads no solver."""

from __future__ import annotations

from collections.abc import Sequence

from evodesign.problem.time_left import PendingPiece


class PrecomputeProgress:
    """Is shown how far the pieces are; this one does nothing with it."""

    def missing(self, pieces: Sequence[PendingPiece], processes: int) -> None:
        """These have to be worked out, by so many processes: all at once; more if the cache is damaged."""

    def done(self, piece: PendingPiece, seconds: float) -> None:
        """One of them is, and took so many seconds."""

    def note(self, sentence: str) -> None:
        """Something that makes it take longer."""


SILENT = PrecomputeProgress()
"""For those who want to see nothing."""
