"""Failures of evaluations, and causes of infeasibility, are told apart and counted."""

from __future__ import annotations

import msgspec

from evodesign.analysis.failures import causes, causes_of_infeasibility, failures
from evodesign.records import Case, CaseOutcome, Evaluation, Hold, Status
from tests.runlog.toys import toy_evaluations, toy_header


def with_status(evaluation: Evaluation, status: Status) -> Evaluation:
    return msgspec.structs.replace(
        evaluation, assessment=msgspec.structs.replace(evaluation.assessment, status=status)
    )


def test_failures_are_counted_by_cause_and_infeasible_designs_are_none() -> None:
    statuses = [Status.SOLVED, Status.WORKER_LOST, Status.INFEASIBLE, Status.TIME_LIMIT, Status.WORKER_LOST]
    evaluations = toy_evaluations(toy_header(), len(statuses))
    counts = failures(map(with_status, evaluations, statuses))
    assert counts == {Status.WORKER_LOST: 2, Status.TIME_LIMIT: 1}
    assert causes(counts) == "time limit 1, worker lost 2"
    assert causes({}) == "none"


def height(height_m: float, status: Status, person: str = "", payload: str = "") -> CaseOutcome:
    return CaseOutcome(
        case=Case(person=person, payload=payload, task=Hold(height_m=height_m)),
        status=status,
        reason="",
        robot_torque_norm=None,
        human_torque_norm=None,
        iterations=1,
        residual=None,
    )


def failed(number: int, status: Status, *heights: CaseOutcome) -> Evaluation:
    first = toy_evaluations(toy_header(), 1)[0]
    assessment = msgspec.structs.replace(
        first.assessment, violation=0.1, status=status, reason=f"reason {number}", cases=heights
    )
    return msgspec.structs.replace(first, number=number, assessment=assessment)


LOW, HIGH = height(0.8, Status.SOLVED), height(1.2, Status.INFEASIBLE)


def test_causes_name_the_heights_and_the_most_frequent_comes_first() -> None:
    lost = failed(0, Status.WORKER_LOST)
    missed = [failed(number, Status.INFEASIBLE, LOW, HIGH) for number in (1, 2)]
    found = causes_of_infeasibility([lost, *missed])
    assert [(each.cause, each.count, each.example) for each in found] == [
        ("infeasible at 1.2 m", 2, 1),
        ("worker lost", 1, 0),
    ]
    assert found[0].reason == "reason 1"


def test_several_heights_are_one_cause() -> None:
    tall = height(1.5, Status.INFEASIBLE)
    assert (
        causes_of_infeasibility([failed(0, Status.INFEASIBLE, LOW, HIGH, tall)])[0].cause
        == "infeasible at 1.2 and 1.5 m"
    )
    assert (
        causes_of_infeasibility([failed(0, Status.INFEASIBLE, HIGH, tall)])[0].cause
        == "infeasible at every height"
    )


def test_a_cause_names_a_height_once_and_with_whom_it_failed() -> None:
    def case(human: str, status: Status) -> CaseOutcome:
        return height(1.2, status, human, "5 kg")

    def cause(*statuses: Status) -> str:
        cases = [case(human, status) for human, status in zip("abc", statuses, strict=True)]
        worst = next(status for status in statuses if status is not Status.SOLVED)
        return causes_of_infeasibility([failed(0, worst, LOW, *cases)])[0].cause

    lost, solved = Status.NUMERICAL_FAILURE, Status.SOLVED
    assert cause(lost, lost, lost) == f"{lost} at 1.2 m"
    assert cause(solved, lost, solved) == f"{lost} at 1.2 m with b, 5 kg"
    assert cause(lost, solved, lost) == f"{lost} at 1.2 m with 2 pairs of person and load"


def test_feasible_designs_do_not_fail() -> None:
    evaluations = toy_evaluations(toy_header(), 40)
    found = causes_of_infeasibility(evaluations)
    assert sum(each.count for each in found) == sum(not evaluation.feasible for evaluation in evaluations)
    assert causes_of_infeasibility([evaluation for evaluation in evaluations if evaluation.feasible]) == ()
