"""Who is shown what a problem needs before its first evaluation; a module that loads no solver."""

from __future__ import annotations

__all__ = ["SILENT", "PrecomputeProgress"]


class PrecomputeProgress:
    """Is shown how far the pieces are; this one does nothing with it."""

    def missing(self, pieces: int) -> None:
        """So many pieces have to be worked out, all stages together; more if the cache is damaged."""

    def done(self, piece: str) -> None:
        """One of them is."""

    def note(self, sentence: str) -> None:
        """Something that makes it take longer."""


SILENT = PrecomputeProgress()
"""For those who want to see nothing."""
