"""Points spread over a cube, against those of scipy."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import qmc

from evodesign.design.spread import spread_designs, spread_points


@pytest.mark.parametrize(("dimension", "count"), [(1, 1), (3, 40), (17, 200), (40, 16)])
def test_points_are_those_of_scipy(dimension: int, count: int) -> None:
    wanted = qmc.Halton(dimension, scramble=True, rng=np.random.default_rng(0)).random(count)
    np.testing.assert_array_equal(spread_points(dimension, count), wanted)


def test_designs_that_are_not_to_be_kept_count_among_those_looked_at() -> None:
    every = [*spread_designs(2, lambda point: point, lambda _: True, 30)]
    kept = [*spread_designs(2, lambda point: point, lambda design: design[0] < 0.5, 30)]
    assert kept == [design for design in every if design[0] < 0.5]
    assert 10 <= len(kept) <= 20
