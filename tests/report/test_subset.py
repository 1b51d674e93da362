"""Thinning keeps order, evenness and what fits."""

from __future__ import annotations

import itertools

from hypothesis import given
from hypothesis import strategies as st

from evodesign.report.subset import subsample


@given(st.integers(0, 300), st.integers(0, 50))
def test_as_many_as_may_be_evenly(count: int, most: int) -> None:
    kept = subsample(range(count), most)
    assert len(kept) == min(count, most)
    gaps = [b - a for a, b in itertools.pairwise(kept)]
    assert all(gap >= 1 for gap in gaps)
    assert not gaps or max(gaps) - min(gaps) <= 1


def test_few_are_kept_as_they_are() -> None:
    assert subsample("abc", 3) == ["a", "b", "c"]
