"""MAP-Elites: the best design of every kind, by the first objective (archive by pyribs).

Descriptors tell kinds apart: a grid over their bounds has a cell for each kind, which keeps the best design
that fell into it. Where no descriptors are named, the first two coordinates are taken. Bounds that are not
given are those of the first designs, a population at least, and half of their range more on either side;
what lies beyond falls into the cells at the edge.

A child lies near an elite a, and on the line to another one b:

    child = a + ISO normal + LINE scalar normal (b - a)

Most pairs are of any elites, and ISO is one of four lengths; some are of the best twentieth, with shorter
steps. Choices come from either elite, and some are drawn anew. Where the elite's gradient is known, one
child in three goes down it instead, by a step of a random length. While no design is feasible, those that
miss the least stand in for elites.

Source: Mouret and Clune, Illuminating search spaces by mapping elites, 2015; Vassiliades and Mouret,
Discovering the elite hypervolume by leveraging interspecies correlation, 2018 (the children).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from ribs.archives import GridArchive

from evodesign.records import Descriptor, Genome, SearchSettings
from evodesign.searches.base import Outcome
from evodesign.searches.discrete import snapped
from evodesign.searches.quasi_random import Beginning, SobolStream, first_generation, generator_of
from evodesign.searches.ranking import check_outcomes, infeasibility, usable

Array = NDArray[np.float64]

CELLS = 20
"""Parts of a descriptor's range where none are given."""

EXPLOITED, EXPLOITED_WITHOUT_KINDS, BEST = 0.1, 0.5, 20
"""Shares of pairs that are of the best elites, one in so many: few where kinds were asked for."""

FINE, COARSE, NEAR, FAR = (0.01, 0.03), (0.01, 0.03, 0.1, 0.3), 0.3, 0.5
"""ISO and LINE, for children of the best and for others."""

DOWNHILL, STEPS = 1.0 / 3.0, (0.03, 0.1, 0.3)
"""How many children of a known gradient go down it, and how far."""

WIDER = 0.5
"""Share of the first designs' range by which bounds lie beyond it."""

TRIES = 50
"""How often a child that is known is replaced."""


class _Elites:
    """The elites of everything told, and their children.

    Args:
        settings: dimension, choices, descriptors and population.
    """

    def __init__(self, settings: SearchSettings) -> None:
        self._settings = settings
        self._exploited = EXPLOITED if settings.described else EXPLOITED_WITHOUT_KINDS
        self._told = 0
        self._genomes: set[Genome] = set()
        self._first: list[tuple[Genome, Outcome]] = []
        self._missed: list[tuple[float, int, Genome]] = []
        self._archive: GridArchive | None = None
        self._parents: tuple[Array, Array, Array] | None = None

    def add(self, genome: Genome, outcome: Outcome) -> None:
        """Take note of an outcome."""
        self._told += 1
        self._genomes.add(genome)
        self._parents = None
        if usable(outcome) is None:
            self._missed.append((infeasibility(outcome), self._told, genome))
            self._missed = sorted(self._missed)[: self._settings.population]
            return
        if self._place(genome, outcome) is None:
            return
        if self._archive is None:
            self._first.append((genome, outcome))
            if self._told >= self._settings.population and len(self._first) > 1:
                self._archive = self._made()
                self._keep(self._archive, self._first)
                self._first.clear()
        else:
            self._keep(self._archive, [(genome, outcome)])

    def _made(self) -> GridArchive:
        """An empty archive, within bounds that the designs known tell."""
        places = np.array([self._place(*each) for each in self._first])
        low, high = places.min(axis=0), places.max(axis=0)
        wider = np.maximum(WIDER * (high - low), 1e-6 * np.maximum(np.abs(high), 1.0))
        low, high = low - wider, high + wider
        given = self._settings.described
        ranges = [_bounds(each, low[axis], high[axis]) for axis, each in enumerate(given)]
        ranges = ranges or [(0.0, 1.0)] * places.shape[1]
        return GridArchive(
            solution_dim=self._settings.dimension,
            dims=[each.cells for each in given] or [CELLS] * places.shape[1],
            ranges=ranges,
            extra_fields={"slope": ((self._settings.dimension,), np.float64)},
            seed=0,
        )

    def _keep(self, archive: GridArchive, told: Sequence[tuple[Genome, Outcome]]) -> None:
        archive.add(
            np.array([genome for genome, _ in told]),
            np.array([-(outcome.objectives or ())[0] for _, outcome in told]),
            np.array([self._place(*each) for each in told]),
            slope=np.array([self._slope(outcome) for _, outcome in told]),
        )

    def _place(self, genome: Genome, outcome: Outcome) -> tuple[float, ...] | None:
        """Values of the descriptors; None where one does not exist."""
        if not self._settings.described:
            return genome[:2]
        known = tuple(value for value in outcome.descriptors if value is not None)
        return known if len(known) == len(self._settings.described) else None

    def _slope(self, outcome: Outcome) -> Array:
        """Gradient of the first objective; nan where it is not known, and zero along choices."""
        gradient = outcome.gradients[0] if outcome.gradients else None
        if gradient is None:
            return np.full(self._settings.dimension, np.nan)
        return np.array([0.0 if each is None else each for each in gradient])

    def children(self, count: int, generator: np.random.Generator) -> tuple[Genome, ...]:
        """So many children, none of them known while others can be found; none without two elites."""
        found: list[Genome] = []
        points, qualities, slopes = self._elites()
        if len(points) < 2:
            return ()
        while len(found) < count:
            for _ in range(TRIES):
                genome = self._child(points, qualities, slopes, generator)
                if genome not in self._genomes and genome not in found:
                    break
            else:
                anywhere = generator.random((1, self._settings.dimension))
                genome = tuple(snapped(anywhere, self._settings.counts)[0].tolist())
            found.append(genome)
        return tuple(found)

    def _elites(self) -> tuple[Array, Array, Array]:
        """Points, qualities (more is better) and gradients, in the order of cells."""
        if self._parents is None:
            if self._archive is not None:
                data = self._archive.data(["solution", "objective", "slope", "index"])
                order = np.argsort(data["index"])
                self._parents = (data["solution"][order], data["objective"][order], data["slope"][order])
            else:
                told = [(genome, 0.0) for genome, _ in self._first]
                told += [(genome, -missed) for missed, _, genome in self._missed if np.isfinite(missed)]
                self._parents = (
                    np.array([genome for genome, _ in told]).reshape(-1, self._settings.dimension),
                    np.array([quality for _, quality in told]),
                    np.full((len(told), self._settings.dimension), np.nan),
                )
        return self._parents

    def _child(
        self, points: Array, qualities: Array, slopes: Array, generator: np.random.Generator
    ) -> Genome:
        exploited = generator.random() < self._exploited
        best = np.argsort(-qualities, kind="stable")[: max(2, len(points) // BEST)]
        first, second = generator.choice(best if exploited else len(points), size=2)
        dimension, counts = self._settings.dimension, self._settings.counts
        iso = generator.choice(FINE if exploited else COARSE) * generator.standard_normal(dimension)
        line = (NEAR if exploited else FAR) * generator.standard_normal()
        downhill, step = generator.random() < DOWNHILL, generator.choice(STEPS)
        either, anew = generator.random(dimension) < 0.5, generator.random(dimension)
        changed = generator.random(dimension) < 1.0 / dimension
        steepest = np.linalg.norm(slopes[first])
        if downhill and steepest > 0.0:
            point = points[first] - step * slopes[first] / steepest
        else:
            point = points[first] + iso + line * (points[second] - points[first])
        choice = np.where(changed, anew, np.where(either, points[first], points[second]))
        inside = np.clip(np.where(np.array(counts) > 0, choice, point), 0.0, 1.0)
        return tuple(snapped(inside[None], counts)[0].tolist())


def _bounds(descriptor: Descriptor, low: float, high: float) -> tuple[float, float]:
    """Those given, the others such that they hold the designs known."""
    lower, upper = descriptor.lower, descriptor.upper
    if lower is None:
        return (low if upper is None else min(low, upper - (high - low)), high if upper is None else upper)
    return lower, max(high, lower + (high - low)) if upper is None else upper


class MapElites:
    """MAP-Elites in the unit cube.

    Args:
        settings: dimension, objectives, population, seed, start genomes and descriptors.
    """

    def __init__(self, settings: SearchSettings) -> None:
        (seed,) = np.random.SeedSequence(settings.seed).spawn(1)
        self._settings = settings
        self._stream = SobolStream(settings.counts, seed)
        self._elites = _Elites(settings)
        self._generation = 0
        self._asked = first_generation(settings, self._stream)

    def ask(self) -> tuple[Genome, ...]:
        """The next children; the same ones until their outcomes are told."""
        return self._asked

    def tell(self, outcomes: Sequence[Outcome]) -> None:
        """Keep the elites.

        Raises:
            ValueError: outcomes that do not fit the genomes asked.
        """
        check_outcomes(self._asked, outcomes, self._settings.objectives)
        for genome, outcome in zip(self._asked, outcomes, strict=True):
            self._elites.add(genome, outcome)
        self._generation += 1
        generator = generator_of(self._settings.seed, self._generation)
        population = self._settings.population
        self._asked = self._elites.children(population, generator) or self._stream.take(population)


class AsynchronousMapElites:
    """The same, one genome at a time.

    Args:
        settings: dimension, objectives, population, seed, start genomes and descriptors.
    """

    def __init__(self, settings: SearchSettings) -> None:
        (seed,) = np.random.SeedSequence(settings.seed).spawn(1)
        self._settings = settings
        self._beginning = Beginning(settings, seed)
        self._elites = _Elites(settings)
        self._asked: dict[int, Genome] = {}

    def ask(self, turn: int) -> Genome:
        """A child of elites; at first a start genome or a quasi-random point."""
        found: tuple[Genome, ...] = ()
        if turn >= self._settings.population:
            found = self._elites.children(1, generator_of(self._settings.seed, turn))
        (genome,) = found or (self._beginning.genome(turn),)
        self._asked[turn] = genome
        return genome

    def tell(self, turn: int, outcome: Outcome) -> None:
        """Keep the elites."""
        self._elites.add(self._asked.pop(turn), outcome)
