"""Evaluations and their cases as columns of numpy, a value per row."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from evodesign.analysis.conditions import Quantity
from evodesign.records import Evaluation

Column = NDArray[Any]
"""A value per row: whole numbers, numbers, truth values, or texts."""


def evaluation_columns(rows: Sequence[Evaluation], values: Mapping[str, Quantity]) -> dict[str, Column]:
    """A row per evaluation: what every one has, and the quantities asked for."""
    columns = {
        "number": _whole([row.number for row in rows]),
        "generation": _whole([row.generation for row in rows]),
        "feasible": np.array([row.feasible for row in rows], dtype=bool),
        "status": _text([str(row.assessment.status) for row in rows]),
        "violation": _real([row.assessment.violation for row in rows]),
        "seconds": _real([row.seconds for row in rows]),
    }
    return columns | {name: _real([value(row) for row in rows]) for name, value in values.items()}


def case_columns(evaluations: Sequence[Evaluation]) -> dict[str, Column]:
    """A row per evaluation and case."""
    rows = [(row.number, found) for row in evaluations for found in row.assessment.cases]
    return {
        "number": _whole([number for number, _ in rows]),
        "human": _text([outcome.case.person for _, outcome in rows]),
        "payload": _text([outcome.case.payload for _, outcome in rows]),
        "task": _text([str(outcome.case.task) for _, outcome in rows]),
        "height": _real([outcome.case.task.heights[-1] for _, outcome in rows]),
        "status": _text([str(outcome.status) for _, outcome in rows]),
        "reason": _text([outcome.reason for _, outcome in rows]),
        "robot_torque": _real([outcome.robot_torque_norm for _, outcome in rows]),
        "human_torque": _real([outcome.human_torque_norm for _, outcome in rows]),
        "residual": _real([outcome.residual for _, outcome in rows]),
    }


def _whole(values: Sequence[int]) -> Column:
    return np.array(values, dtype=np.int64)


def _real(values: Sequence[float | None]) -> Column:
    """Numbers; those that do not exist are not a number, also where none exists."""
    return np.array(values, dtype=np.float64)


def _text(values: Sequence[str]) -> Column:
    """Texts; pandas would not see that an empty column of objects is one."""
    return np.array(values, dtype=np.object_ if values else np.str_)
