"""What a design violates, worked out a second time."""

from __future__ import annotations

import math

import msgspec
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from evodesign.analysis.failures import causes_of_infeasibility
from evodesign.quantities.objectives import objective_kinds
from evodesign.records import (
    Assessment,
    Case,
    CaseOutcome,
    Constraint,
    Evaluation,
    Hold,
    ReachOutcome,
    Status,
)
from evodesign.violations import (
    BODIES_APART,
    HEIGHT,
    bounds_text,
    constraint_sentences,
    constraints_json,
    reason_of_infeasibility,
    total_violation,
    violations,
)

LIGHT = Constraint(name="mass", unit="kg", lower=None, upper=65.0)
HIGH = Constraint(name="reach_height", unit="m", lower=1.5, upper=None)
WEAK = Constraint(name="robot_torque", unit="N m", lower=None, upper=20.0)

numbers = st.floats(-1e3, 1e3)


def case(height: float, status: Status = Status.SOLVED, person: str = "") -> CaseOutcome:
    return CaseOutcome(
        case=Case(person=person, task=Hold(height_m=height)),
        status=status,
        reason="",
        robot_torque_norm=None,
        human_torque_norm=None,
        iterations=0,
        residual=None,
    )


def assessment(
    values: dict[str, float], *cases: CaseOutcome, highest: float = 1.3, **rest: object
) -> Assessment:
    """A design that holds loads from 0.5 m to the highest."""
    found = Assessment(
        design={},
        objectives={},
        violation=None,
        status=Status.SOLVED,
        reason="solved",
        reach=ReachOutcome(lowest_m=0.5, highest_m=highest, status=Status.SOLVED, reason=""),
        cases=cases or (case(1.0),),
        constraints=values or msgspec.UNSET,
    )
    return msgspec.structs.replace(found, **rest)


@given(value=numbers, one=numbers, other=numbers, both=st.booleans())
def test_excess_is_relative_to_the_bound_that_is_exceeded(
    value: float, one: float, other: float, both: bool
) -> None:
    lower, upper = (min(one, other), max(one, other)) if both else (None, one)
    assume(lower is None or upper is None or lower < upper)
    bounds = Constraint(name="mass", unit="kg", lower=lower, upper=upper)
    nearest = min(max(value, -math.inf if lower is None else lower), math.inf if upper is None else upper)
    size = abs(nearest) if nearest else 1.0
    assert total_violation([bounds], {"mass": value}, 0.0) == pytest.approx(abs(value - nearest) / size)
    (found,) = constraints_json([bounds], assessment({"mass": value}))
    assert found["violation"] == pytest.approx(abs(value - nearest))
    assert (found["violation"] == 0.0) is (nearest == value)


def test_metres_and_relative_excesses_add_up() -> None:
    missed = (case(1.0), case(1.4, Status.INFEASIBLE), case(1.6, Status.INFEASIBLE))
    found = assessment({"mass": 78.0, "reach_height": 1.3}, *missed)
    assert violations((LIGHT, HIGH, WEAK), found) == {
        HEIGHT: pytest.approx(0.1 + 0.3),
        "mass": pytest.approx(13.0),
        "reach_height": pytest.approx(0.2),
        "robot_torque": None,
    }
    whole_bound = 1.0  # of the torque, which does not exist at the heights that are missed
    total = total_violation((LIGHT, HIGH, WEAK), found.constrained, 0.4)
    assert total == pytest.approx(0.4 + 13.0 / 65.0 + 0.2 / 1.5 + whole_bound)


def test_what_is_missing_without_a_missed_height_is_unknown() -> None:
    assert total_violation([WEAK], {}, 0.0) is None
    assert total_violation([WEAK], {"robot_torque": 30.0}, None) is None
    lost = assessment({"mass": 70.0}, case(1.0, Status.TIME_LIMIT))
    assert violations([LIGHT], lost) == {HEIGHT: None, "mass": 5.0}
    nowhere = assessment({"mass": 70.0}, reach=None)
    assert violations([LIGHT], nowhere)[HEIGHT] is None


def test_bodies_in_each_other_count_by_their_metres_and_hide_no_other_bound() -> None:
    apart = Constraint(name=BODIES_APART, unit="m", lower=0.0, upper=None)
    cases = [case(1.0, Status.BODIES_OVERLAP), case(1.4, Status.BODIES_OVERLAP)]
    reason = "chest 35 mm inside root_link"
    found = assessment({BODIES_APART: -0.035}, *cases, status=Status.BODIES_OVERLAP, reason=reason)
    assert violations([apart], found) == {HEIGHT: pytest.approx(0.1), BODIES_APART: pytest.approx(0.035)}
    whole_bound = 1.0  # of the torque, which does not exist without a posture
    total = total_violation((apart, WEAK), found.constrained, 0.1)
    assert total == pytest.approx(0.1 + 0.035 + whole_bound)
    assert reason_of_infeasibility([apart, LIGHT], found) == reason


def test_a_height_counts_once_whatever_the_number_of_people() -> None:
    cases = [case(1.5, Status.INFEASIBLE, person) for person in ("short", "tall")]
    assert violations([LIGHT], assessment({"mass": 1.0}, *cases))[HEIGHT] == pytest.approx(0.2)


def test_without_constraints_the_violation_is_the_missed_height() -> None:
    assert violations((), assessment({}, violation=0.25)) == {HEIGHT: 0.25}


def test_sentences_say_what_exceeds_which_bound() -> None:
    found = assessment({"mass": 68.2, "reach_height": 1.3})
    assert constraint_sentences((LIGHT, HIGH), found) == (
        "mass is 3.2 kg above 65 kg",
        "reach height is 0.2 m below 1.5 m",
    )
    assert reason_of_infeasibility((LIGHT,), found) == "mass is 3.2 kg above 65 kg"
    missed = assessment({"mass": 68.2}, status=Status.INFEASIBLE, reason="1.4 m is out of reach")
    assert reason_of_infeasibility((LIGHT,), missed) == "1.4 m is out of reach; mass is 3.2 kg above 65 kg"
    assert constraint_sentences((LIGHT,), assessment({"mass": 65.0})) == ()


@pytest.mark.parametrize(
    ("lower", "upper", "words"),
    [
        (None, 65.0, "at most 65 kg"),
        (0.0, None, "at least 0 kg"),
        (40.0, 65.0, "40 to 65 kg"),
    ],
)
def test_bounds_are_told_in_words(lower: float | None, upper: float | None, words: str) -> None:
    assert bounds_text(Constraint(name="mass", unit="kg", lower=lower, upper=upper)) == words


def test_causes_of_infeasibility_name_exceeded_bounds() -> None:
    designs = [
        Evaluation(
            number=number,
            generation=0,
            genome=(),
            assessment=assessment({"mass": mass, "reach_height": reach}, violation=0.1),
            seconds=0.0,
            worker="",
        )
        for number, (mass, reach) in enumerate([(70.0, 1.3), (70.0, 1.6), (80.0, 1.7)])
    ]
    found = causes_of_infeasibility(designs, (LIGHT, HIGH))
    assert [(each.cause, each.count, each.example) for each in found] == [
        ("mass above 65 kg", 2, 1),
        ("mass above 65 kg and reach height below 1.5 m", 1, 0),
    ]
    assert found[0].reason == "mass is 5 kg above 65 kg"


def test_no_quantity_is_called_as_the_heights_are() -> None:
    assert HEIGHT not in objective_kinds()


def test_records_without_constraints_are_written_as_before() -> None:
    written = msgspec.json.decode(msgspec.json.encode(assessment({})))
    assert "constraints" not in written
    with_one = msgspec.json.encode(assessment({"mass": 68.2}))
    assert msgspec.json.decode(with_one, type=Assessment).constrained == {"mass": 68.2}
