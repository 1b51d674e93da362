"""Who is shown what a problem needs before its first evaluation; a module that loads no solver."""

from __future__ import annotations


class PrecomputeProgress:
    """Is shown how far the pieces are; this one does nothing with it."""

    def missing(self, pieces: int) -> None:
        """So many have to be worked out: all at once; more if the cache is damaged."""

    def done(self, piece: str) -> None:
        """One of them is, as it is told."""

    def note(self, sentence: str) -> None:
        """Something that makes it take longer."""


SILENT = PrecomputeProgress()
"""For those who want to see nothing."""


def in_words(seconds: float) -> str:
    """A time left as it may be believed, such as `about 2 min left`."""
    if seconds < 10.0:
        return "a few seconds left"
    if seconds < 55.0:
        return f"about {round(seconds, -1):.0f} s left"
    if seconds < 165.0:
        return f"about {round(seconds / 30.0) / 2.0:g} min left"
    minutes = round(seconds / 60.0)
    if minutes < 10:
        return f"about {minutes} min left"
    if minutes < 90:
        return f"about {5 * round(minutes / 5)} min left"
    return f"about {round(minutes / 60)} h left"
