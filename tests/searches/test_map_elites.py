"""MAP-Elites: it fills kinds that other searches leave empty, and improves the best of each."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest

from evodesign.records import Descriptor, Genome, SearchSettings
from evodesign.searches.base import Outcome
from evodesign.searches.registry import make_search

DIMENSION, CELLS = 8, 10
GRID = (Descriptor("a", 0.0, 1.0, CELLS), Descriptor("b", 0.0, 1.0, CELLS))
Assess = Callable[[Genome], Outcome]


def settings(
    algorithm: str = "map-elites", seed: int = 1, grid: tuple[Descriptor, ...] = GRID
) -> SearchSettings:
    return SearchSettings(
        algorithm=algorithm, dimension=DIMENSION, objectives=1, population=20, seed=seed, descriptors=grid
    )


def kind(genome: Genome) -> tuple[float, float]:
    """Means of two halves: hardly ever near 0 or 1 by chance."""
    half = DIMENSION // 2
    return sum(genome[:half]) / half, sum(genome[half:]) / half


def bowl(genome: Genome) -> Outcome:
    """The spread within both halves: any kind may have none."""
    point = np.array(genome).reshape(2, -1)
    value = float(((point - point.mean(axis=1, keepdims=True)) ** 2).sum())
    return Outcome((value,), 0.0, descriptors=kind(genome))


def sloped(genome: Genome) -> Outcome:
    """The same with its gradient."""
    point = np.array(genome).reshape(2, -1)
    slope = 2.0 * (point - point.mean(axis=1, keepdims=True))
    found = bowl(genome)
    return Outcome(
        found.objectives, 0.0, gradients=(tuple(slope.ravel().tolist()),), descriptors=found.descriptors
    )


@cache
def best_of_kinds(
    algorithm: str, assess: Assess, generations: int = 40, seed: int = 1
) -> dict[tuple[int, int], float]:
    search = make_search(settings(algorithm, seed))
    found: dict[tuple[int, int], float] = {}
    for _ in range(generations):
        genomes = search.ask()
        outcomes = [assess(genome) for genome in genomes]
        for outcome in outcomes:
            if outcome.objectives is not None and None not in outcome.descriptors:
                a, b = (min(int((value or 0.0) * CELLS), CELLS - 1) for value in outcome.descriptors)
                found[a, b] = min(found.get((a, b), np.inf), outcome.objectives[0])
        search.tell(outcomes)
    return found


@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize("other", ["random", "cma-es", "nsga2"])
def test_it_fills_more_kinds_than_other_searches_and_has_better_ones(other: str, seed: int) -> None:
    mine = best_of_kinds("map-elites", bowl, seed=seed)
    theirs = best_of_kinds(other, bowl, seed=seed)
    assert len(mine) > 1.3 * len(theirs)
    score = [sum(2.0 - value for value in found.values()) for found in (mine, theirs)]
    assert score[0] > 1.3 * score[1]


def test_gradients_improve_the_best_of_kinds() -> None:
    plain = [best_of_kinds("map-elites", bowl, seed=seed) for seed in (1, 2, 3)]
    helped = [best_of_kinds("map-elites", sloped, seed=seed) for seed in (1, 2, 3)]
    means = [np.mean([np.mean(list(found.values())) for found in runs]) for runs in (plain, helped)]
    assert means[1] < 0.8 * means[0]


def test_a_design_without_a_descriptor_is_no_elite() -> None:
    """Those with a large first coordinate have none: they are the best by far, and never parents."""

    def half(genome: Genome) -> Outcome:
        if genome[0] > 0.5:
            return Outcome((-100.0,), 0.0, descriptors=(None, 0.5))
        return bowl(genome)

    search = make_search(settings())
    late: list[Genome] = []
    for generation in range(20):
        genomes = search.ask()
        late += genomes if generation > 10 else ()
        search.tell([half(genome) for genome in genomes])
    assert np.mean([genome[0] > 0.5 for genome in late]) < 0.3


@pytest.mark.parametrize(
    ("lower", "upper"), [(None, None), (0.4, None), (None, 0.45), (5.0, None), (None, -5.0)]
)
def test_bounds_that_are_not_given_are_found(lower: float | None, upper: float | None) -> None:
    search = make_search(settings(grid=(Descriptor("a", lower, upper, CELLS), GRID[1])))
    for _ in range(6):
        genomes = search.ask()
        search.tell([bowl(genome) for genome in genomes])
    assert len(set(search.ask())) == 20
