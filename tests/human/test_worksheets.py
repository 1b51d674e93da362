"""RULA and REBA: worked examples that others published, what the papers say of their tables, and bounds."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise, product

import pytest

from evodesign.human.worksheets import ArmSeen, BodySeen, HeldLoad, Score, reba, rula, worksheets

EMPTY = HeldLoad(0.0, still=False, coupling=0)


def test_reba_of_a_light_box_in_front_is_that_of_a_published_example() -> None:
    """AutoREBA, Ground_Truth.md, "Good posture".

    Neck, trunk and legs straight, upper arm at less than 20 degrees, elbow at about 90, straight wrists, a
    box below 11 lb without handles (coupling 2), lifted once: posture scores 1 and 1, REBA 1.
    """
    found = reba(ArmSeen(upper=15.0, elbow=90.0), BodySeen(), HeldLoad(4.0, still=False, coupling=2))
    assert found == Score(arm=3, body=1, whole=1)


@pytest.mark.parametrize(
    ("wrist", "of_arm"),
    [(30.0, 3), (0.0, 2)],
    ids=["left", "right"],
)
def test_reba_of_both_sides_is_that_of_a_published_library(wrist: float, of_arm: int) -> None:
    """rs9000/ergonomics, README: neck 2, trunk 2, legs 2, upper arm 1, lower arm 2, wrist 3 or 2: 4 and 4."""
    body = BodySeen(neck=25.0, trunk=15.0, balanced=False)
    arm = ArmSeen(elbow=30.0, wrist=wrist, deviation=10.0)
    assert reba(arm, body, EMPTY) == Score(arm=of_arm, body=4, whole=4)


def test_reba_of_body_and_arm_are_those_of_its_doctests() -> None:
    """The same: neck 10, trunk 20, walking legs bent by 50: 4; upper arm 45, elbow 70, twisted wrist: 2."""
    arm = ArmSeen(upper=45.0, elbow=70.0, twisted=True)
    found = reba(arm, BodySeen(neck=10.0, trunk=20.0, knee=50.0, balanced=False), EMPTY)
    assert (found.body, found.arm) == (4, 2)


def test_reba_of_a_filled_in_worksheet_is_its_score() -> None:
    """A filled-in worksheet: posture A 2 and load 1 make 3, upper arm 5 and wrist 2 make B 8 (grip good)."""
    arm = ArmSeen(upper=100.0, abduction=30.0, elbow=30.0, wrist=20.0)
    found = reba(arm, BodySeen(trunk=10.0), HeldLoad(8.0, still=False, coupling=0))
    assert found == Score(arm=8, body=3, whole=7)


def test_rula_of_a_bent_and_twisted_trunk_is_that_of_a_published_case() -> None:
    """Trunk 3 + 1 + 1 = 5, legs 1: table B gives 6; muscle use and no force are added to it."""
    for neck in (0.0, 15.0, 25.0):
        body = BodySeen(neck=neck, trunk=40.0, trunk_bent=20.0, trunk_twisted=20.0)
        assert rula(ArmSeen(), body, HeldLoad(0.0, still=False)).body == 6
        assert rula(ArmSeen(), body, HeldLoad(0.0, still=True)).body == 7


def test_rula_is_acceptable_where_both_posture_scores_are_at_most_2_and_nothing_is_added() -> None:
    """McAtamney and Corlett 1993, on grand scores of 1 or 2."""
    for row, column in product(range(8), range(7)):
        assert (worksheets().rula.whole[row][column] <= 2) == (row < 2 and column < 2)


@pytest.mark.parametrize(
    ("load", "still", "added"),
    [(1.0, False, 0), (5.0, False, 1), (5.0, True, 3), (12.0, False, 2), (12.0, True, 4), (1.0, True, 1)],
)
def test_rula_adds_muscle_use_and_force_as_the_paper_does(load: float, still: bool, added: int) -> None:
    """2 to 10 kg: 1, held still 2; more than 10 kg: 2, held still 3; and 1 for what is mainly static."""
    found, bare = (
        rula(ArmSeen(), BodySeen(), held) for held in (HeldLoad(load, still=still), HeldLoad(0.0, False))
    )
    assert (found.arm - bare.arm, found.body - bare.body) == (added, added)


def test_the_tables_have_the_papers_sizes_and_never_fall_along_a_column_of_the_whole() -> None:
    tables = worksheets()
    assert [len(row) for rows in tables.rula.arm for row in rows] == [8] * 18
    assert [len(row) for row in tables.rula.body] == [12] * 6
    assert [len(row) for row in tables.rula.whole] == [7] * 8
    assert [len(row) for rows in tables.reba.body for row in rows] == [4] * 15
    assert [len(row) for rows in tables.reba.arm for row in rows] == [3] * 12
    assert [len(row) for row in tables.reba.whole] == [12] * 12
    for table in (tables.rula.whole, tables.reba.whole):
        assert all(a <= b for row in table for a, b in pairwise(row))
        assert all(a <= b for column in zip(*table, strict=True) for a, b in pairwise(column))


@pytest.mark.parametrize("score", [rula, reba])
def test_the_worst_posture_has_the_worst_score_and_the_best_one_the_best(score) -> None:
    arm = ArmSeen(120.0, 40.0, 20.0, 40.0, 20.0, raised=True, aside=True, twisted=True)
    body = BodySeen(40.0, 80.0, 90.0, 20.0, 20.0, 20.0, 20.0, balanced=False)
    assert score(arm, body, HeldLoad(20.0, still=True, coupling=3)).whole in (7, 13)
    assert score(ArmSeen(), BodySeen(), EMPTY).whole == 1
    assert score(replace(arm, supported=True), body, EMPTY).whole >= 6


@pytest.mark.parametrize("score", [rula, reba])
def test_every_posture_has_a_score(score) -> None:
    for upper, elbow, wrist, neck, trunk, knee in product(
        (-60.0, 0.0, 30.0, 60.0, 150.0),
        (0.0, 80.0, 140.0),
        (0.0, 10.0, 60.0),
        (-30.0, 0.0, 15.0, 50.0),
        (-40.0, 0.0, 15.0, 40.0, 90.0),
        (0.0, 45.0, 100.0),
    ):
        body = BodySeen(neck, trunk, knee, 10.0, 10.0, 10.0, 10.0, balanced=False)
        for held in (EMPTY, HeldLoad(30.0, still=True, coupling=3)):
            arm = ArmSeen(upper, 30.0, elbow, wrist, 10.0, raised=True, aside=True, twisted=True)
            assert 1 <= score(arm, body, held).whole <= 15
