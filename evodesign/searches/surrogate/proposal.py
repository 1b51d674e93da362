"""Which genomes are to be evaluated next, by the model.

Half of a batch comes from Thompson samples of the global model, four from each, the other half from its
mean with the local residual: the first explore, the second refine. Each part is the best of a small
evolution (`evolution`) that starts from the front, chosen by hypervolume (`selection`). Two that refine seek
an end, the objectives by turns: one that of the front, as beyond a reference point that nobody gave an end
adds no hypervolume and is on the front all the same; one that of the designs that are nowhere worse than the
first start, the robot as it is. Designs on their way count as if they were what the model expects. A genome
that is known already is moved a little.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from evodesign.records import Genome, SearchSettings
from evodesign.searches.discrete import snapped
from evodesign.searches.surrogate.approximation import Function
from evodesign.searches.surrogate.evolution import MEMBERS, Judged, Members, evolved
from evodesign.searches.surrogate.feasibility import Feasibility
from evodesign.searches.surrogate.knowledge import Knowledge
from evodesign.searches.surrogate.selection import FRONT, chosen

Array = NDArray[np.float64]

OF_ONE_SAMPLE = 4
FIRST_GENERATIONS, GENERATIONS = 25, 12
ANYWHERE = 20
"""Random points among those an evolution starts from."""

LEAST = 1e-6
"""Distance of ideal and reference, relative to the latter, that is always left between them."""

FURTHER = 1e-3
"""By how much of an objective's range an end must be expected to lie further out."""

SAME = 1e-8
"""Squared distance below which a genome is known already."""

MOVED, TRIES = 0.03, 50


def proposals(
    knowledge: Knowledge,
    settings: SearchSettings,
    count: int,
    generator: np.random.Generator,
    on_their_way: Sequence[Genome] = (),
) -> tuple[Genome, ...]:
    """So many genomes, or none while nothing can be learnt from what is known.

    Args:
        knowledge: what was told.
        settings: of the search.
        count: how many genomes.
        generator: the only source of randomness.
        on_their_way: genomes that were asked for, and are not told yet.
    """
    model = knowledge.modelled(generator)
    feasibility = knowledge.feasibility(generator)
    points, values = knowledge.front()
    if model is None and not feasibility.informed:
        return ()
    batch = _Batch(settings, feasibility, points, values, knowledge.reference(), generator)
    if model is None:
        batch.take(None, count, FIRST_GENERATIONS)
        return batch.genomes(knowledge.points)
    expected = model.expected()
    batch.expect(expected, on_their_way)
    drawn = (count + len(knowledge) % 2) // 2
    for first in range(0, drawn, OF_ONE_SAMPLE):
        generations = FIRST_GENERATIONS if first == 0 else GENERATIONS
        batch.take(model.drawn(generator), min(OF_ONE_SAMPLE, drawn - first), generations)
    if settings.objectives > 1:
        turn = len(knowledge) // count % settings.objectives
        if count - batch.size > 1:
            batch.take_end(expected, turn)
        start = knowledge.first_start
        if start is not None and count - batch.size > 1:
            batch.take_end(expected, turn, no_worse_than=start)
    batch.take(expected, count - batch.size, GENERATIONS if drawn else FIRST_GENERATIONS)
    return batch.genomes(knowledge.points)


class _Batch:
    """The genomes of a batch, as they are found."""

    def __init__(
        self,
        settings: SearchSettings,
        feasibility: Feasibility,
        points: Array,
        values: Array,
        reference: Array,
        generator: np.random.Generator,
    ) -> None:
        self._settings, self._feasibility, self._generator = settings, feasibility, generator
        self._ideal, self._range = np.zeros(settings.objectives), np.ones(settings.objectives)
        if len(values):
            self._ideal = values.min(axis=0)
            self._range = np.maximum(reference - self._ideal, LEAST * np.maximum(np.abs(reference), 1.0))
        order = generator.permutation(len(points))
        self._ends, self._known = points[order], self._scaled(values)[order]
        self._front = self._known[: FRONT.get(settings.objectives)]
        self._population = np.empty((0, settings.dimension))
        self._found: list[Array] = []

    def _scaled(self, values: Array) -> Array:
        return np.asarray((values - self._ideal) / self._range)

    def expect(self, function: Function, genomes: Sequence[Genome]) -> None:
        """Reckon with designs on their way as the model expects them."""
        if genomes:
            self._front = np.vstack([self._front, self._scaled(function(np.array(genomes)))])

    @property
    def size(self) -> int:
        """How many were found."""
        return len(self._found)

    def take(self, function: Function | None, count: int, generations: int) -> None:
        """Add the best of an evolution on a function; None stands for nothing but feasibility."""
        if count == 0:
            return
        evolved_members = self._evolved(self._judged(function), generations)
        self._population = evolved_members.points
        members = _without(evolved_members, self._found)
        for place in chosen(members, self._front, count, self._generator):
            self._add(members.points[place], members.objectives[place])

    def take_end(self, function: Function, objective: int, no_worse_than: Array | None = None) -> None:
        """Add the best in one objective, if it is expected to be better than all that is known.

        What lies beyond a reference that was given counts as infeasible.

        Args:
            function: the objectives that are expected.
            objective: its place.
            no_worse_than: values that no objective may exceed; None for the end of the whole front.
        """
        judged = self._judged(function)
        given = [value is not None for value in self._settings.reference_values]
        limits = np.where(given, 1.0, np.inf)
        if no_worse_than is not None:
            limits = np.minimum(limits, self._scaled(no_worse_than))

        def one(points: Array) -> tuple[Array, Array]:
            objectives, infeasibility = judged(points)
            return objectives[:, [objective]], infeasibility + _beyond(objectives, limits)

        within = _beyond(self._known, limits) == 0.0
        least = self._known[within, objective].min(initial=min(limits[objective], 1.0))
        members = self._evolved(one, GENERATIONS, first=within)
        best = np.lexsort((members.objectives[:, 0], members.infeasibility))[0]
        if members.infeasibility[best] == 0.0 and members.objectives[best, 0] < least - FURTHER:
            self._add(members.points[best], judged(members.points[[best]])[0][0])

    def _evolved(self, judged: Judged, generations: int, first: NDArray[np.bool_] | None = None) -> Members:
        """An evolution that starts from the front, from some of it before others."""
        counts, generator = self._settings.counts, self._generator
        anywhere = snapped(generator.random((ANYWHERE, self._settings.dimension)), counts)
        known = self._ends if first is None else np.vstack([self._ends[first], self._ends[~first]])
        start = np.vstack([known[:MEMBERS], self._population, anywhere])
        return evolved(judged, start, generations, counts, generator)

    def _add(self, point: Array, objectives: Array) -> None:
        self._found.append(point)
        self._front = np.vstack([self._front, objectives])

    def _judged(self, function: Function | None) -> Judged:
        def judged(points: Array) -> tuple[Array, Array]:
            nothing = np.zeros((len(points), self._settings.objectives))
            objectives = nothing if function is None else self._scaled(function(points))
            return objectives, self._feasibility(points)

        return judged

    def genomes(self, known: Array) -> tuple[Genome, ...]:
        """All that were found, moved where they are known."""
        taken = known
        found: list[Genome] = []
        for point in self._found:
            moved = self._unknown(point, taken)
            taken = np.vstack([taken, moved])
            found.append(tuple(moved.tolist()))
        return tuple(found)

    def _unknown(self, point: Array, known: Array) -> Array:
        """A point, or one near it that is not known; anywhere in the end, where there are few choices."""
        counts, generator = self._settings.counts, self._generator
        discrete, moved = np.array(counts) > 0, point
        for attempt in range(TRIES):
            if ((known - moved) ** 2).sum(axis=1).min(initial=np.inf) > SAME:
                return moved
            step = MOVED * generator.standard_normal(len(point))
            anew = generator.random(len(point))
            changed = discrete & (generator.random(len(point)) < attempt / TRIES)
            moved = snapped(np.clip(np.where(changed, anew, point + step), 0.0, 1.0)[None], counts)[0]
        return moved


def _beyond(objectives: Array, limits: Array) -> Array:
    """By how much objectives exceed limits, summed."""
    return np.asarray(np.maximum(objectives - limits, 0.0).sum(axis=1))


def _without(members: Members, found: Sequence[Array]) -> Members:
    """The members that are none of the points that were found."""
    if not found:
        return members
    distances = ((members.points[:, None] - np.array(found)) ** 2).sum(axis=2).min(axis=1)
    return members.part(np.flatnonzero(distances > SAME))
