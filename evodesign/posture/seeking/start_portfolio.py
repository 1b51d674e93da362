"""Starts from which nearly every design converges to its best known optimum, and how well they do."""

from __future__ import annotations

import msgspec

from evodesign.nlp.program import Start


class Coverage(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """How well a portfolio serves designs that it was not made from.

    Args:
        designs: how many were tried.
        good: how many of them converge close to their best known optimum.
        worst: largest distance of one that converges from the best known optimum, in the cost's unit.
    """

    designs: int
    good: int
    worst: float

    @property
    def share(self) -> float:
        """Share of the designs that are served; 1 where none could be tried."""
        return self.good / self.designs if self.designs else 1.0


class StartPortfolio(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Starts, the one that serves most first, and how good they are; none where nothing could be trained."""

    starts: tuple[Start, ...]
    coverage: Coverage
