"""Importance of parameters, and slices through a design, as tables."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from evodesign.analysis.front import to_minimise
from evodesign.analysis.importance import Estimate, Importance, ObjectiveImportance, PairImportance, Slice
from evodesign.cli.output import rounded
from evodesign.cli.tables.table import FittedTable, names, numbers, titled
from evodesign.records import Evaluation, Objective, RunHeader

MOST_PAIRS = 3

ROUNDING = 1e-12
"""A slope below it is shown as none."""


def importance_tables(found: Importance) -> Iterator[FittedTable]:
    """A table of each objective of which something is known."""
    for each in found.objectives:
        if each.response.models or any(row.slope for row in each.parameters):
            yield _table(each)


def _table(found: ObjectiveImportance) -> FittedTable:
    objective = found.response.objective
    with_slopes = any(row.slope for row in found.parameters)
    shares = ["alone [%]", "5 to 95 %", "in all [%]", "5 to 95 %"] if found.response.models else []
    slopes = [f"slope [{objective.unit}]", "5 to 95 %"] if with_slopes else []
    title = f"What matters to {objective.name}"
    table = titled(title, [*names("parameter"), *numbers(*shares, *slopes)], caption=_pairs(found.pairs))
    for row in found.parameters:
        cells = [*_percent(row.first), *_percent(row.total)] if found.response.models else []
        table.add_row(row.name, *cells, *(_figures(row.slope) if with_slopes else []))
    return table


def _percent(found: Estimate | None) -> list[str]:
    if found is None:
        return ["-", "-"]
    return [f"{100.0 * found.value:.1f}", f"{100.0 * found.low:.1f} to {100.0 * found.high:.1f}"]


def _figures(found: Estimate | None) -> list[str]:
    if found is None:
        return ["-", "-"]
    value, low, high = (0.0 if each < ROUNDING else each for each in (found.value, found.low, found.high))
    return [f"{value:.3g}", f"{low:.3g} to {high:.3g}"]


def _pairs(pairs: Sequence[PairImportance]) -> str:
    told = [
        f"{' with '.join(pair.names)} {100.0 * pair.share.value:.1f} %"
        f" ({100.0 * pair.share.low:.1f} to {100.0 * pair.share.high:.1f})"
        for pair in pairs[:MOST_PAIRS]
    ]
    return f"strongest interactions: {', '.join(told)}" if told else ""


def slice_tables(header: RunHeader, design: Evaluation, made: Sequence[Slice]) -> Iterator[FittedTable]:
    """Slices through a design: the objective at the ends of each parameter's range, and at its best."""
    for objective in header.objectives:
        own = [each for each in made if each.objective == objective.name]
        if own:
            yield _slices(objective, design, own)


def _slices(objective: Objective, design: Evaluation, made: Sequence[Slice]) -> FittedTable:
    here = rounded(design.assessment.objectives.get(objective.name))
    columns = ("here", "at the lower bound", "at the upper bound", "best", "best at")
    table = titled(
        f"{objective.name} [{objective.unit}] through design {design.number}, which has {here}",
        [*names("parameter"), *numbers(*columns)],
        caption="by the models: mean, and 5 to 95 % of their samples",
    )
    for each in made:
        turned = [to_minimise(objective, value) for value in each.predicted]
        best = min(range(len(turned)), key=turned.__getitem__)
        table.add_row(
            each.parameter,
            design.assessment.design[each.parameter],
            *(f"{each.predicted[i]:.4g} ({each.low[i]:.4g} to {each.high[i]:.4g})" for i in (0, -1, best)),
            each.values[best],
        )
    return table
