"""What a search has been told, as arrays, and the models made of it.

The models of objectives know feasible designs, that of a margin all designs in which it is known. When
they are made anew from more than a thousand, those stay that few others dominate, and the newest.

Hypervolumes are measured against a reference point. Where none is given it moves with the front: its worst
values, but none worse than nine in ten of the first designs, and a tenth of the first designs' range beyond.

Beyond 300 lines: arrays and the models made of them are changed together.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import partial

import moocore
import numpy as np
from numpy.typing import NDArray

from evodesign.records import Genome, SearchSettings
from evodesign.searches.base import Gradient, ObjectivePart, Outcome
from evodesign.searches.ranking import usable
from evodesign.searches.surrogate.approximation import (
    FEWEST_FIRST,
    FIRST_PER_DIMENSION,
    KEPT,
    REDRAWN,
    Approximation,
    Function,
    Known,
)
from evodesign.searches.surrogate.feasibility import LATEST, Feasibility, margins_of_violations

Array = NDArray[np.float64]

NEWEST = 200
"""Designs that stay whatever they are worth."""

USUAL, MARGIN = 0.9, 0.1
"""Of the first designs, the share that no reference is worse than, and that of their range beyond it."""

FEWEST = 4
"""Designs without which there is no model."""


class Knowledge:
    """Everything told, in the order of telling.

    Args:
        settings: dimension, objectives, choices and seed.
    """

    def __init__(self, settings: SearchSettings) -> None:
        self._settings = settings
        self._discrete = np.array(settings.counts) > 0
        self._genomes = _Rows(settings.dimension)
        self._outcomes: list[Outcome] = []
        self._feasible: list[int] = []
        self._objectives = _Rows(settings.objectives)
        self._known: list[int] = []
        self._within: list[list[int]] = []
        self._violated = False
        self._front: tuple[int, Array, Array] | None = None
        self._first: Array | None = None
        self._parts: tuple[int, ...] = ()
        self._model, self._violations, self._failures = (_Maintained(self._discrete) for _ in range(3))
        self._margins: list[_Maintained] = []

    def __len__(self) -> int:
        return len(self._outcomes)

    def add(self, genome: Genome, outcome: Outcome) -> None:
        """Take note of an outcome."""
        values = usable(outcome)
        violation = _violation(outcome)
        if violation is not None:
            self._known.append(len(self))
            self._violated |= violation > 0.0
            self._add_margins(outcome.margins)
        if values is not None:
            if not self._feasible:
                self._parts = tuple(map(len, outcome.parts)) or (0,) * len(values)
            self._feasible.append(len(self))
            self._objectives.append(values)
            if genome in self._settings.start[:1]:
                self._first = np.array(values)
        self._genomes.append(genome)
        self._outcomes.append(outcome)

    def _add_margins(self, margins: Sequence[float | None]) -> None:
        """Take note of where each margin of the latest design is known."""
        if len(margins) > len(self._within):
            self._within = [[] for _ in margins]
            self._margins = [_Maintained(self._discrete) for _ in margins]
        for known, margin in zip(self._within, margins, strict=False):
            if margin is not None:
                known.append(len(self))

    @property
    def points(self) -> Array:
        """Every genome told [designs x dimension]."""
        return self._genomes.array

    @property
    def first_start(self) -> Array | None:
        """Objectives of the first start genome: the robot as it is; None where it is not feasible."""
        return self._first

    def front(self) -> tuple[Array, Array]:
        """Points and objectives of the feasible designs that no other dominates."""
        values = self._objectives.array
        if not len(values):
            return np.empty((0, self._settings.dimension)), values
        if self._front is None or self._front[0] != len(values):
            best = np.flatnonzero(moocore.is_nondominated(values))
            places = [self._feasible[place] for place in best]
            self._front = len(values), self.points[places], values[best]
        return self._front[1:]

    def reference(self) -> Array:
        """Values of the objectives beyond which a design counts for nothing; ones while none is feasible."""
        if not self._feasible:
            return np.ones(self._settings.objectives)
        first = self._objectives.array[
            : max(FEWEST_FIRST, int(FIRST_PER_DIMENSION * self._settings.dimension))
        ]
        _, front = self.front()
        usual = np.minimum(front.max(axis=0), np.quantile(first, USUAL, axis=0))
        extent = np.ptp(first, axis=0)
        margin = MARGIN * np.where(extent > 0.0, extent, np.maximum(np.abs(usual), 1.0))
        given = np.array([math.nan if each is None else each for each in self._settings.reference_values])
        return np.where(np.isnan(given), usual + margin, given)

    def modelled(self, generator: np.random.Generator) -> Approximation | None:
        """The model of the objectives; None while too few designs are feasible.

        Args:
            generator: draws features when they are drawn anew.
        """
        counts = [max(count, 1) for count in self._parts]
        means = np.repeat(np.eye(len(counts)), counts, axis=0) / counts
        return self._model.of(len(self._feasible), self._reported, self._kept, generator, means)

    def _reported(self, which: NDArray[np.intp]) -> Known:
        """Some of the feasible designs."""
        places = [self._feasible[place] for place in which]
        rows = [self._parts_of(self._outcomes[place]) for place in places]
        targets = np.array([[part.value for part in row] for row in rows])
        gradients = self._gradients([[part.gradient for part in row] for row in rows], targets.shape[1])
        return Known(self.points[places], targets, gradients)

    def _parts_of(self, outcome: Outcome) -> list[ObjectivePart]:
        """What is modelled of an outcome: parts of objectives as the first feasible one has, or the whole.

        An objective whose parts are not known counts as if they were equal, without gradients.
        """
        found = []
        for place, (value, count) in enumerate(zip(usable(outcome) or (), self._parts, strict=True)):
            parts = outcome.parts[place] if outcome.parts else ()
            if not count:
                found.append(ObjectivePart(value, outcome.gradients[place] if outcome.gradients else None))
            elif len(parts) == count:
                found += parts
            else:
                found += [ObjectivePart(value, None)] * count
        return found

    def _gradients(self, rows: Sequence[Sequence[Gradient | None]], outputs: int) -> Array:
        """[designs x outputs x dimension], nan where unknown."""
        found = np.full((len(rows), outputs, self._settings.dimension), np.nan)
        for place, row in enumerate(rows):
            for output, gradient in enumerate(row):
                if gradient is not None:
                    found[place, output] = [math.nan if each is None else each for each in gradient]
        return found

    def _kept(self) -> NDArray[np.intp]:
        """Which feasible designs a new model is made of, of more than may be."""
        values = self._objectives.array
        ranks = np.asarray(moocore.pareto_rank(values)).astype(float)
        ranks[-NEWEST:] = -1.0
        return np.sort(np.argsort(ranks, kind="stable")[:KEPT])

    def feasibility(self, generator: np.random.Generator) -> Feasibility:
        """Where designs are expected to be feasible.

        Args:
            generator: draws the features of the margins' model.
        """
        latest = list(map(_violation, self._outcomes[-LATEST:]))
        failures = None
        margins = self._expected_margins(generator) if self._violated else []
        if 0 < len(self._known) < len(self):
            failures = self._failures.of(len(self), self._failures_reported, _newest(len(self)), generator)
        share = latest.count(None) / max(len(latest), 1)
        return Feasibility(
            margins,
            None if failures is None else failures.expected(),
            share,
        )

    def _failures_reported(self, which: NDArray[np.intp]) -> Known:
        """+1 for designs that failed, -1 for others."""
        told = [self._outcomes[place] for place in which]
        signs = np.array([[1.0 if _violation(each) is None else -1.0] for each in told])
        return Known(self.points[which], signs, self._gradients([()] * len(signs), 1))

    def _expected_margins(self, generator: np.random.Generator) -> list[Function]:
        """What each margin is expected to be, of those that enough is known of; else of the violation."""
        found = [
            model.of(len(known), partial(self._margin_reported, place), _newest(len(known)), generator)
            for place, (model, known) in enumerate(zip(self._margins, self._within, strict=True))
        ]
        if not self._within:
            count = len(self._known)
            found = [self._violations.of(count, self._violations_reported, _newest(count), generator)]
        return [model.expected() for model in found if model is not None]

    def _margin_reported(self, margin: int, which: NDArray[np.intp]) -> Known:
        """Some of the designs in which a margin is known."""
        told = [self._within[margin][place] for place in which]
        outcomes = [self._outcomes[place] for place in told]
        targets = np.array([[outcome.margins[margin]] for outcome in outcomes], dtype=float)
        slopes = [outcome.margin_gradients[margin : margin + 1] for outcome in outcomes]
        return Known(self.points[told], targets, self._gradients(slopes, 1))

    def _violations_reported(self, which: NDArray[np.intp]) -> Known:
        """Some of the designs whose violation is known."""
        told = [self._known[place] for place in which]
        violations = np.array([_violation(self._outcomes[place]) for place in told], dtype=float)
        return Known(
            self.points[told], margins_of_violations(violations), self._gradients([()] * len(told), 1)
        )


def _violation(outcome: Outcome) -> float | None:
    """Of an outcome that did not fail: zero or more."""
    if usable(outcome) is not None:
        return 0.0
    violation = outcome.violation
    return violation if violation is not None and 0.0 < violation < math.inf else None


def _newest(count: int) -> Callable[[], NDArray[np.intp]]:
    """The places of the newest of so many."""
    return lambda: np.arange(max(0, count - KEPT), count)


class _Rows:
    """Rows of numbers that grow in number; the array of them is made without copying each.

    Args:
        width: of a row.
    """

    def __init__(self, width: int) -> None:
        self._room, self._count = np.empty((64, width)), 0

    def append(self, row: Sequence[float]) -> None:
        """Add a row."""
        if self._count == len(self._room):
            self._room = np.concatenate([self._room, np.empty_like(self._room)])
        self._room[self._count] = row
        self._count += 1

    @property
    def array(self) -> Array:
        """All rows [rows x width]; not to be written to."""
        return self._room[: self._count]


class _Maintained:
    """A model to which designs are added, made anew now and then.

    Args:
        discrete: which coordinates have no gradients.
    """

    def __init__(self, discrete: NDArray[np.bool_]) -> None:
        self._discrete = discrete
        self._model: Approximation | None = None
        self._made_at = self._count = 0

    def of(
        self,
        count: int,
        reported: Callable[[NDArray[np.intp]], Known],
        kept: Callable[[], NDArray[np.intp]],
        generator: np.random.Generator,
        means: Array | None = None,
    ) -> Approximation | None:
        """The model of so many designs; None of too few.

        Args:
            count: of the designs.
            reported: gives some of them.
            kept: gives the places of those that stay where there are more than may be.
            generator: draws features when they are drawn anew.
            means: what is made of the modelled outputs; None for the outputs themselves.
        """
        if count < FEWEST:
            return None
        model = self._model
        if model is None or count >= self._made_at + min(REDRAWN, self._made_at):
            known = reported(kept() if count > KEPT else np.arange(count))
            model = Approximation(known, self._discrete, generator, means=means)
            self._made_at = count
        elif count > self._count:
            model.add(reported(np.arange(self._count, count)))
        self._model, self._count = model, count
        return model
