"""Cases, and how what is computed ends."""

from __future__ import annotations

from enum import StrEnum
from typing import Any

import msgspec

from evodesign.tasks import Record, Task


class Status(StrEnum):
    """How a computation ended. The order is from best to worst."""

    SOLVED = "solved"
    INFEASIBLE = "infeasible"
    BODIES_OVERLAP = "bodies in each other"
    ITERATION_LIMIT = "iteration limit"
    TIME_LIMIT = "time limit"
    NUMERICAL_FAILURE = "numerical failure"
    WORKER_LOST = "worker lost"


def worst_status(statuses: list[Status]) -> Status:
    """The last of the given statuses in the order of `Status`; SOLVED for none."""
    order = list(Status)
    return max(statuses, key=order.index, default=Status.SOLVED)


class Sense(StrEnum):
    """Direction in which an objective improves."""

    MINIMISE = "minimise"
    MAXIMISE = "maximise"


class Case(Record, frozen=True, kw_only=True, omit_defaults=True):
    """A person who does a task with a load, undisturbed or under a disturbance.

    Person, load and disturbance are names of the problem, empty where there is one person or load, or no
    disturbance.
    """

    person: str = ""
    payload: str = ""
    task: Task
    disturbance: str = ""

    @property
    def pair(self) -> tuple[str, str]:
        """Names of person and load."""
        return self.person, self.payload

    @property
    def label(self) -> str:
        """Person and load, such as `short, 5 kg`; empty where there is one of each."""
        return ", ".join(name for name in self.pair if name)

    @property
    def name(self) -> str:
        """Everything that tells it from other cases, such as `short, 5 kg, 0.8 m, pushed`."""
        return ", ".join(name for name in (self.label, str(self.task), self.disturbance) if name)


def task_names(case: Case) -> dict[str, Any]:
    """A case as JSON files for others tell it: height or lift, and names only where there are several."""
    names = {"human_name": case.person, "payload_name": case.payload}
    task = msgspec.to_builtins(case.task)
    told = {key: value for key, value in task.items() if key not in ("kind", "knots")}
    return {**told, **{key: name for key, name in names.items() if name}}
