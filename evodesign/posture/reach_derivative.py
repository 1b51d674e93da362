"""How the highest and the lowest load that a design can hold move with the design.

An extreme height is the solution of the reach problem, not its optimal cost (which holds a little comfort),
so its derivative is that of the solution (`sensitivity`). Every start is solved as for the reach itself; the
one that counts is differentiated, and the next best other optimum is where another one may win.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from evodesign.nlp.optimality import Array, NotDifferentiable
from evodesign.nlp.program import IpoptOptions
from evodesign.nlp.sensitivity import Limit, SolutionSensitivity
from evodesign.posture.formulations.reach import ReachProblem
from evodesign.posture.solution_derivative import labels_of
from evodesign.records import Status

__all__ = ["ReachDerivative", "ReachDerivatives"]

DISTINCT = 1e-6
"""Difference of heights [m] above which two optima are not the same."""


@dataclass(frozen=True, slots=True)
class ReachDerivative:
    """An extreme height made exact, and how it moves with the design.

    Args:
        height: [m].
        slope: its derivative with respect to each parameter.
        start: which start won, from zero.
        starts: how many there were.
        runner_up: how far the next best other optimum falls short [m]; None when there is no other.
        limits: every inequality, with slopes per parameter.
    """

    height: float
    slope: Array
    start: int
    starts: int
    runner_up: float | None
    limits: tuple[Limit, ...]


class ReachDerivatives:
    """Tangents of what a reach problem finds."""

    def __init__(self, reach: ReachProblem, options: IpoptOptions) -> None:
        self._reach = reach
        self._sensitivity = SolutionSensitivity(reach.program, options, labels_of((reach.form,)))

    def at(self, design: Sequence[float], sense: float) -> ReachDerivative | NotDifferentiable:
        """The tangent of a design's highest or lowest load, or why it has none."""
        solves = self._reach.solves(design, sense)
        heights = {
            start: float(raw.values["height"][0])
            for start, raw in enumerate(solves)
            if raw.status is Status.SOLVED
        }
        if not heights:
            return NotDifferentiable("no posture was found")
        start = min(heights, key=lambda number: sense * heights[number])
        if self._at_end(heights[start]):
            return ReachDerivative(heights[start], np.zeros(len(design)), start, len(solves), None, ())
        found = self._sensitivity.at([*design, self._reach.mass, sense], solves[start].values)
        if isinstance(found, NotDifferentiable):
            return found
        slope = found.slopes["height"][0, : len(design)]
        if np.isnan(slope).any():
            return NotDifferentiable("the height is not determined")
        short = [sense * (height - heights[start]) for height in heights.values()]
        own = slice(len(design))
        return ReachDerivative(
            height=float(found.values["height"][0]),
            slope=slope,
            start=start,
            starts=len(solves),
            runner_up=min((much for much in short if much > DISTINCT), default=None),
            limits=tuple(Limit(x.name, x.active, x.margin, x.slope[own]) for x in found.limits),
        )

    def _at_end(self, height: float) -> bool:
        """Whether a height ends the range that is looked at, whatever the design: a load on the ground."""
        block = next(v for v in self._reach.program.variables if v.name == "height")
        return bool(min(height - block.lower[0], block.upper[0] - height) < DISTINCT)
