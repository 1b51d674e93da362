from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evodesign.analysis.front import front
from evodesign.analysis.hypervolume import best, hypervolume, reference_point
from evodesign.analysis.run_state import RunState
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
