from __future__ import annotations

import pytest

from evodesign.analysis.stagnation import stagnant


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
