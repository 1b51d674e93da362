"""What a change of a problem has precomputed again, as docs/model.md, section 5, says."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import msgspec
import pytest

from evodesign.evaluation.precompute import precompute_setting, staged_pieces
from evodesign.posture.precompute import keys
from evodesign.problem.build import build_problem
from evodesign.problem.source import read_source

SOURCE = read_source(Path(__file__).parents[2] / "problems" / "icub_lifting.toml")


@cache
def keys_of(*changes: tuple[str, str]) -> set[str]:
    """Under which what is made ready of the default problem, with changes, lies in the cache."""
    text = SOURCE.text
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    problem = build_problem(msgspec.structs.replace(SOURCE, text=text))
    pieces = [piece for stage in staged_pieces(problem) for piece in stage]
    return {*keys.keys_of(precompute_setting(problem), pieces).values()}


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("seed = 1", "seed = 2"),
        ("evaluations = 480", "evaluations = 960"),
        ('name = "icub-lifting"', 'name = "mine"'),
        ('maximise = ["shared_reach_height"]', 'maximise = ["reach_height"]'),
        ("mass_kg = { upper = 65.0 }", "mass_kg = { upper = 60.0 }"),
    ],
)
def test_nothing_is_made_again(old: str, new: str) -> None:
    assert keys_of((old, new)) <= keys_of()


EVERYTHING = [
    ("mass_kg = 15.0", "mass_kg = 14.0"),
    ("heights_m = [0.8, 1.0, 1.2]", "heights_m = [0.8, 1.0, 1.1]"),
    ("percentiles = [5]", "percentiles = [50]"),
    ("push_n = [-20.0, 0.0, 0.0]", "push_n = [-10.0, 0.0, 0.0]"),
    ("lower = 0.6\nupper = 1.8", "lower = 0.7\nupper = 1.8"),
]


@pytest.mark.parametrize(("old", "new"), EVERYTHING)
def test_everything_is_made_again_where_bodies_are_kept_apart(old: str, new: str) -> None:
    """What comes near whom follows from all of it, and everything else from that."""
    assert not keys_of((old, new)) & keys_of()


def test_heights_that_stay_are_kept_where_bodies_may_pass_through_each_other() -> None:
    free = ("[collisions]", "# no [collisions]")
    before = keys_of(free)
    again = keys_of(free, ("heights_m = [0.8, 1.0, 1.2]", "heights_m = [0.8, 1.0, 1.1]"))
    choices_and_new_starts = 2 * 3 + 2
    assert len(again - before) <= choices_and_new_starts < len(again)


def test_all_starts_are_made_again_where_the_middle_height_changes() -> None:
    """Those of other heights are sought from its own."""
    free = ("[collisions]", "# no [collisions]")
    before = keys_of(free)
    again = keys_of(free, ("heights_m = [0.8, 1.0, 1.2]", "heights_m = [0.8, 1.1, 1.2]"))
    people_and_extremes = 2 + 2
    assert len(again & before) <= people_and_extremes < len(again)
