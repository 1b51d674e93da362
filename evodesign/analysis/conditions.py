"""Conditions on designs, as a user writes them: `reach_height >= 1.5 and robot_torque@1.2 < 10`.

A condition is NAME OPERATOR NUMBER with an operator among < <= > >=; several are joined by `and`. A number
that does not exist (the torque of a height that was not reached) meets none. The names, also those of axes
and tables, are:

    robot_torque                an objective of the run or a constrained quantity, natural value
    length.thigh                a parameter of the design
    lowest_reach, highest_reach ends of the interval of load heights that the robot can hold [m]
    robot_torque@1.2            |tau|_2 of an agent at a required height [N m]; human_torque@1.2 likewise
    robot_torque@0.8-1.2 in 1.5 s  its largest in a lift
    robot_torque@short@5 kg@1.2 that of one case, where a problem has several people or loads; then
                                robot_torque@1.2 is the largest at that height, if all of them are solved

An objective of the same name goes before the others.
"""

from __future__ import annotations

import math
import operator
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from operator import attrgetter

from evodesign.errors import InputError, offered
from evodesign.records import (
    SUM,
    Case,
    CaseOutcome,
    Constraint,
    Evaluation,
    Objective,
    Parameter,
    RunHeader,
    Task,
)

Quantity = Callable[[Evaluation], float | None]
"""A number of an evaluation; None where it does not exist."""

Norm = Callable[[CaseOutcome], float | None]

NORMS: Mapping[str, Norm] = {
    "robot_torque": attrgetter("robot_torque_norm"),
    "human_torque": attrgetter("human_torque_norm"),
}
"""The torque norm of each agent [N m]."""

OPERATORS: Mapping[str, Callable[[float, float], bool]] = {
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
}

FORM = re.compile(r"\s*(?P<name>.+?)\s*(?P<sign><=|>=|<|>)\s*(?P<bound>\S+)\s*")
"""A condition; a name may hold anything but the signs."""


def quantities(header: RunHeader, example: Evaluation | None) -> dict[str, Quantity]:
    """All quantities of a run, by name.

    Args:
        header: of the run; its objectives, constraints and parameters have names.
        example: any evaluation of the run, for its cases; None for a run that has none yet.
    """
    cases = () if example is None else tuple(outcome.case for outcome in example.assessment.cases)
    found: dict[str, Quantity] = {
        f"{end}_reach": partial(_reach, f"{end}_m") for end in ("lowest", "highest")
    }
    for case in cases:
        for name, norm in NORMS.items():
            found[f"{name}@{case.task.name}"] = partial(_largest, norm, case.task)
    for case in cases if any(case.label for case in cases) else ():
        place = "@".join(part for part in (*case.pair, f"{case.task.name}") if part)
        for name, norm in NORMS.items():
            found[f"{name}@{place}"] = partial(_of_case, norm, case)
    parts: Mapping[str, Sequence[Parameter | Constraint | Objective]] = {
        "design": header.parameters,
        "constrained": header.constrained,
        "objectives": header.objectives,
    }
    for part, named in parts.items():
        found |= {each.name: partial(_named, part, each.name) for each in named}
    return found


def described(header: RunHeader, evaluation: Evaluation) -> tuple[float | None, ...]:
    """Values of the search's descriptors; None for one that does not exist."""
    wanted = header.search.described
    known = quantities(header, evaluation) if wanted else {}
    return tuple(total(known, each.name, evaluation) for each in wanted)


def total(known: Mapping[str, Quantity], name: str, evaluation: Evaluation) -> float | None:
    """A quantity, or the sum of several; None where one does not exist."""
    values = [known[part](evaluation) if part in known else None for part in name.split(SUM)]
    present = [value for value in values if value is not None]
    return math.fsum(present) if len(present) == len(values) else None


def quantity(known: Mapping[str, Quantity], name: str, source: str) -> Quantity:
    """The quantity of a name.

    Raises:
        InputError: there is none; it names the nearest.
    """
    if name not in known:
        short = [each for each in known if each.count("@") < 2]
        names, found = offered(short, name, beside=known)
        wanted = f"one of {names}"
        if len(short) < len(known):
            wanted += ", robot_torque@WHO@WHAT@HEIGHT, human_torque@WHO@WHAT@HEIGHT"
        raise InputError(source, "", wanted, found)
    return known[name]


def _named(part: str, name: str, evaluation: Evaluation) -> float | None:
    values: Mapping[str, float] = getattr(evaluation.assessment, part)
    return values.get(name)


def _reach(end: str, evaluation: Evaluation) -> float | None:
    value: float | None = getattr(evaluation.assessment.reach, end, None)
    return value


def _largest(norm: Norm, task: Task, evaluation: Evaluation) -> float | None:
    """The largest over all cases of a task; None unless each of them has one."""
    outcomes = [outcome for outcome in evaluation.assessment.cases if outcome.case.task == task]
    norms = [norm(outcome) for outcome in outcomes]
    known = [value for value in norms if value is not None]
    return max(known) if known and len(known) == len(norms) else None


def _of_case(norm: Norm, case: Case, evaluation: Evaluation) -> float | None:
    return next((norm(outcome) for outcome in evaluation.assessment.cases if outcome.case == case), None)


@dataclass(frozen=True, slots=True)
class Condition:
    """A bound on one quantity.

    Args:
        name: of the quantity.
        sign: one of < <= > >=.
        bound: in the quantity's unit.
        value: gives the quantity of an evaluation.
    """

    name: str
    sign: str
    bound: float
    value: Quantity

    def holds(self, evaluation: Evaluation) -> bool:
        """Whether an evaluation has the quantity, within the bound."""
        found = self.value(evaluation)
        return found is not None and OPERATORS[self.sign](found, self.bound)

    def __str__(self) -> str:
        return f"{self.name} {self.sign} {self.bound:g}"


def conditions(text: str, known: Mapping[str, Quantity], source: str) -> tuple[Condition, ...]:
    """The conditions that a text joins by `and`.

    Args:
        text: as the user wrote it.
        known: quantities by name.
        source: who wrote it, such as `--where`, for messages.
    Raises:
        InputError: a part is no condition, or names no quantity.
    """
    return tuple(_condition(part, known, source) for part in re.split(r"\s+and\s+", text.strip()))


def all_conditions(texts: Sequence[str], known: Mapping[str, Quantity], source: str) -> tuple[Condition, ...]:
    """The conditions of several texts, all of which must hold.

    Raises:
        InputError: as in `conditions`, or one of them is no text.
    """
    for text in texts:
        if not isinstance(text, str):
            raise InputError(source, "", "a condition, or a list of conditions", f"{text!r}")
    return tuple(condition for text in texts for condition in conditions(text, known, source))


def meeting(evaluations: Iterable[Evaluation], wanted: Sequence[Condition]) -> tuple[Evaluation, ...]:
    """The evaluations that meet all conditions, in the given order."""
    return tuple(each for each in evaluations if all(condition.holds(each) for condition in wanted))


def _condition(part: str, known: Mapping[str, Quantity], source: str) -> Condition:
    match = FORM.fullmatch(part)
    bound = None if match is None else _number(match["bound"])
    if match is None or bound is None:
        wanted = "NAME < | <= | > | >= NUMBER, joined by 'and', such as \"reach_height >= 1.5\""
        raise InputError(source, "", wanted, f"'{part}'")
    return Condition(match["name"], match["sign"], bound, quantity(known, match["name"], source))


def _number(text: str) -> float | None:
    """A finite number; None for anything else."""
    try:
        value = float(text)
    except ValueError:
        return None
    return value if math.isfinite(value) else None
