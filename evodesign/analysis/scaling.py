"""Objectives made comparable: each as a share of its range over the designs that are compared.

A minimised value f becomes (f - least) / (greatest - least): 0 is the best of the designs, 1 the worst. The
corners are the ideal point and, for the designs of a front, the nadir point (Miettinen 1999, Section 2.4).

An objective in which all agree becomes 0. Designs agree when they differ by less than the inner solver's
tolerance leaves open: without this, noise in the sixth figure would weigh as much as any real difference.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from evodesign.analysis.front import comparable
from evodesign.records import Evaluation, Objective

__all__ = ["Matrix", "Scaled", "scaled"]

NEGLIGIBLE = 1e-4
"""Range, as a share of the largest value's size, below which an objective counts as equal."""

Matrix = NDArray[np.floating[Any]]


@dataclass(frozen=True, slots=True)
class Scaled:
    """Designs with their objectives as shares of the ranges.

    Args:
        designs: those that can be compared, in order of number.
        shares: one row per design, one column per objective, from 0 (best) to 1 (worst).
        least: best minimised value of each objective.
        extent: range of each objective; zero where all agree, or nearly.
    """

    designs: tuple[Evaluation, ...]
    shares: Matrix
    least: Matrix
    extent: Matrix

    def share(self, column: int, minimised_value: float) -> float:
        """A minimised value of an objective as a share of its range; 0 where there is no range."""
        extent = float(self.extent[column])
        return (minimised_value - float(self.least[column])) / extent if extent > 0.0 else 0.0


def scaled(objectives: Sequence[Objective], designs: Sequence[Evaluation]) -> Scaled:
    """Feasible designs with all objectives, these as shares of their ranges."""
    candidates = comparable(objectives, designs)
    points = np.array([values for _, values in candidates]).reshape(len(candidates), len(objectives))
    if not candidates:
        none = np.zeros(len(objectives))
        return Scaled((), points, none, none)
    least = points.min(axis=0)
    extent = np.ptp(points, axis=0)
    extent[extent < NEGLIGIBLE * np.abs(points).max(axis=0)] = 0.0
    shares = np.where(extent > 0.0, (points - least) / np.where(extent > 0.0, extent, 1.0), 0.0)
    return Scaled(tuple(evaluation for evaluation, _ in candidates), shares, least, extent)
