"""Conditions on designs, as a user writes them: `reach_height >= 1.5 and robot_torque@1.2 < 10`.

A condition is NAME OPERATOR NUMBER with an operator among < <= > >= and a name of `quantities`; several are
joined by `and`. A number that does not exist (the torque of a height that was not reached) meets none.
"""

from __future__ import annotations

import math
import operator
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

from evodesign.analysis.quantities import Quantity, quantity
from evodesign.errors import InputError
from evodesign.records import Evaluation

__all__ = ["Condition", "conditions", "meeting"]

OPERATORS: Mapping[str, Callable[[float, float], bool]] = {
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
}

FORM = re.compile(r"\s*(?P<name>.+?)\s*(?P<sign><=|>=|<|>)\s*(?P<bound>\S+)\s*")
"""A condition; a name may hold anything but the signs."""


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
