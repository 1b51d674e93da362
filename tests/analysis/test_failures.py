from __future__ import annotations

import msgspec

from evodesign.analysis.failures import causes, failures
from evodesign.records import Evaluation, Status
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
