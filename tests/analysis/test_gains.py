"""What a search gained at no loss beside the design where it began, worked by hand."""

from __future__ import annotations

from pathlib import Path

import msgspec

from evodesign.analysis.gains import gains, gains_json
from evodesign.runlog.run import RunLog
from tests.analysis.designs import MASS, REACH, TORQUE, design
from tests.runlog.toys import toy_header

START = 0.25
DESIGNS = [
    (START, {"torque": 40.0, "reach": 1.2, "mass": 50.0}),
    (0.1, {"torque": 30.0, "reach": 1.2, "mass": 45.0}),  # better in two, equal in one
    (0.2, {"torque": 35.0, "reach": 1.4, "mass": 50.0}),
    (0.3, {"torque": 20.0, "reach": 1.1, "mass": 40.0}),  # reaches less far
    (0.4, {"torque": 30.0, "reach": 1.2, "mass": 47.0}),  # dominated by the second
]


def run_of(designs: list[tuple[float, dict[str, float]]], infeasible: float | None = None) -> RunLog:
    header = toy_header(dimension=1)
    header = msgspec.structs.replace(header, objectives=(TORQUE, REACH, MASS))
    evaluations = tuple(
        design(number, values, 1.0 if place == infeasible else 0.0, genome=(place,))
        for number, (place, values) in enumerate(designs)
    )
    return RunLog(Path("run"), header, evaluations, (), (), (), complete=True, notes=())


def test_gains_worked_by_hand() -> None:
    found = gains(run_of(DESIGNS))
    assert gains_json(found) == {
        "start": 0,
        "better": 2,
        "best": {
            "torque": {"id": 1, "before": 40.0, "after": 30.0},
            "reach": {"id": 2, "before": 1.2, "after": 1.4},
            "mass": {"id": 1, "before": 50.0, "after": 45.0},
        },
    }
    assert found is not None
    assert found.sentence == (
        "2 of 3 designs of the front are better than design 0, where the search began, and nowhere worse: "
        "torque from 40 to 30 N m (design 1), reach from 1.2 to 1.4 m (design 2), "
        "mass from 50 to 45 kg (design 1)"
    )


def test_nothing_is_said_to_be_gained_where_each_other_design_loses_something() -> None:
    found = gains(run_of([DESIGNS[0], DESIGNS[3]]))
    assert found is not None
    assert found.better == 0
    assert found.sentence == "no design is better than design 0, where the search began, and nowhere worse"


def test_a_start_that_is_infeasible_or_not_in_the_run_compares_with_nothing() -> None:
    assert gains(run_of(DESIGNS, infeasible=START)) is None
    assert gains(run_of(DESIGNS[1:])) is None
    assert gains_json(None) is None
