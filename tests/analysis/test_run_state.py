"""The state of a run, carried on from generation to generation, and its standstill."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evodesign.analysis.front import front
from evodesign.analysis.hypervolume import best, hypervolume, reference_point
from evodesign.analysis.run_state import RunState, exhausted, stagnant
from tests.runlog.toys import toy_evaluations, toy_header


@given(seed=st.integers(0, 200), population=st.integers(1, 9), generations=st.integers(1, 6))
def test_standing_carried_on_equals_standing_looked_up_anew(
    seed: int, population: int, generations: int
) -> None:
    header = toy_header(population=population, seed=seed)
    run = toy_evaluations(header, population * generations)
    run_state = RunState(header.objectives)
    reference = None
    for number in range(generations):
        known = run[: population * (number + 1)]
        born = known[population * number :]
        run_state.add(born)
        reference = reference or reference_point(header.objectives, known)
        record = run_state.generation(number, born, seconds=0.5)
        assert (record.number, record.evaluations, record.seconds) == (number, len(known), 0.5)
        assert record.feasible_share == pytest.approx(sum(each.feasible for each in born) / population)
        assert record.best == best(header.objectives, known)
        assert record.reference == reference
        if reference is None:
            assert record.hypervolume is None
        else:
            assert record.hypervolume == pytest.approx(hypervolume(header.objectives, known, reference))
        members = tuple(each.number for each in front(header.objectives, known))
        assert run_state.front(number).evaluations == members


@pytest.mark.parametrize(
    ("volumes", "least", "expected"),
    [
        ([8.0, 10.0, 10.05, 10.1], 4.0, True),
        ([8.0, 10.0, 10.05, 10.1], 3.0, False),
        ([8.0, 10.0, 10.0, 10.0], 0.1, True),
        ([8.0, 10.0, 10.0, 10.0], 0.0, False),
        ([8.0, 10.0, 10.0, 10.0], None, False),
        ([None, None, 10.0, 10.0], 50.0, False),
    ],
)
def test_a_search_is_exhausted_when_nine_in_ten_would_grow_by_less(
    volumes: list[float | None], least: float | None, expected: bool
) -> None:
    """The last doubling grew by 1 %, so that nine in ten would grow by less than 3.3 %."""
    assert exhausted([(10 * (place + 1), volume) for place, volume in enumerate(volumes)], least) is expected


@pytest.mark.parametrize(
    ("hypervolumes", "generations", "expected"),
    [
        ([1.0, 1.0, 1.0], 2, True),
        ([1.0, 1.0005, 1.0009], 2, True),
        ([1.0, 1.0005, 1.0011], 2, False),
        ([0.5, 1.0, 1.0], 2, False),
        ([1.0, 1.0], 2, False),
        ([None, None, None], 2, False),
        ([None, 1.0, 1.0], 2, False),
        ([1.0, 1.0, 1.0], 0, False),
        ([1.0, 1.0, 1.0], None, False),
        ([], 1, False),
    ],
)
def test_a_standstill_is_growth_below_a_thousandth_over_so_many_generations(
    hypervolumes: list[float | None], generations: int | None, expected: bool
) -> None:
    assert stagnant(hypervolumes, generations) is expected
