from __future__ import annotations

import pytest

from evodesign.pool.base import Finished
from evodesign.pool.registry import POOLS, make_pool
from evodesign.pool.serial import SerialPool
from evodesign.pool.stoppable import run_stoppable
from tests.pool.tasks import squares


def test_an_open_gate_gives_every_argument() -> None:
    assert [end.value for end in run_stoppable(SerialPool(), squares, [3, 1, 2], lambda: False)] == [9, 1, 4]


def test_a_gate_that_is_shut_from_the_start_gives_none() -> None:
    assert list(run_stoppable(SerialPool(), squares, [3, 1, 2], lambda: True)) == []


@pytest.mark.parametrize("name", sorted({*POOLS} - {"dask"}))
def test_a_pool_behind_a_shut_gate_finishes_what_is_in_flight_and_ends(name: str) -> None:
    ends: list[Finished[int]] = []
    with make_pool(name, 2) as pool:
        for finished in run_stoppable(pool, squares, range(200), lambda: len(ends) >= 5):
            ends.append(finished)  # noqa: PERF402 - the stop depends on what has come so far
        assert [each.value for each in ends] == [each.index**2 for each in ends]
        assert all(each.failure is None for each in ends)
        assert 5 <= len(ends) <= 5 + 2 + 2, "two at work and two prefetched when the fifth came"
        assert len(list(pool.run(squares, range(3)))) == 3, "the pool goes on"
