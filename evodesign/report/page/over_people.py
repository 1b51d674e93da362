"""How the torques of a design spread over the people of its problem, where there are several.

of one person      what the objective is of that person's cases alone: mean, largest or quantile of |tau|
told               mean and standard deviation (n - 1) of these over the people
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from statistics import mean, stdev

import numpy as np

from evodesign.records import CaseOutcome, Lift

TORQUE = re.compile(r"(worst_|q\d+_)?(robot|human)_torque")
"""Quantities of which the log has the value of every case."""


def over_people(names: Iterable[str], cases: Sequence[CaseOutcome]) -> dict[str, tuple[float, float]]:
    """Mean and standard deviation over people of each of some quantities; nothing for one person.

    Args:
        names: of quantities; those of which the log has only the value of the design are left out.
        cases: of the design; with lifts nothing is told, whose mean over time the log has not.
    """
    people = dict.fromkeys(case.case.person for case in cases)
    if len(people) < 2 or any(isinstance(case.case.task, Lift) for case in cases):
        return {}
    found = {}
    for name in names:
        if not (torque := TORQUE.fullmatch(name)):
            continue
        way, role = torque[1] or "", torque[2]
        by_person = [
            [norm for case in cases if case.case.person == person for norm in _norms(case, role)]
            for person in people
        ]
        if all(None not in values and values for values in by_person):
            each = [_together([norm for norm in values if norm is not None], way) for values in by_person]
            found[name] = mean(each), stdev(each)
    return found


def _norms(case: CaseOutcome, role: str) -> list[float | None]:
    """Undisturbed and under every disturbance."""
    own = {"robot": case.robot_torque_norm, "human": case.human_torque_norm}[role]
    return [own, *(norms.get(role) for norms in case.disturbed.values())]


def _together(norms: Sequence[float], way: str) -> float:
    if way == "worst_":
        return max(norms)
    return float(np.quantile(norms, float(way[1:-1]) / 100.0) if way else np.mean(norms))
