"""Limits that hold most postures of a front: whoever set them, set what the search found."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from statistics import median
from typing import Any

from evodesign.analysis.front import front
from evodesign.records import ActiveLimit, Hold
from evodesign.runlog.run import RunLog

OFTEN = 0.5
"""Share of the cases of a front above which a limit is reported."""


@dataclass(frozen=True, slots=True)
class FrequentLimit:
    """A limit that is active in many cases of a front.

    Args:
        limit: as it is in the first of them.
        active: in how many.
        cases: how many there are.
        change: by how much the effort changes with a step more of the limit [N m], the median of them.
    """

    limit: ActiveLimit
    active: int
    cases: int
    change: float

    @property
    def sentence(self) -> str:
        """It in words, with what a step of it saves."""
        agent = f"{self.limit.agent}: " if self.limit.agent else ""
        step = self.limit.step[1]
        one = step if step[0].isdigit() else f"1 {step}"
        way, much = "more" if self.change < 0.0 else "less", f"{abs(self.change):.2g} N m of effort"
        return (
            f"{agent}{self.limit.words}, is active in {self.active} of {self.cases} cases of the front; "
            f"{one} {way} saves {much} (median)"
        )


def frequent_limits(run: RunLog) -> tuple[FrequentLimit, ...]:
    """The limits that are active in more than half of the cases of a run's front, the most expensive first.

    Lifts do not count, nor designs without logged postures; logs of earlier versions have no limits.
    """
    on_front = {each.number for each in front(run.header.objectives, run.evaluations)}
    details = [each for each in run.details if each.evaluation in on_front]
    cases = [case for each in details for case in each.cases if isinstance(case.case.task, Hold)]
    found: dict[tuple[str, str, str, bool], list[ActiveLimit]] = {}
    for case in cases:
        for limit in case.limits:
            found.setdefault(limit.identity, []).append(limit)
    often = [
        FrequentLimit(each[0], len(each), len(cases), median(limit.change_n_m for limit in each))
        for each in found.values()
        if len(each) > OFTEN * len(cases)
    ]
    return tuple(sorted(often, key=lambda each: -abs(each.change)))


def limits_json(limits: Iterable[FrequentLimit]) -> list[dict[str, Any]]:
    """The same for other programs; `price_n_m` is the median price per unit."""
    return [
        {
            "agent": each.limit.agent,
            "name": each.limit.name,
            "part": each.limit.part,
            "at_most": each.limit.at_most,
            "key": each.limit.key,
            "unit": each.limit.unit,
            "active": each.active,
            "cases": each.cases,
            "price_n_m": each.change / each.limit.step[0],
        }
        for each in limits
    ]
