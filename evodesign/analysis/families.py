"""Families: the best design of every kind that a run has met.

Descriptors are quantities that tell kinds apart, such as a length or the reach, or sums of some. A grid over
their bounds has a cell for each kind; its elite is the feasible design that is best in one objective. Bounds
that nobody gave are the least and the largest value of the feasible designs. What lies beyond falls into the
cells at the edge.

    coverage = filled cells / cells        QD score = sum over the elites of |objective - worst|

with the worst value of all feasible designs, unless another is given: only scores of the same grid and the
same worst value compare.

Source: Mouret and Clune 2015; Pugh, Soros and Stanley, Quality diversity: a new frontier for evolutionary
computation, 2016 (the score).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import msgspec
import numpy as np

from evodesign.analysis.conditions import Quantity, quantities, quantity, total
from evodesign.analysis.front import to_minimise
from evodesign.errors import InputError, nearest_name
from evodesign.records import SUM, Descriptor, Evaluation, Objective, RunHeader

CELLS = 20
"""Parts of a descriptor's bounds where none are given."""


@dataclass(frozen=True, slots=True)
class Kind:
    """A filled cell.

    Args:
        cell: its place along each descriptor.
        values: of the descriptors of its elite.
        elite: the best design in it.
    """

    cell: tuple[int, ...]
    values: tuple[float, ...]
    elite: Evaluation


@dataclass(frozen=True, slots=True)
class Families:
    """The kinds of a run.

    Args:
        objective: in which elites are the best.
        descriptors: with bounds.
        kinds: filled cells, in the order of cells.
        worst: natural value of the objective that scores count from; None without a feasible design.
    """

    objective: Objective
    descriptors: tuple[Descriptor, ...]
    kinds: tuple[Kind, ...]
    worst: float | None

    @property
    def cells(self) -> int:
        """How many there are, filled or not."""
        return math.prod(each.cells for each in self.descriptors)

    @property
    def score(self) -> float:
        """The QD score, in the objective's unit."""
        name = self.objective.name
        return math.fsum(
            abs(kind.elite.assessment.objectives[name] - (self.worst or 0.0)) for kind in self.kinds
        )


def families(
    header: RunHeader,
    evaluations: Sequence[Evaluation],
    by: Sequence[str] = (),
    objective: str = "",
    cells: int | None = None,
) -> Families:
    """The kinds of a run.

    Args:
        header: of the run.
        evaluations: in order of number.
        by: descriptors, such as `length.upper_arm + length.forearm`; left out, those of the search, or else
            the first two parameters.
        objective: by name; left out, the first.
        cells: along each descriptor; left out, as the search says, or 20.
    Raises:
        InputError: a name that the run does not know.
    """
    known = quantities(header, evaluations[0] if evaluations else None)
    best = _objective(header, objective)
    wanted = _descriptors(header, known, by, cells)
    feasible = [each for each in evaluations if each.feasible and best.name in each.assessment.objectives]
    rows = [(each, tuple(total(known, axis.name, each) for axis in wanted)) for each in feasible]
    placed = [
        (each, tuple(v for v in values if v is not None)) for each, values in rows if None not in values
    ]
    if not placed:
        return Families(best, wanted, (), None)
    points = np.array([values for _, values in placed])
    axes = tuple(_bounded(axis, points[:, place]) for place, axis in enumerate(wanted))
    elites: dict[tuple[int, ...], Kind] = {}
    for each, values in placed:
        cell = tuple(_cell(axis, value) for axis, value in zip(axes, values, strict=True))
        value = to_minimise(best, each.assessment.objectives[best.name])
        before = elites.get(cell)
        if before is None or value < to_minimise(best, before.elite.assessment.objectives[best.name]):
            elites[cell] = Kind(cell, values, each)
    worst = max(to_minimise(best, each.assessment.objectives[best.name]) for each, _ in placed)
    kinds = tuple(elites[cell] for cell in sorted(elites))
    return Families(best, axes, kinds, to_minimise(best, worst))


def _objective(header: RunHeader, name: str) -> Objective:
    by_name = {each.name: each for each in header.objectives}
    if not name:
        return header.objectives[0]
    if name not in by_name:
        found = f"'{name}'{nearest_name(name, by_name)}"
        raise InputError("objective", "", f"one of {', '.join(by_name)}", found)
    return by_name[name]


def _descriptors(
    header: RunHeader, known: dict[str, Quantity], by: Sequence[str], cells: int | None
) -> tuple[Descriptor, ...]:
    told = {each.name: each for each in header.search.described}
    parameters = [each.name for each in header.parameters[:2]]
    found = []
    for name in by or list(told) or parameters:
        for part in name.split(SUM):
            quantity(known, part, "by")
        own = told.get(name, Descriptor(name, None, None, CELLS))
        found.append(Descriptor(name, own.lower, own.upper, cells or own.cells))
    return tuple(found)


def _bounded(axis: Descriptor, values: np.ndarray[Any, np.dtype[np.float64]]) -> Descriptor:
    lower = float(values.min()) if axis.lower is None else axis.lower
    upper = float(values.max()) if axis.upper is None else axis.upper
    return Descriptor(axis.name, lower, upper if upper > lower else lower + 1.0, axis.cells)


def _cell(axis: Descriptor, value: float) -> int:
    lower, upper = axis.lower or 0.0, axis.upper or 0.0
    share = (
        value / 2.0 - lower / 2.0,
        upper / 2.0 - lower / 2.0,
    )  # halves are finite
    return min(int(min(max(share[0] / share[1], 0.0), 1.0) * axis.cells), axis.cells - 1)


def families_json(found: Families) -> dict[str, Any]:
    """The kinds of a run as a JSON object; its shape is a promise."""
    return {
        "objective": found.objective.name,
        "descriptors": msgspec.to_builtins(found.descriptors),
        "cells": found.cells,
        "filled": len(found.kinds),
        "coverage": len(found.kinds) / found.cells,
        "qd_score": found.score,
        "worst": found.worst,
        "kinds": [
            {
                "cell": list(kind.cell),
                "design": kind.elite.number,
                "descriptors": list(kind.values),
                "objectives": dict(kind.elite.assessment.objectives),
            }
            for kind in found.kinds
        ],
    }
