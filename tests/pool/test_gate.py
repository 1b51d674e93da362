from __future__ import annotations

import pytest

from evodesign.pool.base import Finished
from evodesign.pool.gate import Gate, Withheld, run_gated
from evodesign.pool.registry import POOLS, make_pool
from tests.pool.tasks import process


def test_an_open_gate_gives_every_argument() -> None:
    gate = Gate([3, 1, 2], lambda: False)
    assert list(gate) == [3, 1, 2]
    assert gate[1:] == [1, 2]
    assert gate.withheld == set()


def test_a_shut_gate_withholds_what_is_still_to_come() -> None:
    taken: list[int] = []
    gate = Gate([3, 1, 2], lambda: len(taken) >= 1)
    first = gate[0]
    assert isinstance(first, int)
    taken.append(first)
    assert gate[1:] == [Withheld.WITHHELD] * 2
    assert gate.withheld == {1, 2}


def test_a_shut_gate_still_has_an_end() -> None:
    assert list(Gate([3, 1, 2], lambda: True)) == [Withheld.WITHHELD] * 3


@pytest.mark.parametrize("name", POOLS)
def test_a_pool_behind_a_shut_gate_finishes_what_is_in_flight_and_soon_ends(name: str) -> None:
    ends: list[Finished[int]] = []
    with make_pool(name, 2) as pool:
        for finished in run_gated(pool, process, [0.05] * 200, lambda: len(ends) >= 5):
            ends.append(finished)  # noqa: PERF402 - the gate looks at what has come so far
        assert all(each.failure is None and isinstance(each.value, int) for each in ends)
        assert 5 <= len(ends) < 100, "what was in flight, and what came before anyone could look"
        assert len(list(pool.run(process, [0.0] * 3))) == 3, "the pool goes on"
