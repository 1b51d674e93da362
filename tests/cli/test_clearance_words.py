"""What is said of the parts with least room."""

from __future__ import annotations

import pytest

from evodesign.cli.tables.design import clearance_in_words


@pytest.mark.parametrize(
    ("clearance", "words"),
    [
        (0.0123, "one and other have least room: 12 mm"),
        (-0.0041, "one and other have least room: 4.1 mm too little"),
    ],
)
def test_two_parts_and_their_room_are_told(clearance: float, words: str) -> None:
    assert (
        clearance_in_words({"least_clearance": {"parts": ["one", "other"], "clearance_m": clearance}})
        == words
    )


def test_nothing_is_told_where_no_actuator_is_a_body() -> None:
    assert clearance_in_words({}) == ""
