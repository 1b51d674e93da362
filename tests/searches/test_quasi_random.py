import numpy as np
from scipy.stats import qmc

from evodesign.records import SearchSettings
from evodesign.searches.base import Outcome
from evodesign.searches.quasi_random import QuasiRandom, SobolPoints, SobolStream


def test_the_stream_does_not_depend_on_how_it_is_taken():
    whole = SobolStream((0,) * 3, np.random.SeedSequence(5)).take(300)
    stream = SobolStream((0,) * 3, np.random.SeedSequence(5))
    assert stream.take(1) + stream.take(0) + stream.take(130) + stream.take(169) == whole


def test_the_stream_is_the_sobol_sequence_of_its_seed():
    engine = qmc.Sobol(4, scramble=True, rng=np.random.default_rng(np.random.SeedSequence(5)))
    expected = [tuple(row) for row in engine.random(256).tolist()]
    assert list(SobolStream((0,) * 4, np.random.SeedSequence(5)).take(256)) == expected


def test_every_dyadic_interval_of_every_coordinate_holds_one_point():
    points = np.array(SobolStream((0,) * 16, np.random.SeedSequence(8)).take(64))
    cells = np.sort(np.floor(points * 64).astype(int), axis=0)
    assert (cells == np.arange(64)[:, None]).all()


def test_sampling_goes_on_where_the_first_generation_ended():
    settings = SearchSettings(
        algorithm="random", dimension=2, objectives=1, population=10, seed=3, start=((0.5, 0.5),)
    )
    search = QuasiRandom(settings)
    asked = []
    for _ in range(4):
        asked += search.ask()
        search.tell([Outcome(None, None)] * 10)
    (seed,) = np.random.SeedSequence(3).spawn(1)
    assert asked == [(0.5, 0.5), *SobolStream((0,) * 2, seed).take(39)]


def test_points_by_number_are_those_of_the_stream_in_any_order():
    stream = SobolStream((0,) * 5, np.random.SeedSequence(7)).take(300)
    points = SobolPoints((0,) * 5, np.random.SeedSequence(7))
    for number in (299, 0, 64, 63, 128, 1, 250, 64):
        assert points.point(number) == stream[number]
