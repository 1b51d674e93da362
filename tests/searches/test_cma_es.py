import itertools
import math
from pathlib import Path

import moocore
import numpy as np
import pytest
from scipy.optimize import minimize

from evodesign.errors import InputError
from evodesign.records import SearchSettings
from evodesign.searches.base import Outcome
from evodesign.searches.cma_es import CmaEs
from evodesign.searches.cma_instances import MARGIN, default_population, improvement_cost

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


def two_bowls(x):
    """Between bowls around (0.2, ...) and (0.8, ...) the trade-offs are the points of the line between."""
    return (float(np.sum((x - 0.2) ** 2)), float(np.sum((x - 0.8) ** 2)))


def test_instances_spread_over_the_trade_offs_as_the_hypervolume_asks():
    """The four incumbents dominate as much as four points of the line can, found by another optimiser."""
    cma_es = search(objectives=2, dimension=4, population=32)
    for _ in range(60):
        cma_es.tell([Outcome(two_bowls(np.array(genome)), 0.0) for genome in cma_es.ask()])
    best, worst = cma_es._instances._extent
    reference = worst + MARGIN * (worst - best)

    def dominated_by(places):
        line = sorted(two_bowls(np.full(4, place)) for place in places)
        heights = [reference[1], *(values[1] for values in line)]
        return sum(
            max(reference[0] - left, 0.0) * max(above - below, 0.0)
            for (left, below), above in zip(line, heights, strict=False)
        )

    most = -minimize(lambda places: -dominated_by(places), [0.3, 0.45, 0.55, 0.7], method="Nelder-Mead").fun
    found = moocore.hypervolume(np.array(cma_es._instances._incumbents), ref=reference)
    assert len(cma_es._instances._incumbents) == 4
    assert 0.995 * most < found < 1.0001 * most


def test_instances_begin_where_they_dominate_most_together():
    """Of outcomes crowded at (1, 1) one is taken, then the ends; a violated one when none is left."""
    told = [Outcome((1.0 + 0.001 * i, 1.0 + 0.001 * i), 0.0) for i in range(29)]
    told += [Outcome((0.0, 3.0), 0.0), Outcome((3.0, 0.0), 0.0), Outcome(None, 0.1)]
    cma_es = search(objectives=2, dimension=4, population=32)
    cma_es.tell(told)
    assert cma_es._instances._incumbents[:3] == [(1.0, 1.0), (0.0, 3.0), (3.0, 0.0)]
    lonely = search(objectives=2, dimension=4, population=32)
    lonely.tell([*[FAILED] * 30, Outcome((1.0, 2.0), 0.0), Outcome(None, 0.1)])
    assert lonely._instances._incumbents == [(1.0, 2.0), None, None, None]


def test_a_converged_instance_leaves_its_point_to_the_others_and_looks_elsewhere():
    cma_es = search(objectives=2, dimension=2, population=12)
    for _ in range(300):
        cma_es.tell([Outcome(two_bowls(np.array(genome)), 0.0) for genome in cma_es.ask()])
    held = np.array(
        [
            *cma_es._instances._left_behind,
            *(values for values in cma_es._instances._incumbents if values is not None),
        ]
    )
    assert len(cma_es._instances._left_behind) >= 3
    assert len(moocore.filter_dominated(held)) == len(held)
    assert np.diff(np.sort(held[:, 0])).min() > 0.02


@pytest.mark.parametrize(
    ("objectives", "population", "shares"),
    [(3, 50, [13, 13, 12, 12]), (2, 24, [12, 12]), (3, 13, [7, 6]), (3, 5, [5]), (1, 50, [50])],
)
def test_instances_share_the_population(objectives, population, shares):
    cma_es = search(objectives=objectives, dimension=16, population=population)
    cma_es.tell([FAILED] * population)
    assert [len(samples) for samples in cma_es._samples] == shares


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


def test_the_cost_is_the_gain_in_units_of_the_range():
    """Extent 4 and 10: others at (0.25, 0.5), reference 1.1; (0.5, 0.2) adds (1.1 - 0.5) (0.5 - 0.2)."""
    cost = improvement_cost(np.array([[2.0, 15.0]]), np.array([[1.0, 10.0], [5.0, 20.0]]))
    assert cost((3.0, 12.0)) == pytest.approx(-0.18, rel=1e-12)
    assert cost((4.0, 17.0)) == pytest.approx(0.2, rel=1e-12)


def test_the_cost_without_a_range_keeps_the_unit():
    """Reference 7 + 1.1 in the first objective, whose values all agree."""
    cost = improvement_cost(np.empty((0, 2)), np.array([[7.0, 0.0], [7.0, 2.0]]))
    assert cost((7.5, 1.0)) == pytest.approx(-0.6 * 0.6, rel=1e-12)
    assert improvement_cost(np.empty((0, 2)), np.empty((0, 2)))((7.5, 1.0)) == 0.0
