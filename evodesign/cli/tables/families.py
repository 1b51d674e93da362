"""The kinds of a run as a table."""

from __future__ import annotations

from evodesign.analysis.families import Families
from evodesign.analysis.front import to_minimise
from evodesign.cli.output import heading, rounded
from evodesign.cli.tables.table import FittedTable, numbers, titled
from evodesign.records import RunHeader

ROWS = 30
"""Kinds in the table; `--json` has all."""


def families_table(header: RunHeader, found: Families) -> FittedTable:
    """The kinds whose elites are best in the objective, the best first."""
    name = found.objective.name

    def value(kind_index: int) -> float:
        return to_minimise(found.objective, found.kinds[kind_index].elite.assessment.objectives[name])

    order = sorted(range(len(found.kinds)), key=value)[:ROWS]
    shown = f", {len(order)} of {len(found.kinds)}" if len(order) < len(found.kinds) else ""
    columns = numbers(*(each.name for each in found.descriptors), *map(heading, header.objectives))
    table = titled(f"The best of each kind in {name}{shown}", [*numbers("design"), *columns])
    for index in order:
        kind = found.kinds[index]
        objectives = kind.elite.assessment.objectives
        table.add_row(
            kind.elite.number,
            *kind.values,
            *(objectives.get(each.name) for each in header.objectives),
        )
    return table


def families_line(found: Families) -> str:
    """How much of the grid is filled."""
    if not found.kinds:
        return "no feasible design has all of these quantities, so there are no families"
    axes = " by ".join(
        f"{each.name} from {rounded(each.lower)} to {rounded(each.upper)} in {each.cells}"
        for each in found.descriptors
    )
    return (
        f"{len(found.kinds)} of {found.cells} kinds are filled ({axes}); QD score {rounded(found.score)} "
        f"{found.objective.unit}, counted from {rounded(found.worst)}"
    )
