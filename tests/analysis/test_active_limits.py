"""A limit that holds most of a front is named, with what a step of it saves."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import msgspec
import pytest

from evodesign.analysis.active_limits import frequent_limits, limits_json
from evodesign.records import ActiveLimit, Case, CaseDetail, Detail, Hold, InstantDetail, Lift
from evodesign.runlog.run import RunLog, read_run
from evodesign.runlog.writer import RunWriter
from tests.runlog.toys import toy_evaluations, toy_header

HEIGHTS = 0.8, 1.0, 1.2


def feet(price: float) -> ActiveLimit:
    return ActiveLimit(
        name="feet apart",
        value=0.5,
        unit="m",
        price_n_m=price,
        at_most=True,
        agent="human",
        key="limits.feet_apart_m",
    )


def clear(price: float) -> ActiveLimit:
    return ActiveLimit(name="trunk clearance", value=0.15, unit="m", price_n_m=price, part="chest")


@pytest.fixture
def run(tmp_path: Path) -> RunLog:
    """Without postures."""
    header = toy_header()
    with RunWriter(tmp_path / "run", header) as log:
        for evaluation in toy_evaluations(header, 6):
            log.write(evaluation)
    return read_run(tmp_path / "run")


def with_limits(run: RunLog, *limits: tuple[ActiveLimit, ...]) -> RunLog:
    """A run whose every design has a case for each of these."""
    instants = (InstantDetail(time_s=0.0, agents={}),)
    cases = tuple(
        CaseDetail(case=Case(task=Hold(height_m=height)), instants=instants, limits=each)
        for height, each in zip(HEIGHTS, limits, strict=False)
    )
    return replace(
        run, details=tuple(Detail(evaluation=each.number, cases=cases) for each in run.evaluations)
    )


def test_a_limit_of_more_than_half_of_the_cases_is_named(run: RunLog) -> None:
    found = frequent_limits(with_limits(run, (feet(-4.0), clear(2.0)), (feet(-2.0),), ()))
    assert [each.limit.name for each in found] == ["feet apart"]
    (often,) = found
    assert often.active * 3 == often.cases * 2
    assert often.change == pytest.approx(-0.03)
    assert often.sentence == (
        f"human: feet apart, at most 50 cm, is active in {often.active} of {often.cases} cases of the front; "
        "1 cm more saves 0.03 N m of effort (median)"
    )


def test_half_of_the_cases_are_not_more_than_half(run: RunLog) -> None:
    assert frequent_limits(with_limits(run, (feet(-4.0),), ())) == ()


def test_a_larger_least_value_costs_and_a_smaller_one_saves(run: RunLog) -> None:
    (often,) = frequent_limits(with_limits(run, (clear(3.0),)))
    assert often.sentence.startswith("trunk clearance of chest, at least 15 cm, is active")
    assert often.sentence.endswith("1 cm less saves 0.03 N m of effort (median)")


def test_the_most_expensive_is_named_first(run: RunLog) -> None:
    found = frequent_limits(with_limits(run, (clear(1.0), feet(-4.0))))
    assert [each.limit.name for each in found] == ["feet apart", "trunk clearance"]
    told = limits_json(found)[0]
    assert told["price_n_m"] == pytest.approx(-4.0)
    assert (told["key"], told["agent"]) == ("limits.feet_apart_m", "human")


def test_a_run_without_postures_or_limits_names_none(run: RunLog) -> None:
    assert frequent_limits(run) == ()
    assert frequent_limits(with_limits(run, (), ())) == ()


def test_lifts_do_not_count(run: RunLog) -> None:
    lifted = Case(task=Lift(0.8, 1.2))
    case = CaseDetail(case=lifted, instants=(InstantDetail(time_s=0.0, agents={}),) * 2, limits=())
    held = with_limits(run, (feet(-4.0),))
    both = tuple(msgspec.structs.replace(each, cases=(*each.cases, case, case)) for each in held.details)
    (often,) = frequent_limits(replace(held, details=both))
    assert often.active == often.cases
