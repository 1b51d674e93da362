import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evodesign.analysis.aspiration import AUGMENTATION, aspiration_of, closest
from evodesign.analysis.front import front
from evodesign.errors import InputError
from tests.analysis.designs import REACH, TORQUE, design, designs_at, numbers

BOTH = (TORQUE, REACH)
whole = st.integers(0, 8).map(float)
points = st.lists(st.tuples(whole, whole), min_size=1, max_size=10)
CURVE = designs_at(BOTH, [(5.0, 1.0), (6.0, 1.4), (8.0, 1.7), (12.0, 1.8)])


def achievement(designs, hoped, one):
    """The achievement function, written out for torque (less is better) and reach (more is better)."""
    torques = [each.assessment.objectives["torque"] for each in designs]
    reaches = [each.assessment.objectives["reach"] for each in designs]
    torque_range = (max(torques) - min(torques)) or float("inf")
    reach_range = (max(reaches) - min(reaches)) or float("inf")
    torque, reach = one.assessment.objectives["torque"], one.assessment.objectives["reach"]
    shortfall = [0.0]
    if "torque" in hoped:
        shortfall.append((torque - hoped["torque"]) / torque_range)
    if "reach" in hoped:
        shortfall.append((hoped["reach"] - reach) / reach_range)
    total = (torque - min(torques)) / torque_range + (max(reaches) - reach) / reach_range
    return max(shortfall) + AUGMENTATION * total


@given(points, st.dictionaries(st.sampled_from(["torque", "reach"]), whole, min_size=1))
def test_designs_come_in_the_order_of_their_achievement(places, hoped):
    designs = designs_at(BOTH, places)
    found = [achievement(designs, hoped, one) for one in closest(BOTH, designs, hoped)]
    assert len(found) == len(designs)
    assert all(a <= b + 1e-12 for a, b in itertools.pairwise(found))


@given(points, st.dictionaries(st.sampled_from(["torque", "reach"]), whole, min_size=1))
def test_the_closest_design_is_beaten_by_none(places, hoped):
    designs = designs_at(BOTH, places)
    first = closest(BOTH, designs, hoped)[0].assessment.objectives
    assert first in [one.assessment.objectives for one in front(BOTH, designs)]


def test_a_hope_that_is_a_design_of_the_front_finds_that_design():
    for one in CURVE:
        assert closest(BOTH, CURVE, one.assessment.objectives)[0] is one


def test_what_nobody_names_counts_among_designs_that_are_good_enough():
    assert numbers(closest(BOTH, CURVE, {"reach": 1.5}))[:2] == [2, 3]
    assert numbers(closest(BOTH, CURVE, {"reach": 1.75}))[0] == 3
    assert numbers(closest(BOTH, CURVE, {"torque": 5.5}))[0] == 0


def test_a_hope_that_no_design_meets_is_missed_by_as_little_as_possible():
    assert numbers(closest(BOTH, CURVE, {"reach": 9.0}))[0] == 3
    assert numbers(closest(BOTH, CURVE, {"reach": 1.8, "torque": 5.0}))[0] == 2


def test_a_written_aspiration_is_read():
    assert aspiration_of(BOTH, "torque=8, reach = 1.5", "--near") == {"torque": 8.0, "reach": 1.5}


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("torqe=1", "wanted objectives among torque, reach, found 'torqe'; did you mean 'torque'"),
        ("torque", "wanted NAME=NUMBER"),
        ("torque=low", "wanted NAME=NUMBER"),
        ("", "wanted NAME=NUMBER"),
        ("torque=nan", "torque: wanted a finite number"),
    ],
)
def test_a_wrong_aspiration_is_refused_in_one_sentence(text, words):
    with pytest.raises(InputError, match=f"^--near: {words}"):
        aspiration_of(BOTH, text, "--near")


def test_an_empty_aspiration_is_refused():
    with pytest.raises(InputError, match="values of some of torque, reach, found none"):
        closest(BOTH, [], {})


def test_without_feasible_designs_none_is_closest():
    assert closest(BOTH, [design(0, {"torque": 1.0, "reach": 1.0}, violation=1.0)], {"reach": 1.0}) == ()
