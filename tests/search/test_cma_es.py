import itertools
import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from evodesign.errors import InputError
from evodesign.records import SearchSettings
from evodesign.search.base import Outcome
from evodesign.search.cma_es import CENTRING, CmaEs, chebyshev, default_population, simplex_weights

FAILED = Outcome(None, None)


def search(objectives=1, dimension=6, population=12, seed=2, start=()):
    return CmaEs(
        SearchSettings(
            algorithm="cma-es",
            dimension=dimension,
            objectives=objectives,
            population=population,
            seed=seed,
            start=start,
        )
    )


def best_values(cma_es, function, generations):
    """Least value of each generation."""
    least = []
    for _ in range(generations):
        values = [function(np.array(genome)) for genome in cma_es.ask()]
        least.append(min(values))
        cma_es.tell([Outcome((value,), 0.0) for value in values])
    return least


def sphere(x):
    return float(np.sum((x - 0.3) ** 2))


def ellipsoid(x):
    """Condition 1e4, turned against the axes by a reflection."""
    normal = np.arange(1.0, len(x) + 1.0)
    z = x - 0.4 - 2.0 * normal * (normal @ (x - 0.4)) / (normal @ normal)
    return float(np.sum(10.0 ** (4.0 * np.arange(len(x)) / (len(x) - 1)) * z**2))


def corner(x):
    return float(np.sum(x) + np.sum(x[::2]))


@pytest.mark.parametrize(
    ("function", "generations", "reached"), [(sphere, 120, 1e-9), (ellipsoid, 300, 1e-9), (corner, 120, 1e-6)]
)
def test_converges_on_one_objective(function, generations, reached):
    least = best_values(search(), function, generations)
    assert min(least) < reached < 1e-3 < least[0]


def test_learns_ranks_only():
    """Any increasing function of the objective leads to the same genomes."""
    plain, bent = search(), search()
    for _ in range(15):
        genomes = plain.ask()
        assert bent.ask() == genomes
        values = [sphere(np.array(genome)) for genome in genomes]
        plain.tell([Outcome((value,), 0.0) for value in values])
        bent.tell([Outcome((math.expm1(5.0 * value) - 3.0,), 0.0) for value in values])


def test_units_of_the_objectives_do_not_matter():
    newton, millinewton = search(objectives=2, population=24), search(objectives=2, population=24)
    for _ in range(10):
        genomes = newton.ask()
        assert millinewton.ask() == genomes
        values = [(sphere(np.array(genome)), ellipsoid(np.array(genome))) for genome in genomes]
        newton.tell([Outcome(pair, 0.0) for pair in values])
        millinewton.tell([Outcome((1024.0 * a, b / 4096.0), 0.0) for a, b in values])


def test_a_good_start_genome_draws_the_first_samples_near():
    start = ((0.9,) * 6,)
    outcome = [Outcome((0.0,), 0.0), *[Outcome((100.0,), 0.0)] * 11]
    near, far = search(start=start), search(start=start)
    near.tell(outcome)
    far.tell(outcome[::-1])
    near_by, far_off = (float(np.mean(np.abs(np.array(s.ask()) - 0.9))) for s in (near, far))
    assert near_by < 0.75 * far_off


def test_an_instance_that_converged_starts_again_elsewhere():
    cma_es = search(dimension=2, population=8)
    spreads = []
    for _ in range(250):
        genomes = np.array(cma_es.ask())
        spreads.append(float(np.mean(np.std(genomes, axis=0))))
        cma_es.tell([Outcome((sphere(genome),), 0.0) for genome in genomes])
    narrowest = int(np.argmin(spreads))
    assert spreads[narrowest] < 1e-6
    assert max(spreads[narrowest:]) > 0.05


def test_flat_generations_are_left_behind():
    """Where all fails there is nothing to learn: the samples move on to other places."""
    cma_es = search(dimension=4)
    centres = []
    for _ in range(12):
        centres.append(np.mean(cma_es.ask(), axis=0))
        cma_es.tell([FAILED] * 12)
    assert max(float(np.linalg.norm(a - b)) for a, b in itertools.pairwise(centres)) > 0.3


def test_start_genomes_on_the_border_are_used():
    start = ((0.0,) * 6, (1.0,) * 6, (0.0, 1.0) * 3)
    assert min(best_values(search(start=start), corner, 60)) < 1e-3


def test_every_instance_finds_the_trade_off_of_its_own_weights():
    """Between bowls around a and b the trade-offs are the points of the straight line from a to b."""
    a, b = np.full(4, 0.2), np.full(4, 0.8)
    cma_es = search(objectives=2, dimension=4, population=32)
    for _ in range(40):
        points = [np.array(genome) for genome in cma_es.ask()]
        cma_es.tell(
            [Outcome((float(np.sum((x - a) ** 2)), float(np.sum((x - b) ** 2))), 0.0) for x in points]
        )
    centres = np.array([np.mean(samples, axis=0) for samples in cma_es._samples])
    places = centres.mean(axis=1)
    assert len(centres) == 4
    np.testing.assert_allclose(centres, np.tile(places[:, None], 4), atol=0.02)
    first_weights = [weights[0] for weights in cma_es._weights]
    assert list(np.argsort(places)) == list(np.argsort(first_weights)[::-1])
    assert np.diff(np.sort(places)).min() > 0.05


def test_instances_share_the_population():
    cma_es = search(objectives=3, dimension=16, population=50)
    cma_es.tell([FAILED] * 50)
    assert [len(samples) for samples in cma_es._samples] == [13, 13, 12, 12]


def test_writes_and_reads_no_files(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("cma_signals.in").write_text("{'timeout': 0, 'tolx': 1e9}")
    with_signals = best_values(search(), sphere, 12)
    assert [path.name for path in Path().iterdir()] == ["cma_signals.in"]
    Path("cma_signals.in").unlink()
    assert best_values(search(), sphere, 12) == with_signals


def test_says_nothing(capfd):
    best_values(search(dimension=1, population=4), sphere, 40)
    assert capfd.readouterr() == ("", "")


def test_refuses_a_population_too_small_to_adapt():
    with pytest.raises(InputError, match="population: wanted at least 3 for cma-es, found 2"):
        search(population=2)


@pytest.mark.parametrize(("dimension", "population"), [(1, 4), (2, 6), (10, 10), (16, 12), (30, 14)])
def test_default_population_is_that_of_the_tutorial(dimension, population):
    assert default_population(dimension) == population


@pytest.mark.parametrize(
    ("objectives", "count", "found"),
    [
        *[(1, 9, 1), (2, 1, 1), (2, 2, 2), (2, 4, 4), (2, 7, 7), (3, 2, 1), (3, 3, 3), (3, 4, 4)],
        *[(3, 6, 6), (3, 9, 7), (3, 10, 10), (4, 4, 4), (4, 5, 5), (4, 12, 11)],
    ],
)
def test_there_are_as_many_weights_as_lattice_and_centre_allow(objectives, count, found):
    weights = simplex_weights(objectives, count)
    assert len(weights) == found
    assert len({tuple(np.round(vector, 9)) for vector in weights}) == found


@given(st.integers(1, 5), st.integers(1, 40))
def test_weights_are_positive_sum_to_one_and_favour_no_objective(objectives, count):
    weights = np.array(simplex_weights(objectives, count))
    assert 1 <= len(weights) <= count
    assert (weights > 0.0).all()
    np.testing.assert_allclose(weights.sum(axis=1), 1.0, rtol=1e-12)
    np.testing.assert_allclose(weights.mean(axis=0), 1.0 / objectives, rtol=1e-12)


def test_weights_are_the_lattice_counted_out_by_hand():
    lattice = [w for w in itertools.product(range(4), repeat=3) if sum(w) == 3]
    expected = {tuple(round((1 - CENTRING) * i / 3 + CENTRING / 3, 9) for i in w) for w in lattice}
    assert {tuple(np.round(w, 9)) for w in simplex_weights(3, 10)} == expected


def test_chebyshev_of_an_example_worked_by_hand():
    """z = (0.25, 0.5): max(0.8 * 0.25, 0.2 * 0.5) + 0.05 * 0.75 = 0.2375."""
    cost = chebyshev(np.array([0.8, 0.2]), np.array([[1.0, 20.0], [3.0, 15.0], [5.0, 10.0]]))
    assert cost((2.0, 15.0)) == pytest.approx(0.2375, rel=1e-12)


def test_chebyshev_without_a_range_keeps_the_unit():
    assert chebyshev(np.array([1.0]), np.array([[7.0]]))((9.0,)) == pytest.approx(2.1, rel=1e-12)
    assert chebyshev(np.array([1.0]), np.empty((0, 1)))((9.0,)) == pytest.approx(9.45, rel=1e-12)


points = st.lists(st.tuples(*[st.integers(-8, 8).map(float)] * 3), min_size=1, max_size=6)


@given(points, st.tuples(*[st.integers(-8, 8).map(float)] * 3), st.tuples(*[st.integers(0, 3)] * 3))
def test_a_dominated_point_costs_more(front, better, losses):
    worse = tuple(value + loss for value, loss in zip(better, losses, strict=True))
    for weights in simplex_weights(3, 6):
        cost = chebyshev(weights, np.array(front))
        assert (cost(worse) > cost(better)) == (worse != better)
