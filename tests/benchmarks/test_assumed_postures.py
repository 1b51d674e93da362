"""What the benchmark of assumed postures moves, and nothing else."""

from __future__ import annotations

import math

import numpy as np
import pytest

from benchmarks.assumed_postures import directed, dominated, variants, with_knot
from evodesign.human.measured_posture import FEATURES, MEAN_PERSON, measured_posture, unmeasured_heights

GIVEN = measured_posture(1.7).hold
MIDDLE = sum(unmeasured_heights()) / 2.0


@pytest.mark.parametrize("eta", [0.1, 0.4, 0.437, 0.47, MIDDLE, 0.52, 0.54, 0.7, 1.1])
def test_a_knot_between_others_changes_nothing(eta: float) -> None:
    assert with_knot(GIVEN, MIDDLE).mean(eta) == pytest.approx(GIVEN.mean(eta))


def test_people_are_upright_or_stooped_in_the_middle() -> None:
    low, high = unmeasured_heights()
    places = [GIVEN.knots.index(eta) for eta in (low, high)]
    for like, eta in zip(places, (low, high), strict=True):
        assert with_knot(GIVEN, MIDDLE, like).mean(MIDDLE) == pytest.approx(GIVEN.mean(eta))


def test_a_direction_moves_one_feature_at_one_height() -> None:
    moved = directed(with_knot(GIVEN, MIDDLE), {MIDDLE: {"arm": 0.2}})
    arm = tuple(1.0 if name == "arm" else 0.0 for name in FEATURES)
    for eta, much in ((0.437, 0.0), (MIDDLE, 1.0), ((MIDDLE + 0.54) / 2.0, 0.5), (0.54, 0.0), (0.9, 0.0)):
        before, after = GIVEN.mean(eta), moved.mean(eta, arm)
        for name in FEATURES:
            step = 0.2 * much if name == "arm" else 0.0
            assert after[name] - before[name] == pytest.approx(step, abs=1e-12)


def test_each_variant_moves_the_mean_by_a_deviation() -> None:
    """Of rows between 0.44 and 0.54 of stature by the mean of both rows' deviations."""
    found = variants(GIVEN)
    assert [each.drawn for each in found if not each.group] == [MEAN_PERSON]
    knee = next(each for each in found if (each.group, each.name) == ("between rows", "knee +1 s"))
    change = knee.given.mean(MIDDLE, knee.drawn)["knee"] - GIVEN.mean(MIDDLE)["knee"]
    assert math.degrees(change) == pytest.approx((7.33 + 6.0) / 2.0, abs=1e-6)
    women = [each for each in found if each.women]
    assert len(women) == 8
    for each in women:
        name = each.name.split()[0]
        change = each.given.mean(0.61, each.drawn)[name] - GIVEN.mean(0.61)[name]
        assert abs(math.degrees(change)) == pytest.approx({"shank": 4.0}.get(name, 6.0), abs=1e-6)


def test_dominated_rows() -> None:
    rows = np.array([[1.0, 2.0], [2.0, 1.0], [2.0, 2.0], [1.0, 2.0]])
    assert dominated(rows) == [False, False, True, False]
