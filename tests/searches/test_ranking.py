import itertools
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evodesign.searches.base import Outcome
from evodesign.searches.ranking import check_outcomes, infeasibility, ranks, usable

BEST = Outcome((1.0,), 0.0)
GOOD = Outcome((5.0,), 0.0)
NEAR = Outcome((0.0,), 0.01)
FAR = Outcome(None, 1e12)
FAILED = Outcome(None, None)
LADDER = (BEST, GOOD, NEAR, FAR, FAILED)


def first(objectives):
    return objectives[0]


@pytest.mark.parametrize("order", list(itertools.permutations(range(5))))
def test_feasible_before_violated_before_failed_in_any_order(order):
    assert ranks([LADDER[index] for index in order], first) == list(order)


def test_equals_share_a_rank_and_the_next_one_counts_them():
    assert ranks([FAILED, BEST, FAILED, NEAR, NEAR], first) == [3, 0, 3, 1, 1]


def test_no_outcomes_have_no_ranks():
    assert ranks([], first) == []


outcomes = st.builds(
    Outcome,
    st.none() | st.tuples(st.integers(-3, 3).map(float)),
    st.none() | st.sampled_from([0.0, 0.5, 1.0, 2.0]),
)


@given(st.lists(outcomes, max_size=12))
def test_a_rank_is_the_number_of_better_outcomes(generation):
    def beats(a, b):
        if a.feasible != b.feasible:
            return a.feasible
        if a.feasible:
            return a.objectives[0] < b.objectives[0]
        a_known, b_known = bool(a.violation), bool(b.violation)
        if a_known and b_known:
            return a.violation < b.violation
        return a_known and not b_known

    assert ranks(generation, first) == [
        sum(beats(other, outcome) for other in generation) for outcome in generation
    ]


@pytest.mark.parametrize(
    ("outcome", "value"),
    [
        (BEST, 0.0),
        (NEAR, 0.01),
        (FAILED, math.inf),
        (Outcome((1.0,), None), math.inf),
        (Outcome(None, 0.0), math.inf),
        (Outcome((math.nan,), 0.0), math.inf),
        (Outcome((-math.inf,), 0.0), math.inf),
        (Outcome((1.0,), math.nan), math.inf),
    ],
)
def test_infeasibility_is_unknown_unless_feasible_or_measured(outcome, value):
    assert infeasibility(outcome) == value
    assert (usable(outcome) is not None) == (value == 0.0)


def test_nothing_asked_takes_no_outcomes():
    with pytest.raises(ValueError, match="each of 0 genomes"):
        check_outcomes((), [], 1)
