"""The order in which workers begin with tests."""

from __future__ import annotations

from itertools import groupby

import pytest

from tests.conftest import slow_ones_sooner


@pytest.mark.parametrize("workers", [1, 2, 3, 8])
def test_every_test_is_run_once_and_modules_stay_whole(workers: int, request: pytest.FixtureRequest) -> None:
    items = list(request.session.items)
    ordered = slow_ones_sooner(items, workers)
    assert len(ordered) == len(items)
    assert set(ordered) == set(items)
    assert len([*groupby(ordered, lambda item: item.path)]) == len({item.path for item in items})


def test_each_share_begins_with_slow_ones() -> None:
    class Test:
        def __init__(self, number: int) -> None:
            self.path, self.slow = number // 2, number >= 12

        def get_closest_marker(self, name: str) -> bool:
            return name == "slow" and self.slow

    tests = [Test(number) for number in range(16)]
    found = [test.path for test in slow_ones_sooner(tests, 2)]  # type: ignore[arg-type]
    assert found == [6, 6, 0, 0, 1, 1, 2, 2, 7, 7, 3, 3, 4, 4, 5, 5]
