from __future__ import annotations

import msgspec
import pytest

from evodesign.errors import InputError
from evodesign.records import Genome, SearchSettings, SearchStage
from evodesign.searches.base import Outcome, Search
from evodesign.searches.registry import SEARCHES, make_search
from evodesign.searches.restarted import fittest


def settings(
    algorithm: str, seed: int, past: tuple[SearchStage, ...] = (), population: int = 8
) -> SearchSettings:
    return SearchSettings(
        algorithm=algorithm, dimension=3, objectives=2, population=population, seed=seed, past=past
    )


def stage(generations: int, algorithm: str = "nsga2", seed: int = 1) -> SearchStage:
    return SearchStage(algorithm=algorithm, population=8, seed=seed, generations=generations)


def outcome(genome: Genome) -> Outcome:
    first, second, third = genome
    violation = max(0.0, 0.2 - third)
    return Outcome((first + second**2, 1.0 - first + third) if violation == 0.0 else None, violation)


def run(search: Search, generations: int) -> list[tuple[Genome, ...]]:
    asked = []
    for _ in range(generations):
        asked.append(search.ask())
        search.tell([outcome(genome) for genome in asked[-1]])
    return asked


@pytest.mark.parametrize("algorithm", SEARCHES)
def test_a_branch_goes_the_old_way_and_then_its_own(algorithm: str) -> None:
    old = run(make_search(settings("nsga2", seed=1)), 6)
    new = run(make_search(settings(algorithm, seed=2, past=(stage(3),))), 6)
    assert new[:3] == old[:3]
    assert new[3] != old[3]
    known = {genome for genomes in new[:3] for genome in genomes}
    assert not known & set(new[3]), "the past is told to the new search, not asked for again"


@pytest.mark.parametrize("algorithm", SEARCHES)
def test_a_branch_is_rebuilt_by_asking_and_telling_again(algorithm: str) -> None:
    past = (stage(2), stage(2, "random", seed=5))
    first = run(make_search(settings(algorithm, seed=7, past=past)), 7)
    assert run(make_search(settings(algorithm, seed=7, past=past)), 7) == first


def test_a_branch_of_nsga2_mates_what_survived_the_past() -> None:
    """With neither crossover nor mutation at a distance, children lie near the fittest of the past."""
    search = make_search(settings("nsga2", seed=2, past=(stage(10),)))
    asked = run(search, 11)
    told = {genome: outcome(genome) for genomes in asked[:10] for genome in genomes}
    parents = fittest(told, 8, 2)
    inherited = sum(
        any(abs(child[axis] - parent[axis]) < 1e-12 for parent in parents)
        for child in asked[10]
        for axis in range(3)
    )
    assert inherited > 4, "crossover leaves many coordinates as they were"


def test_the_fittest_are_feasible_first_then_nondominated() -> None:
    known = {
        (0.1, 0.1, 0.0): Outcome(None, 0.5),
        (0.2, 0.1, 0.0): Outcome((1.0, 2.0), 0.0),
        (0.3, 0.1, 0.0): Outcome((2.0, 3.0), 0.0),
        (0.4, 0.1, 0.0): Outcome((2.0, 1.0), 0.0),
        (0.5, 0.1, 0.0): Outcome(None, None),
    }
    assert set(fittest(known, 2, 2)) == {(0.2, 0.1, 0.0), (0.4, 0.1, 0.0)}
    assert set(fittest(known, 3, 2)) == {(0.2, 0.1, 0.0), (0.4, 0.1, 0.0), (0.3, 0.1, 0.0)}
    assert (0.5, 0.1, 0.0) not in fittest(known, 4, 2)


def test_a_past_that_cannot_be_is_refused() -> None:
    with pytest.raises(InputError, match=r"past\[0\]\.generations: wanted at least 1"):
        make_search(settings("nsga2", seed=1, past=(stage(0),)))
    with pytest.raises(InputError, match="population: wanted at most 16"):
        make_search(settings("nsga2", seed=1, past=(stage(2),), population=17))
    with pytest.raises(InputError, match="algorithm"):
        make_search(msgspec.structs.replace(settings("nsga2", seed=1), past=(stage(1, algorithm="simplex"),)))
