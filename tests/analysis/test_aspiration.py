import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from evodesign.analysis.aspiration import AUGMENTATION, closest
from evodesign.analysis.front import front
from evodesign.errors import InputError
from tests.analysis.designs import REACH, TORQUE, design, designs_at, numbers

BOTH = (TORQUE, REACH)
whole = st.integers(0, 8).map(float)


def achievement(designs, hoped, one):
    """The achievement function, written out for torque (less is better) and reach (more is better)."""
    torques = [each.assessment.objectives["torque"] for each in designs]
    reaches = [each.assessment.objectives["reach"] for each in designs]
    torque_range = max(torques) - min(torques)
    reach_range = max(reaches) - min(reaches)
    torque = one.assessment.objectives["torque"] - hoped.get("torque", min(torques))
    reach = hoped.get("reach", max(reaches)) - one.assessment.objectives["reach"]
    parts = [
        0.0 if torque_range == 0.0 else torque / torque_range,
        0.0 if reach_range == 0.0 else reach / reach_range,
    ]
    return max(parts) + AUGMENTATION * sum(parts)


@given(
    st.lists(st.tuples(whole, whole), min_size=1, max_size=10),
    st.dictionaries(st.sampled_from(["torque", "reach"]), whole, min_size=1),
)
def test_designs_come_in_the_order_of_their_achievement(points, hoped):
    designs = designs_at(BOTH, points)
    found = [achievement(designs, hoped, one) for one in closest(BOTH, designs, hoped)]
    assert len(found) == len(designs)
    assert all(a <= b + 1e-12 for a, b in itertools.pairwise(found))


@given(
    st.lists(st.tuples(whole, whole), min_size=1, max_size=10),
    st.fixed_dictionaries({"torque": whole, "reach": whole}),
)
def test_the_closest_design_is_beaten_by_none(points, hoped):
    designs = designs_at(BOTH, points)
    first = closest(BOTH, designs, hoped)[0]
    values = tuple(first.assessment.objectives.values())
    assert values in [tuple(one.assessment.objectives.values()) for one in front(BOTH, designs)]


def test_a_hope_that_is_a_design_of_the_front_finds_that_design():
    designs = designs_at(BOTH, [(5.0, 1.0), (6.0, 1.4), (8.0, 1.7), (12.0, 1.8)])
    for one in designs:
        assert closest(BOTH, designs, one.assessment.objectives)[0] is one


def test_what_nobody_names_is_hoped_to_be_the_best():
    designs = designs_at(BOTH, [(5.0, 1.0), (6.0, 1.4), (8.0, 1.7), (12.0, 1.8)])
    named = closest(BOTH, designs, {"reach": 1.5, "torque": 5.0})
    assert numbers(closest(BOTH, designs, {"reach": 1.5})) == numbers(named)
    assert named[0].number == 1


def test_a_hope_for_something_else_names_what_can_be_hoped_for():
    with pytest.raises(InputError, match=r"wanted objectives among torque, reach, found 'torqe'; did you"):
        closest(BOTH, [], {"torqe": 1.0})
    with pytest.raises(InputError, match="at least one objective"):
        closest(BOTH, [], {})


def test_without_feasible_designs_none_is_closest():
    assert closest(BOTH, [design(0, {"torque": 1.0, "reach": 1.0}, violation=1.0)], {"reach": 1.0}) == ()
    assert np.isfinite(AUGMENTATION)
