"""The spread over samples of people, on designs whose results are written by hand."""

from __future__ import annotations

import msgspec
import numpy as np
import pytest

from evodesign.analysis.people_spread import (
    all_spreads_json,
    people_spread,
    spread_among,
    spread_json,
    spread_sentence,
)
from evodesign.records import Assessment, Constraint, Objective, SampledDesign, Sense, Status

OBJECTIVES = (
    Objective(name="human_torque", sense=Sense.MINIMISE, unit="N m"),
    Objective(name="reach_height", sense=Sense.MAXIMISE, unit="m"),
)
BOUND = (Constraint(name="back_compression", unit="N", lower=None, upper=3400.0),)

REACH = {0: 1.0, 3: 1.2, 5: 1.2, 8: 1.2, 9: 1.4}
TORQUE = {
    0: [140.0, 150.0, 130.0, 144.0],
    3: [100.0, 120.0, 110.0, 118.0],
    5: [101.0, 119.0, 111.0, 119.0],
    8: [102.0, 121.0, 109.0, 117.0],
    9: [130.0, 140.0, 120.0, 134.0],
}
"""By design: 3, 5 and 8 reach alike, and each has the lowest torque beside some of the people."""


def sampled(design: int, sample: int, torque: float | None, violation: float = 0.0) -> SampledDesign:
    found = {} if torque is None else {"human_torque": torque}
    assessment = Assessment(
        design={"length.shank": 1.0 + design},
        objectives={**found, "reach_height": REACH[design]},
        violation=violation,
        status=Status.SOLVED,
        reason="solved",
        constraints={"back_compression": 3000.0 + sample},
    )
    return SampledDesign(sample=sample, design=design, assessment=assessment, seconds=0.1)


EVERYONE = [
    sampled(design, sample, torque)
    for design, torques in TORQUE.items()
    for sample, torque in enumerate(torques, 1)
]


def test_a_front_on_which_three_designs_swap_is_shown_as_such() -> None:
    found = people_spread(OBJECTIVES, BOUND, EVERYONE, 0)
    assert {number: each.on_front for number, each in found.designs.items()} == {0: 0, 3: 1, 5: 1, 8: 2, 9: 4}
    assert spread_sentence(found) == (
        "over 4 samples of people: 1 of 5 designs are on the front in all, "
        "3 in some (design 3 in 1, 5 in 1, 8 in 2), 1 in none"
    )


def test_means_deviations_and_paired_differences_are_those_of_numpy() -> None:
    found = people_spread(OBJECTIVES, BOUND, EVERYONE, 0)
    for number, torques in TORQUE.items():
        own = found.designs[number].quantities["human_torque"]
        assert own.values is not None
        assert own.values.mean == pytest.approx(np.mean(torques))
        assert own.values.deviation == pytest.approx(np.std(torques, ddof=1))
        if number == 0:
            assert own.difference is None
            continue
        less = np.subtract(torques, TORQUE[0])
        assert own.difference is not None
        assert own.difference.mean == pytest.approx(np.mean(less))
        assert own.difference.deviation == pytest.approx(np.std(less, ddof=1))
        assert own.better == int((less < 0.0).sum())
    reach = found.designs[9].quantities["reach_height"]
    assert reach.values is not None
    assert (reach.values.spreads, reach.better) == (False, 4)
    back = found.designs[9].quantities["back_compression"]
    assert back.better is None, "no less is better than another value within the bounds"


def test_designs_that_fail_beside_some_people_are_on_no_front_there() -> None:
    others = [each for each in EVERYONE if each.design != 9]
    lost = [sampled(9, 1, 130.0, violation=0.2), sampled(9, 2, None), sampled(9, 3, 1.0), sampled(9, 4, 1.0)]
    own = people_spread(OBJECTIVES, BOUND, [*others, *lost], 0).designs[9]
    assert (own.samples, own.feasible, own.on_front) == (4, 3, 2)
    torque = own.quantities["human_torque"]
    assert torque.values is not None
    assert torque.values.count == 3


def test_a_sample_counts_for_fronts_once_all_designs_have_met_it() -> None:
    found = people_spread(OBJECTIVES, BOUND, EVERYONE[:-1], 0)
    assert found.samples == 3
    assert {number: each.on_front for number, each in found.designs.items()} == {0: 0, 3: 1, 5: 1, 8: 1, 9: 3}
    none = people_spread(OBJECTIVES, BOUND, [sampled(3, 1, 1.0), sampled(5, 2, 1.0)], None)
    assert spread_sentence(none) == "no sample of people has all designs yet"


def test_a_gain_that_a_solver_leaves_open_is_none() -> None:
    alike = [sampled(3, 1, 100.0), sampled(5, 1, 100.0 - 1e-8), sampled(8, 1, 99.0)]
    found = people_spread(OBJECTIVES, (), alike, 3).designs
    assert [found[number].quantities["human_torque"].better for number in (5, 8)] == [0, 1]


def test_json_has_what_the_table_shows() -> None:
    found = people_spread(OBJECTIVES, BOUND, EVERYONE, 0)
    told = msgspec.json.decode(msgspec.json.encode(all_spreads_json(found)))
    assert (told["samples"], told["reference"]) == (4, 0)
    assert [each["id"] for each in told["designs"]] == [0, 3, 5, 8, 9]
    own = spread_json(found, 3)
    assert (own["on_front"], own["feasible"], own["samples"]) == (1, 4, 4)
    assert own["quantities"]["human_torque"]["difference"]["better"] == 4
    assert own["quantities"]["human_torque"]["mean"] == pytest.approx(112.0)
    few = spread_among(found, [3, 77])
    assert few is not None
    assert [*few.designs] == [3]
    assert spread_among(found, [77]) is None
