"""Designs written side by side come back as they were, and what they share is written once."""

from __future__ import annotations

from typing import Any

import msgspec
from hypothesis import given
from hypothesis import strategies as st

from evodesign.report.page.render import side_by_side
from tests.report.page.reading import apart

LEAVES = (
    st.none() | st.booleans() | st.integers(-9, 9) | st.text(max_size=3) | st.sampled_from([0.5, -0.5, 2.0])
)
PARTS = st.recursive(
    LEAVES,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=2), inner, max_size=3),
)


@given(st.dictionaries(st.integers(0, 99), PARTS, max_size=6))
def test_whatever_is_written_comes_back(parts: dict[int, Any]) -> None:
    told = apart(msgspec.json.decode(msgspec.json.encode(side_by_side(parts))))
    assert told == parts
    assert repr({number: told[number] for number in parts}) == repr(parts), "true is not one"


@given(st.lists(st.floats(-1e4, 1e4), min_size=1, max_size=6))
def test_numbers_in_steps_are_off_by_half_a_step_of_the_largest(column: list[float]) -> None:
    parts = dict(enumerate(column))
    told = apart(msgspec.json.decode(msgspec.json.encode(side_by_side(parts, 2000, 1e6))))
    largest = max(map(abs, column))
    for number, value in parts.items():
        assert abs(told[number] - value) <= max(0.5 * largest / 2000, 0.5e-6) * (1 + 1e-9)
        assert value != 0.0 or told[number] == 0.0, "a joint that carries nothing carries nothing in the page"


def posture(knee: float) -> dict[str, Any]:
    return {"name": "hold", "angles": [knee, knee, 0.25], "roll": {"left": -knee, "right": 0.25}}


def test_postures_of_one_form_hold_a_column_for_each_number_that_is_its_own() -> None:
    (group,) = side_by_side({7: posture(0.5), 9: posture(1.5)})
    assert group["of"] == [7, 9]
    assert group["columns"] == ["hold", (0.5, 1.5), 0.25]
    assert group["places"] == [0, 1, 1, 2, -2, 2], "the left roll is the knee with its sign turned"
    assert apart([group]) == {7: posture(0.5), 9: posture(1.5)}


def test_designs_of_other_forms_stand_in_groups_of_their_own() -> None:
    parts = {1: [], 2: [1.0], 3: [], 4: {"a": []}}
    assert [group["of"] for group in side_by_side(parts)] == [[1, 3], [2], [4]]
    assert apart(side_by_side(parts)) == parts


def test_true_and_false_are_no_numbers() -> None:
    parts = {1: [1.0, True, 0.0, False, 1], 2: [1.0, True, False, 0.0, True]}
    told = apart(msgspec.json.decode(msgspec.json.encode(side_by_side(parts))))
    assert msgspec.json.encode(told) == msgspec.json.encode(parts)
