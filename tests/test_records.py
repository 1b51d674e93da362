"""Cases and tasks: one class in memory and on disk."""

from __future__ import annotations

import msgspec
from hypothesis import given
from hypothesis import strategies as st

from evodesign.records import Case, Hold

NAMES = st.text(max_size=8)
CASES = st.builds(
    Case,
    person=NAMES,
    payload=NAMES,
    task=st.builds(Hold, height_m=st.floats(0.0, 3.0)),
    disturbance=NAMES,
)


@given(case=CASES)
def test_a_case_comes_back_from_the_disk_as_it_was_and_serves_as_a_key(case: Case) -> None:
    again = msgspec.json.decode(msgspec.json.encode(case), type=Case)
    assert again == case
    assert {case: "solved"}[again] == "solved"


@given(case=CASES, other=CASES)
def test_cases_are_equal_exactly_when_their_parts_are(case: Case, other: Case) -> None:
    parts = [(each.person, each.payload, each.task, each.disturbance) for each in (case, other)]
    assert (case == other) == (parts[0] == parts[1])


def test_a_case_is_named_by_what_there_is_several_of() -> None:
    hold = Hold(height_m=0.8)
    assert str(hold) == "0.8 m"
    assert Case(task=hold).name == "0.8 m"
    assert Case(task=hold).label == ""
    several = Case(person="short", payload="5 kg", task=hold, disturbance="pushed")
    assert (several.label, several.name) == ("short, 5 kg", "short, 5 kg, 0.8 m, pushed")


def test_what_is_empty_is_left_out_and_a_task_says_its_kind() -> None:
    assert msgspec.json.encode(Case(task=Hold(height_m=0.8))) == b'{"task":{"kind":"hold","height_m":0.8}}'
