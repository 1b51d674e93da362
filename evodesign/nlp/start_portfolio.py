"""Starts from which nearly every design converges to its best known optimum, and how well they do."""

from __future__ import annotations

from collections.abc import Sequence

import msgspec
import numpy as np

from evodesign.nlp.program import Start

__all__ = ["Coverage", "Neighbourhood", "StartPortfolio"]


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


class Neighbourhood(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Which starts are nearest to a design.

    Args:
        metric: one row per design parameter; takes a design to a place.
        places: of the designs whose optima the starts are.
        tried: how many starts a design is solved from.
    """

    metric: tuple[tuple[float, ...], ...]
    places: tuple[tuple[float, ...], ...]
    tried: int

    def nearest(self, design: Sequence[float]) -> list[int]:
        """Numbers of the starts that a design is solved from, the nearest first."""
        apart = np.asarray(self.places) - np.asarray(design) @ np.asarray(self.metric)
        order: list[int] = np.argsort(np.square(apart).sum(axis=1), kind="stable").tolist()
        return order[: self.tried]


class StartPortfolio(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Starts, and how good they are; none where nothing could be trained.

    Args:
        starts: the one that serves most first, or one for each of many designs.
        coverage: how good they are.
        neighbourhood: which of them serve which designs; left out, all serve all.
    """

    starts: tuple[Start, ...]
    coverage: Coverage
    neighbourhood: Neighbourhood | None = None

    def near(self, design: Sequence[float]) -> tuple[Start, ...]:
        """The starts that a design is solved from, the best ones first."""
        if self.neighbourhood is None:
            return self.starts
        return tuple(self.starts[number] for number in self.neighbourhood.nearest(design))

    @property
    def count(self) -> int:
        """How many starts a design is solved from."""
        return len(self.starts) if self.neighbourhood is None else self.neighbourhood.tried
