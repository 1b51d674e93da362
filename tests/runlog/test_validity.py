"""A header that contradicts itself is told by a sentence, and before anything of its size is made."""

from __future__ import annotations

import msgspec
import pytest

from evodesign.runlog.validity import header_fault
from tests.faults.synthetic import synthetic_header


@pytest.mark.parametrize("dimension", [3, 10**10, 2**64])
def test_a_search_of_other_dimensions_is_told(dimension: int) -> None:
    header = synthetic_header(budget=20, seed=4)
    search = msgspec.structs.replace(header.search, dimension=dimension)
    assert header_fault(header) == ""
    told = header_fault(msgspec.structs.replace(header, search=search))
    assert told == "its search has other dimensions than its 4 parameters"
