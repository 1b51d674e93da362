"""A small evolution on the model, where a design costs microseconds.

A generation of pymoo's takes milliseconds. Children mix two parents by simulated binary crossover, or
follow a difference of two members; some coordinates get a normal step. Choices come from either parent, and
some are drawn anew. The fittest survive: feasible ones first, by rank of domination, then by crowding
distance. Objectives are scaled so that the ideal lies at 0 and the reference point at 1; what lies beyond
the reference is made worse by five times as much again.

Source: Deb, Pratap, Agarwal and Meyarivan, A fast and elitist multiobjective genetic algorithm, 2002; Storn
and Price, Differential evolution, 1997.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import moocore
import numpy as np
from numpy.typing import NDArray

from evodesign.searches.discrete import snapped

Array = NDArray[np.float64]

MEMBERS = 100
CROSSOVER_INDEX = 15.0
DIFFERENTIAL_SHARE, DIFFERENTIAL_COORDINATES, DIFFERENTIAL_STEP = 0.33, 0.7, 0.5
MUTATED = 1.5
"""Coordinates of a child that are changed, on average."""

STEPS = (0.02, 0.1, 0.3)
BEYOND = 5.0
"""By how much worse what lies beyond the reference counts."""

Judged = Callable[[Array], tuple[Array, Array]]
"""From points to scaled objectives [points x objectives] and infeasibility [points]."""


@dataclass(frozen=True, slots=True)
class Members:
    """Points with what the model says of them.

    Args:
        points: [points x dimension].
        objectives: scaled [points x objectives].
        infeasibility: zero where they are expected to be feasible.
    """

    points: Array
    objectives: Array
    infeasibility: Array

    def part(self, which: NDArray[np.intp]) -> Members:
        """Some of them."""
        return Members(self.points[which], self.objectives[which], self.infeasibility[which])


def evolved(
    judged: Judged,
    start: Array,
    generations: int,
    counts: Sequence[int],
    generator: np.random.Generator,
) -> Members:
    """The last population of so many generations that begin at points."""
    members = Members(start, *judged(start))
    for _ in range(generations):
        children = _children(members.points, counts, generator)
        objectives, infeasibility = judged(children)
        members = _fittest(
            Members(
                np.vstack([members.points, children]),
                np.vstack([members.objectives, objectives]),
                np.concatenate([members.infeasibility, infeasibility]),
            )
        )
    return members


def _children(parents: Array, counts: Sequence[int], generator: np.random.Generator) -> Array:
    size, dimension = (MEMBERS, parents.shape[1])
    first, second, third = parents[generator.integers(len(parents), size=(3, size))]
    draws = generator.random((size, dimension))
    power = 1.0 / (CROSSOVER_INDEX + 1.0)
    spread = np.where(draws < 0.5, (2.0 * draws) ** power, (2.0 - 2.0 * draws) ** -power)
    crossed = generator.random((size, dimension)) < 0.5
    mixed = np.where(crossed, 0.5 * ((1.0 + spread) * first + (1.0 - spread) * second), first)
    moving = generator.random((size, dimension)) < DIFFERENTIAL_COORDINATES
    differential = generator.random((size, 1)) < DIFFERENTIAL_SHARE
    children = np.where(differential, first + DIFFERENTIAL_STEP * (second - third) * moving, mixed)
    discrete = np.array(counts) > 0
    children[:, discrete] = np.where(crossed, second, first)[:, discrete]
    mutated = generator.random((size, dimension)) < MUTATED / dimension
    steps = generator.standard_normal((size, dimension)) * generator.choice(STEPS, size=(size, 1))
    anew = generator.random((size, dimension))
    children = np.where(mutated, np.where(discrete, anew, children + steps), children)
    return snapped(np.clip(children, 0.0, 1.0), counts)


def _fittest(members: Members) -> Members:
    """As many as there may be; feasible ones first."""
    beyond = np.maximum(members.objectives - 1.0, 0.0).sum(axis=1, keepdims=True)
    objectives = members.objectives + BEYOND * beyond
    feasible = np.flatnonzero(members.infeasibility == 0.0)
    others = np.flatnonzero(members.infeasibility > 0.0)
    kept: list[NDArray[np.intp]] = []
    room = MEMBERS
    if len(feasible):
        ranks = np.asarray(moocore.pareto_rank(objectives[feasible]))
        for rank in range(int(ranks.max()) + 1):
            front = feasible[ranks == rank]
            if len(front) > room:
                front = front[np.argsort(-_crowding(objectives[front]), kind="stable")[:room]]
            kept.append(front)
            room -= len(front)
            if room == 0:
                break
    kept.append(others[np.argsort(members.infeasibility[others], kind="stable")[:room]])
    return members.part(np.concatenate(kept))


def _crowding(objectives: Array) -> Array:
    distance = np.zeros(len(objectives))
    for column in objectives.T:
        order = np.argsort(column, kind="stable")
        extent = column[order[-1]] - column[order[0]] or 1.0
        distance[order[[0, -1]]] = np.inf
        distance[order[1:-1]] += (column[order[2:]] - column[order[:-2]]) / extent
    return distance
